#pragma once

#include <span>

#include "core/vertices/interest_region.h"
#include "core/vertices/vertex_products.h"

namespace rimlight {

/// Locally adaptive products after Lee 2014, chapter 5: the light of each vertex is calculated
/// degree by degree, and no further once what the degrees above a base have added so far is below a
/// threshold; then the regions of interest are refined and their boundaries smoothed.
///
/// As in the thesis, but for three slips: |D| is compared, not D (its Algorithm 1); only the
/// increment of a degree is added (its Algorithm 3 adds whole R; see LevelGroup); D is that of the
/// largest channel. Filtered vertices do not leave holes: the rest is packed into full panels.
///
/// It saves work where light is smooth, but a vertex that crosses the threshold from one frame to
/// the next jumps, and what has been added so far says little about what is to come. ViewTransport
/// has neither fault; this is kept as the measure to beat.
///
/// One thread at a time; computes on all threads, the same bits for any number.
class MultiLevelLight {
 public:
  /// Both must outlive this. An empty graph means: no refinement, no smoothing.
  MultiLevelLight(const VertexProducts& products, const VertexGraph& graph);

  struct Settings {
    int base_degree = 2;
    /// In the units of the outputs; 0 filters nothing, infinity everything above the base.
    float irradiance_threshold = 0;
    float highlight_threshold = 0;
  };

  /// Under the light of the products: [panel][3][kBatchVertices] of the selection, which has
  /// highlights. CheckFailure as for VertexProducts, or when the base degree is negative.
  void calculate(const VertexSelection& selection, const VertexGloss& gloss,
                 const Settings& settings, std::span<float> irradiance,
                 std::span<float> highlights);

  /// Shares of the vertices whose light of that kind was not calculated to the highest degree.
  double filtered_irradiance() const { return irradiance_region_.outside(); }
  double filtered_highlights() const { return highlight_region_.outside(); }

 private:
  void filter_irradiance(const VertexSelection& selection, const Settings& settings,
                         std::span<float> to);
  void filter_highlights(const VertexSelection& selection, const VertexGloss& gloss,
                         const Settings& settings, std::span<float> to);

  const VertexProducts& products_;
  const VertexGraph& graph_;
  InterestRegion irradiance_region_, highlight_region_;
  AlignedVector<float> irradiance_base_, highlight_base_;
};

}  // namespace rimlight

#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/vertices/lobe_product.h"
#include "core/vertices/panel_transport.h"
#include "core/vertices/vertex_products.h"

namespace rimlight {

/// The vertices that one view shows, as linear functions of the light: what a light change needs
/// while the view stands still.
///
/// A highlight is S = ∫ L · O · g over the sphere, with visibility O and the lobe g turned to the
/// mirrored direction: for a vertex and a view one vector T, the product O · g to twice the degree
/// n, and S = Σ_k L_k T_k. That is the full calculation put together otherwise: exact but for
/// rounding T to fp16, and it takes (2n + 1)² products a channel where M · O takes (n + 1)⁴. T
/// costs about as much as one full calculation; a view that moves in every frame gains nothing from
/// it.
///
/// set_view() when view, lobes or transport change; set_light() when the light does. One thread at
/// a time; computes on all threads, the same bits for any number. Nothing is allocated after the
/// first view of as many vertices and the workspaces' first use.
class ViewTransport {
 public:
  /// The view's memory must outlive this.
  explicit ViewTransport(const VertexTransportView& transport);

  /// CheckFailure as VertexProducts::highlights(). All selected vertices must have a highlight.
  void set_view(const VertexSelection& selection, const VertexGloss& gloss);

  /// How much the bands that panels leave out may add (PanelTransport): root mean squares of
  /// irradiance and of highlights. 0 leaves nothing out.
  struct Tolerance {
    float irradiance = 0;
    float highlight = 0;
  };
  /// [3][(K + 1)²], any K; [panel][3][kBatchVertices] of the view's selection.
  void calculate(std::span<const float> light, const Tolerance& tolerance,
                 std::span<float> irradiance, std::span<float> highlights);

  const PanelTransport& irradiance() const { return irradiance_; }
  const PanelTransport& highlights() const { return highlights_; }

 private:
  struct Workspace;
  void prepare_lobes(std::span<const float> factors);
  void fill_highlights(const VertexSelection& selection, const VertexGloss& gloss,
                       std::size_t panel, std::span<float> values) const;

  VertexProducts products_;  // for its loads; without a light
  LobeProduct product_;
  std::vector<float> factors_;  // of the lobes
  std::vector<LobeProduct::Lobe> lobes_;
  PanelTransport irradiance_, highlights_;
};

}  // namespace rimlight

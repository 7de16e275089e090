#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/basis/sh_product_matrix.h"
#include "core/transport/vertex_transport.h"
#include "core/vertices/vertex_product_kernel.h"
#include "core/vertices/vertex_selection.h"

namespace rimlight {

/// Where a vertex mirrors the eye to, and with what lobe.
struct VertexGloss {
  /// [vertex], at least as far as vertices are selected: the mirrored direction to the eye, of any
  /// length but zero.
  std::span<const Vec3f> mirrored;
  /// [lobe][n + 1]: what a convolution with the lobe multiplies each band by (convolution_factors).
  std::span<const float> lobes;
  /// [vertex]: which lobe; empty when there is only one.
  std::span<const std::uint32_t> lobe_of;
};

/// √(4π/(2l + 1)) h_l0: band l of a signal times this is its convolution with the lobe h. [n + 1].
std::vector<float> convolution_factors(std::span<const double> lobe);

/// The light of vertices under one light, all coefficients of all vertices asked for: the full
/// calculation, which the adaptive ones are measured against.
///
/// Outputs are by the panels of a VertexSelection, [panel][…][kBatchVertices], the lanes of padding
/// included; only incident_by_vertex() goes by vertex. Parallel over panels; the same bits for any
/// number of threads, and for a vertex whatever else is selected. fp16 transport, fp32 arithmetic:
/// the error of a sum of N products is below N · 2⁻²⁴ · Σ |product|. CheckFailure when a selection
/// goes beyond the transport or a span has the wrong size. Nothing is allocated after each thread's
/// first panel. set_light() by one thread at a time, and not while others read.
class VertexProducts {
 public:
  /// Views must fit their counts, else CheckFailure. The transport's memory must outlive this.
  explicit VertexProducts(const VertexTransportView& transport);

  /// [3][(K + 1)²], any K to sh::kLargestLightDegree. Highlights see it to twice the degree of the
  /// visibility, irradiance to the degree of its transport.
  void set_light(std::span<const float> light);

  /// [panel][3][kBatchVertices]: Σ_i L_i I_i.
  void irradiance(const VertexSelection& selection, std::span<float> to) const;

  /// The light that arrives at a vertex past what hides the sky, in harmonics: the product of light
  /// and visibility, cut off at the degree n of the visibility. [vertex][3][row_stride()], those of
  /// vertices that are not selected left as they are; from (n + 1)² on zeros.
  void incident_by_vertex(const VertexSelection& selection, std::span<float> to) const;
  std::size_t row_stride() const { return matrix_.stride(); }

  /// The light that arrives, convolved with each vertex' lobe, at its mirrored direction (Lee 2014,
  /// eq. 4.4): [panel][3][kBatchVertices]. It takes no notice of the material's highlight weight.
  void highlights(const VertexSelection& selection, const VertexGloss& gloss,
                  std::span<float> to) const;
  /// Multiplications and additions of the matrix products in highlights(), a vertex.
  double highlight_flops() const;

  /// What the adaptive calculations are made of: one panel's visibility, and its lobes turned to
  /// the mirrored directions, both [(n + 1)²][kBatchVertices].
  void load_visibility(const VertexSelection& selection, std::size_t panel, float* values) const;
  void load_lobes(const VertexSelection& selection, std::size_t panel, const VertexGloss& gloss,
                  float* values) const;
  /// [channels][(irradiance degree + 1)²][kBatchVertices].
  void load_irradiance(const VertexSelection& selection, std::size_t panel, float* values) const;
  ChannelMatrices matrices() const;

  /// CheckFailure when highlights of these vertices cannot be calculated.
  void check(const VertexSelection& selection, const VertexGloss& gloss) const;

  const VertexTransportView& transport() const { return transport_; }
  /// [3][(irradiance degree + 1)²]
  std::span<const float> irradiance_light() const { return light_; }

 private:
  void check(const VertexSelection& selection, std::size_t vertices) const;

  VertexTransportView transport_;
  ShProductMatrix matrix_;
  AlignedVector<float> light_;
};

}  // namespace rimlight

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/math/vec.h"
#include "core/vertices/vertex_products.h"
#include "core/vertices/vertex_selection.h"

namespace rimlight {

/// The light of vertices under one light, calculated for those that are asked for and kept until
/// the light changes: another view costs only the vertices that it shows anew. A vertex has the
/// same bits whatever else was asked for, before or with it. One thread at a time; computes on all
/// cores.
class VertexLighting {
 public:
  /// The transport's memory must outlive it.
  explicit VertexLighting(const VertexTransportView& transport);

  /// [3][(K + 1)²]. Everything is to be calculated anew.
  void set_light(std::span<const float> light);
  /// Calculates what is missing of these vertices: irradiance, and of the second ones, which have a
  /// highlight, the light that arrives. Both rising.
  void light(std::span<const std::uint32_t> vertices,
             std::span<const std::uint32_t> highlight_vertices);

  /// Of these, which have a highlight, how many's arriving light is not calculated yet.
  std::size_t missing(std::span<const std::uint32_t> highlight_vertices) const;

  const Vec3f& irradiance(std::uint32_t vertex) const { return irradiance_[vertex]; }
  /// The product of light and visibility: [3][stride()], 64-byte aligned, zeros at the end.
  const float* incident(std::uint32_t vertex) const {
    return incident_.data() + vertex * kLightChannels * stride();
  }
  std::size_t stride() const { return products_.row_stride(); }

 private:
  /// Those of `asked` that are not marked; marks them.
  std::span<const std::uint32_t> take_missing(std::span<const std::uint32_t> asked,
                                              std::vector<std::uint8_t>& known);

  VertexProducts products_;
  std::vector<Vec3f> irradiance_;                            // [vertex]
  AlignedVector<float> incident_;                            // [vertex with a highlight][3][stride]
  std::vector<std::uint8_t> has_irradiance_, has_incident_;  // [vertex]
  VertexSelection selection_;
  std::vector<std::uint32_t> missing_;
  AlignedVector<float> sums_;  // [panel][3][kBatchVertices]
};

}  // namespace rimlight

#include "core/vertices/vertex_lighting.h"

#include <algorithm>

namespace rimlight {

VertexLighting::VertexLighting(const VertexTransportView& transport)
    : products_(transport),
      irradiance_(transport.vertex_count),
      has_irradiance_(transport.vertex_count),
      has_incident_(transport.highlight_count) {}

void VertexLighting::set_light(std::span<const float> light) {
  products_.set_light(light);
  std::ranges::fill(has_irradiance_, std::uint8_t{0});
  std::ranges::fill(has_incident_, std::uint8_t{0});
}

std::span<const std::uint32_t> VertexLighting::take_missing(std::span<const std::uint32_t> asked,
                                                            std::vector<std::uint8_t>& known) {
  missing_.clear();
  for (const std::uint32_t vertex : asked) {
    if (known[vertex] != 0) continue;
    known[vertex] = 1;
    missing_.push_back(vertex);
  }
  return missing_;
}

std::size_t VertexLighting::missing(std::span<const std::uint32_t> highlight_vertices) const {
  return static_cast<std::size_t>(std::ranges::count_if(
      highlight_vertices, [this](std::uint32_t vertex) { return has_incident_[vertex] == 0; }));
}

void VertexLighting::light(std::span<const std::uint32_t> vertices,
                           std::span<const std::uint32_t> highlight_vertices) {
  selection_.select_vertices(take_missing(vertices, has_irradiance_));
  sums_.resize(selection_.panel_count() * kLightChannels * kBatchVertices);
  products_.irradiance(selection_, sums_);
  for (std::size_t panel = 0; panel < selection_.panel_count(); ++panel) {
    const float* const sums = sums_.data() + panel * kLightChannels * kBatchVertices;
    selection_.for_each_vertex(panel, [&](std::size_t vertex, std::size_t lane) {
      irradiance_[vertex] = {sums[lane], sums[kBatchVertices + lane],
                             sums[2 * kBatchVertices + lane]};
    });
  }
  if (highlight_vertices.empty()) return;
  // Its own size only when a highlight is first seen: most of what a session holds.
  incident_.resize(has_incident_.size() * kLightChannels * stride());
  selection_.select_vertices(take_missing(highlight_vertices, has_incident_));
  products_.incident_by_vertex(selection_, incident_);
}

}  // namespace rimlight

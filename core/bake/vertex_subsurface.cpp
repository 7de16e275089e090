#include "core/bake/vertex_subsurface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/bake/vertex_mesh.h"
#include "core/base/parallel.h"

namespace rimlight {
namespace {

/// What lies farther away than so much of a medium's light is left out.
constexpr double kLeftOut = 1e-3;
/// A cluster counts as one at this many of its radii.
constexpr double kFar = 2;

Vec3d at(const VertexMesh& mesh, std::size_t vertex) { return Vec3d(mesh.positions[vertex]); }

void add_scaled(double weight, const float* from, std::span<float> to) {
  const auto w = static_cast<float>(weight);
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += w * from[i];
}

}  // namespace

SubsurfaceSpread::SubsurfaceSpread(const VertexMesh& mesh, std::span<const Material> materials)
    : mesh_(mesh), areas_(vertex_areas(mesh)), media_(materials.size()) {
  for (std::size_t i = 0; i < materials.size(); ++i) {
    if (!materials[i].subsurface) continue;
    const auto dipole = [&](int c) { return dipole_of(*materials[i].subsurface, c); };
    const std::array<DiffusionDipole, 3> of = {dipole(0), dipole(1), dipole(2)};
    media_[i] = Medium{of, {of[0].reach(kLeftOut), of[1].reach(kLeftOut), of[2].reach(kLeftOut)}};
  }
  for (std::size_t batch = 0; batch < batch_count(mesh.positions.size()); ++batch) {
    std::map<std::uint32_t, Cluster> found;
    const std::size_t last = std::min(mesh.positions.size(), (batch + 1) * kBatchVertices);
    for (std::size_t vertex = batch * kBatchVertices; vertex < last; ++vertex) {
      if (!media_[mesh.materials[vertex]]) continue;
      Cluster& cluster = found[mesh.materials[vertex]];
      cluster.vertices.push_back(static_cast<std::uint32_t>(vertex));
      cluster.area += areas_[vertex];
      cluster.middle += at(mesh, vertex) * areas_[vertex];
    }
    for (auto& [material, cluster] : found) {
      cluster.material = material;
      cluster.middle = cluster.middle / cluster.area;
      for (const std::uint32_t vertex : cluster.vertices) {
        cluster.radius = std::max(cluster.radius, length(at(mesh, vertex) - cluster.middle));
      }
      clusters_.push_back(std::move(cluster));
    }
  }
  needed_ = !clusters_.empty();
}

bool SubsurfaceSpread::is_coloured() const {
  return std::ranges::any_of(media_, [](const std::optional<Medium>& medium) {
    return medium && (medium->reach[0] != medium->reach[1] || medium->reach[1] != medium->reach[2]);
  });
}

void SubsurfaceSpread::apply(int channel, std::size_t coefficients,
                             std::vector<float>& values) const {
  if (!needed_) return;
  const std::vector<float> from = values;
  std::vector<float> means(clusters_.size() * coefficients);  // Σ area E
  parallel_for(clusters_.size(), [&](std::size_t i) {
    const std::span<float> sum = std::span(means).subspan(i * coefficients, coefficients);
    for (const std::uint32_t vertex : clusters_[i].vertices) {
      add_scaled(areas_[vertex], from.data() + vertex * coefficients, sum);
    }
  });
  parallel_for(clusters_.size(), [&](std::size_t i) {
    for (const std::uint32_t vertex : clusters_[i].vertices) {
      spread_vertex(channel, vertex, coefficients, from, means,
                    std::span(values).subspan(vertex * coefficients, coefficients));
    }
  });
}

void SubsurfaceSpread::spread_vertex(int channel, std::size_t vertex, std::size_t coefficients,
                                     std::span<const float> from, std::span<const float> means,
                                     std::span<float> to) const {
  const auto c = static_cast<std::size_t>(channel);
  const std::uint32_t material = mesh_.materials[vertex];
  const DiffusionDipole& dipole = media_[material]->dipole[c];
  const double reach = media_[material]->reach[c];
  const double own = dipole.within(std::sqrt(areas_[vertex] / std::numbers::pi));
  std::fill(to.begin(), to.end(), 0.0f);
  add_scaled(own, from.data() + vertex * coefficients, to);
  double sum = own;
  const Vec3d here = at(mesh_, vertex);
  for (std::size_t i = 0; i < clusters_.size(); ++i) {
    const Cluster& cluster = clusters_[i];
    const double distance = length(cluster.middle - here);
    if (cluster.material != material || distance > reach + cluster.radius) continue;
    if (distance > kFar * cluster.radius) {
      const double density = dipole.at(distance);
      sum += density * cluster.area;
      add_scaled(density, means.data() + i * coefficients, to);
      continue;
    }
    for (const std::uint32_t other : cluster.vertices) {
      if (other == vertex) continue;
      const double weight = dipole.at(length(at(mesh_, other) - here)) * areas_[other];
      sum += weight;
      add_scaled(weight, from.data() + other * coefficients, to);
    }
  }
  const auto scale = static_cast<float>(1 / std::max(sum, dipole.reflectance()));
  for (float& value : to) value *= scale;
}

}  // namespace rimlight

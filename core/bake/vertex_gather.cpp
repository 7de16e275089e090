#include "core/bake/vertex_gather.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/bake/share_counter.h"
#include "core/base/parallel.h"
#include "core/basis/sh.h"

namespace rimlight {
namespace {

/// Rows go to other random numbers than visibility's rays.
constexpr std::uint64_t kStream = std::uint64_t{1} << 62;

struct Entry {
  std::uint32_t column = 0;
  float weight = 0;
};
using Row = std::vector<Entry>;

struct TracedRow {
  Row row;
  std::size_t rays = 0;
  double error = 0;
};

/// A ray's end on a surface that shines towards it.
struct Source {
  std::array<std::uint32_t, 3> corner;
  std::array<float, 3> weight;
};

/// Adds up entries of one column.
Row merged(Row entries) {
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.column < b.column; });
  Row row;
  for (const Entry& entry : entries) {
    if (row.empty() || row.back().column != entry.column) {
      row.push_back(entry);
    } else {
      row.back().weight += entry.weight;
    }
  }
  return row;
}

class RowTracer {
 public:
  RowTracer(const RayScene& scene, const VertexMesh& mesh, std::span<const float> albedo,
            std::span<const float> irradiance, const RaySettings& settings)
      : scene_(scene),
        mesh_(mesh),
        albedo_(albedo),
        irradiance_(irradiance),
        settings_(settings),
        coefficients_(sh::coefficient_count(settings.degree)),
        sums_(coefficients_) {}

  TracedRow trace(std::size_t vertex) {
    TracedRow result;
    for (int s = first_round(settings_); s > 0; s = next_round(settings_, s, result.error)) {
      Row entries = trace_round(vertex, s);
      result = {merged(std::move(entries)), static_cast<std::size_t>(4 * s * s), sums_.error()};
    }
    return result;
  }

 private:
  Row trace_round(std::size_t vertex, int s) {
    Random random(settings_.seed, kStream + vertex * 0x10000 + static_cast<std::uint64_t>(s));
    const std::vector<Sample2> points = round_points(s, random);
    const std::size_t cells = points.size() / kReplicates;
    const Frame<double> frame{Vec3d(mesh_.normals[vertex])};
    const Vec3f origin = vertex_ray_origin(mesh_, vertex, scene_.extent());
    Row entries;
    sums_.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3f direction(frame.to_world(cosine_hemisphere(points[i])));
      const auto source = find_source({origin, direction});
      if (!source) continue;
      add_light(*source, 1 / static_cast<double>(cells), sums_.replicate(i / cells));
      for (std::size_t k = 0; k < 3; ++k) {
        entries.push_back(
            {source->corner[k], source->weight[k] / static_cast<float>(points.size())});
      }
    }
    return entries;
  }

  std::optional<Source> find_source(const Ray& ray) const {
    const auto hit = scene_.find_triangle(ray);
    if (!hit) return std::nullopt;
    const auto& corner = mesh_.triangles[hit->triangle];
    const Vec3d a(mesh_.positions[corner[0]]);
    Vec3d normal =
        cross(Vec3d(mesh_.positions[corner[1]]) - a, Vec3d(mesh_.positions[corner[2]]) - a);
    const Vec3f shading =
        mesh_.normals[corner[0]] + mesh_.normals[corner[1]] + mesh_.normals[corner[2]];
    if (dot(normal, Vec3d(shading)) < 0) normal = -normal;
    if (!(dot(normal, Vec3d(ray.direction)) < 0)) return std::nullopt;  // its back
    const float u = std::clamp(hit->u, 0.0f, 1.0f);
    const float v = std::clamp(hit->v, 0.0f, 1 - u);
    return Source{corner, {1 - u - v, u, v}};
  }

  void add_light(const Source& source, double share, std::span<double> sums) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t vertex = source.corner[k];
      const double weight = share * source.weight[k] * albedo_[vertex];
      const float* const light = irradiance_.data() + vertex * coefficients_;
      for (std::size_t i = 0; i < coefficients_; ++i) sums[i] += weight * light[i];
    }
  }

  const RayScene& scene_;
  const VertexMesh& mesh_;
  std::span<const float> albedo_, irradiance_;
  const RaySettings& settings_;
  std::size_t coefficients_;
  ReplicateMean sums_;
};

GatherMatrix matrix_of(std::vector<TracedRow> rows) {
  GatherMatrix matrix;
  matrix.first.push_back(0);
  for (const TracedRow& row : rows) matrix.first.push_back(matrix.first.back() + row.row.size());
  matrix.column.reserve(matrix.first.back());
  matrix.weight.reserve(matrix.first.back());
  for (TracedRow& row : rows) {
    for (const Entry& entry : row.row) {
      matrix.column.push_back(entry.column);
      matrix.weight.push_back(entry.weight);
    }
    row.row = {};
  }
  return matrix;
}

}  // namespace

double GatherMatrix::row_sum(std::size_t row) const {
  double sum = 0;
  for (std::uint64_t i = first[row]; i < first[row + 1]; ++i) sum += weight[i];
  return sum;
}

Gathered gather(const RayScene& scene, const VertexMesh& mesh,
                std::span<const std::uint32_t> blocked, std::span<const float> albedo,
                std::span<const float> irradiance, const RaySettings& settings,
                const ShareDone& done) {
  const std::size_t vertices = mesh.positions.size();
  std::vector<TracedRow> rows(vertices);
  ShareCounter counter(batch_count(vertices), done);
  parallel_for(batch_count(vertices), [&](std::size_t batch) {
    flush_denormals();
    RowTracer tracer(scene, mesh, albedo, irradiance, settings);
    const std::size_t last = std::min(vertices, (batch + 1) * kBatchVertices);
    for (std::size_t vertex = batch * kBatchVertices; vertex < last; ++vertex) {
      if (blocked[vertex] > 0) rows[vertex] = tracer.trace(vertex);
    }
    counter.add_one();
  });
  Gathered result;
  double squares = 0;
  for (const TracedRow& row : rows) {
    result.rays += row.rays;
    result.capped_vertices += row.error > settings.error ? 1 : 0;
    result.worst_error = std::max(result.worst_error, row.error);
    squares += row.error * row.error;
  }
  if (vertices > 0) result.rms_error = std::sqrt(squares / static_cast<double>(vertices));
  result.matrix = matrix_of(std::move(rows));
  return result;
}

}  // namespace rimlight

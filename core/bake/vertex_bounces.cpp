#include "core/bake/vertex_bounces.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"

namespace rimlight {
namespace {

/// The largest row sum of G ρ.
double largest_gain(const GatherMatrix& matrix, std::span<const float> albedo) {
  double largest = 0;
  for (std::size_t row = 0; row < matrix.rows(); ++row) {
    double sum = 0;
    for (std::uint64_t i = matrix.first[row]; i < matrix.first[row + 1]; ++i) {
      sum += static_cast<double>(matrix.weight[i]) * albedo[matrix.column[i]];
    }
    largest = std::max(largest, sum);
  }
  return largest;
}

/// to = G ρ from. Rows of 64 vertices a task; four entries at a time, so that a row's sums stay in
/// registers' reach.
void multiply(const GatherMatrix& matrix, std::span<const float> albedo, std::size_t coefficients,
              const std::vector<float>& from, std::vector<float>& to) {
  parallel_for(batch_count(matrix.rows()), [&](std::size_t batch) {
    const std::size_t last = std::min(matrix.rows(), (batch + 1) * kBatchVertices);
    for (std::size_t row = batch * kBatchVertices; row < last; ++row) {
      float* const sums = to.data() + row * coefficients;
      std::fill_n(sums, coefficients, 0.0f);
      for (std::uint64_t i = matrix.first[row]; i < matrix.first[row + 1]; ++i) {
        const std::size_t column = matrix.column[i];
        const float weight = matrix.weight[i] * albedo[column];
        const float* const light = from.data() + column * coefficients;
        for (std::size_t k = 0; k < coefficients; ++k) sums[k] += weight * light[k];
      }
    }
  });
}

/// The largest rms of a vertex' coefficients.
double largest_rms(const std::vector<float>& values, std::size_t coefficients) {
  double largest = 0;
  for (std::size_t first = 0; first < values.size(); first += coefficients) {
    double sum = 0;
    for (std::size_t i = first; i < first + coefficients; ++i) {
      sum += static_cast<double>(values[i]) * values[i];
    }
    largest = std::max(largest, sum);
  }
  return std::sqrt(largest / static_cast<double>(coefficients));
}

}  // namespace

std::vector<Vec3f> bounced_albedo(const VertexMesh& mesh,
                                  std::span<const VertexMaterial> materials) {
  std::vector<Vec3f> result(mesh.positions.size());
  for (std::size_t vertex = 0; vertex < result.size(); ++vertex) {
    const VertexMaterial& material = materials[mesh.materials[vertex]];
    const Vec3f all = mesh.tints[vertex] * material.albedo + material.highlight;
    for (int c = 0; c < 3; ++c) result[vertex][c] = std::min(all[c], kMostBouncedAlbedo);
  }
  return result;
}

Bounces add_bounces(const GatherMatrix& matrix, std::span<const float> albedo,
                    const SubsurfaceSpread& spread, int channel, std::size_t coefficients,
                    double error, std::vector<float>& irradiance) {
  spread.apply(channel, coefficients, irradiance);
  Bounces bounces;
  const double gain = largest_gain(matrix, albedo);
  if (!(gain > 0)) return bounces;
  std::vector<float> term = irradiance, next(irradiance.size());
  for (; bounces.count < kMostBounces; ++bounces.count) {
    bounces.left = largest_rms(term, coefficients) * gain / (1 - gain);
    if (bounces.left <= error) break;
    multiply(matrix, albedo, coefficients, term, next);
    spread.apply(channel, coefficients, next);
    for (std::size_t i = 0; i < next.size(); ++i) irradiance[i] += next[i];
    term.swap(next);
  }
  return bounces;
}

}  // namespace rimlight

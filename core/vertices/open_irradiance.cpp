#include "core/vertices/open_irradiance.h"

#include <algorithm>
#include <array>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/basis/sh_kernel.h"
#include "core/basis/sh_zonal.h"

namespace rimlight {
namespace {

constexpr std::size_t kChannels = 3;

struct Normals {
  alignas(64) std::array<float, kBatchVertices> x, y, z;
};

Normals normals_of(const VertexSelection& selection, std::size_t panel,
                   std::span<const Vec3f> normals) {
  Normals result;
  result.x.fill(0);
  result.y.fill(0);
  result.z.fill(1);  // those of the padding point somewhere
  selection.for_each_vertex(panel, [&](std::size_t vertex, std::size_t lane) {
    result.x[lane] = normals[vertex].x;
    result.y[lane] = normals[vertex].y;
    result.z[lane] = normals[vertex].z;
  });
  return result;
}

}  // namespace

void open_irradiance(const VertexSelection& selection, std::span<const Vec3f> normals,
                     std::span<const float> light, int degree, std::span<float> irradiance) {
  const std::size_t count = sh::coefficient_count(degree);
  RIMLIGHT_CHECK(selection.vertex_end() <= normals.size());
  RIMLIGHT_CHECK_EQ(light.size(), kChannels * count);
  RIMLIGHT_CHECK_EQ(irradiance.size(), selection.panel_count() * kChannels * kBatchVertices);
  std::vector<float> received(light.begin(), light.end());
  sh::convolve(sh::clamped_cosine_lobe(degree), received);
  parallel_for(selection.panel_count(), [&](std::size_t panel) {
    thread_local AlignedVector<float> values;
    values.resize(count * kBatchVertices);
    const Normals at = normals_of(selection, panel, normals);
    sh::evaluate({at.x, at.y, at.z}, degree, values, kBatchVertices);
    float* const sums = irradiance.data() + panel * kChannels * kBatchVertices;
    std::fill_n(sums, kChannels * kBatchVertices, 0.0f);
    const std::size_t lanes = selection.lane_count(panel);
    for (std::size_t c = 0; c < kChannels; ++c) {
      for (std::size_t i = 0; i < count; ++i) {
        const float coefficient = received[c * count + i];
        const float* const row = values.data() + i * kBatchVertices;
        for (std::size_t lane = 0; lane < lanes; ++lane) {
          sums[c * kBatchVertices + lane] += coefficient * row[lane];
        }
      }
    }
  });
}

}  // namespace rimlight

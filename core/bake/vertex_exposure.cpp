#include "core/bake/vertex_exposure.h"

#include <algorithm>
#include <numbers>

#include "core/bake/vertex_bounces.h"
#include "core/basis/sh.h"
#include "core/basis/sh_projection.h"
#include "core/image/metrics.h"

namespace rimlight {
namespace {

/// Texels a side: a texel's share of a band of degree 20 is off by a twentieth.
constexpr int kCubeSize = 64;

}  // namespace

double vertex_exposure_scale(const PreparedVertices& prepared, const CalculatedTransport& transport,
                             const Environment& environment) {
  const CubeLight texels = environment.project(kCubeSize);
  const std::vector<float> light =
      sh::project(sh::cube_quadrature(kCubeSize), texels.values, transport.degree);
  const std::size_t coefficients = sh::coefficient_count(transport.degree);
  const std::vector<Vec3f> albedo = bounced_albedo(prepared.mesh, prepared.materials);
  std::vector<Vec3f> radiance(transport.vertex_count);
  for (std::size_t vertex = 0; vertex < radiance.size(); ++vertex) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& values = transport.irradiance[std::min(c, transport.irradiance.size() - 1)];
      float sum = 0;
      for (std::size_t i = 0; i < coefficients; ++i) {
        sum += values[vertex * coefficients + i] * light[c * coefficients + i];
      }
      const int channel = static_cast<int>(c);
      radiance[vertex][channel] =
          albedo[vertex][channel] * std::max(sum, 0.0f) * std::numbers::inv_pi_v<float>;
    }
  }
  return auto_exposure_scale(radiance);
}

}  // namespace rimlight

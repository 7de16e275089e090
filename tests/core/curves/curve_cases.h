#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/curves/curve_light.h"
#include "core/curves/curve_material_state.h"
#include "core/curves/curve_transport.h"
#include "core/transport/curve_receivers.h"

namespace rimlight {

/// Surfaces in all directions, with random views (some grazing), curved within the pixel, that see
/// random parts of the sky. Half of them mirror the middle of some quarter of a texel exactly.
struct CurveScene {
  std::vector<CurveMaterial> materials;
  std::vector<CurveSurface> surfaces;
  SkyVisibilityPacker visibility;

  explicit CurveScene(int cube_size) : visibility(cube_size) {}
  CurveReceivers receivers() const { return {materials, surfaces, visibility.view()}; }
};

/// `rows` receivers of each material, every fifth in two surfaces; tiles apart.
CurveScene random_scene(std::vector<CurveMaterial> materials, std::size_t rows, int cube_size,
                        std::uint64_t seed);

/// Of radiance exp(normal), some texels black, one of a thousand times the mean.
CubeLight random_light(int cube_size, std::uint64_t seed);

/// A smooth measured BRDF, coloured in all factors.
FactoredBrdf some_measured();

struct CurveCase {
  std::string name;
  CurveMaterial material;
};
/// All models, and the corners of their domains.
std::vector<CurveCase> curve_cases();

/// The row's radiance in double: a sum of evaluate() over all texels and quarters.
Vec3d reference_row(const CurveReceivers& receivers, const CurvePanel& panel, std::size_t row,
                    const CubeLight& light, const CurveMaterialState& state);

/// T̂ · ĉ + fixed of a row, from what is stored.
Vec3d stored_row(const CurveTransport& transport, std::size_t panel, std::size_t row,
                 CurveAxis axis, const CurveCoefficients& curve);

}  // namespace rimlight

#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
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
  CurveReceivers receivers() const { return {materials, {}, surfaces, visibility.view()}; }
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

/// The state of a material that was not edited.
CurveMaterialState baked_state(const CurveMaterial& material);

/// Two panels of one material under one light, 8 × 8 texels a face.
struct PanelCase {
  static constexpr int kSize = 8;
  static constexpr std::size_t kRows = 70;

  CurveScene scene;
  CurveSky sky{kSize};
  CubeLight light;
  CurveLight curve_light;
  CurveTransport transport;

  explicit PanelCase(const CurveMaterial& material,
                     const CubeLight& light_ = random_light(kSize, 7), std::uint64_t seed = 3);

  /// T′ of an axis, or `fixed` alone.
  void rebuild(const CurveMaterialState& state, std::optional<CurveAxis> axis,
               std::uint64_t version = 1);
  /// Calls visit(panel, row) for all rows.
  template <typename Visit>
  void for_each_row(const Visit& visit) const {
    for (std::size_t panel = 0; panel < transport.panels().size(); ++panel) {
      for (std::size_t row = 0; row < transport.panels()[panel].row_count; ++row) {
        visit(panel, row);
      }
    }
  }
};

/// ‖found − expected‖ / ‖expected‖ over many rows.
class RelativeError {
 public:
  void add(const Vec3d& found, const Vec3d& expected) {
    error_ += dot(found - expected, found - expected);
    size_ += dot(expected, expected);
  }
  double value() const { return std::sqrt(error_ / size_); }
  double size() const { return std::sqrt(size_); }

 private:
  double error_ = 0, size_ = 0;
};

/// Of [3][kPanelRows].
inline Vec3d row_of(std::span<const float> panel, std::size_t row) {
  return {panel[row], panel[kPanelRows + row], panel[2 * kPanelRows + row]};
}

}  // namespace rimlight

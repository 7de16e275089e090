#include "tests/support/ball_source.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/bake/transport_bake.h"
#include "core/basis/cube_map.h"
#include "core/math/random.h"

namespace rimlight::test {
namespace {

constexpr double kExponent = 64;

double power_64(double x) {
  for (int i = 0; i < 6; ++i) x *= x;
  return x;
}

std::optional<Vec3d> normal_of(const PixelLayout& layout, std::size_t receiver) {
  const auto [x, y] = layout.pixel(receiver);
  if (x >= layout.width || y >= layout.height) return std::nullopt;
  const double u = 2 * (x + 0.5) / layout.width - 1, v = 1 - 2 * (y + 0.5) / layout.height;
  const double inside = 1 - u * u - v * v;
  if (!(inside > 0.01)) return std::nullopt;
  return Vec3d{u, v, std::sqrt(inside)};
}

/// Radiance towards the viewer from a unit of radiance and solid angle.
Vec3f response(const Vec3d& normal, const Vec3d& light) {
  const double cosine = dot(normal, light);
  if (cosine <= 0) return {};
  const Vec3d mirror = {2 * normal.z * normal.x, 2 * normal.z * normal.y,
                        2 * normal.z * normal.z - 1};
  const double matte = 0.5 * cosine / std::numbers::pi;
  const double gloss =
      power_64(std::max(0.0, dot(mirror, light))) * (kExponent + 1) / (4 * std::numbers::pi);
  return {static_cast<float>(matte + gloss), static_cast<float>(0.8 * matte + gloss),
          static_cast<float>(0.5 * matte + gloss)};
}

}  // namespace

BallSource::BallSource(int side, int cube_size, double noise, std::uint64_t seed)
    : layout_{side, side}, haar_(cube_size), noise_(noise), seed_(seed) {}

bool BallSource::has_receivers(std::size_t first_receiver) const {
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    if (normal_of(layout_, first_receiver + lane)) return true;
  }
  return false;
}

void BallSource::find_rows(std::size_t first_receiver, BakedGroup& group) const {
  group.empty = !has_receivers(first_receiver);
  group.coverage.fill(0);
  if (group.empty) return;
  GroupRows texels(haar_.size());
  const auto solid_angles = cube::texel_solid_angles(haar_.size());
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    const auto normal = normal_of(layout_, first_receiver + lane);
    if (!normal) continue;
    group.coverage[lane] = 1;
    for (std::size_t texel = 0; texel < solid_angles.size(); ++texel) {
      const Vec3f value =
          response(*normal, cube::texel_direction(texel, haar_.size())) * solid_angles[texel];
      for (std::size_t c = 0; c < 3; ++c) {
        texels.row(texel)[c * kGroupLanes + lane] = value[static_cast<int>(c)];
      }
    }
  }
  if (noise_ > 0) {
    Random random(seed_, first_receiver);
    const double most = std::sqrt(3.0) * noise_;  // uniform within ±most
    for (float& value : texels.values) value *= static_cast<float>(1 + random.uniform(-most, most));
  }
  haar_.forward(texels.values, group.coefficients.values, kRowLanes);
}

void bake_ball(const std::filesystem::path& folder, const BallSource& source,
               std::size_t reference_receivers, const BallSource* retraced,
               const BallSource* finer) {
  Camera camera;
  camera.position = {0, 0, 5};
  bake_transport(source,
                 {.scene = "ball",
                  .camera = camera,
                  .environments = {builtin_environment("sunny"), builtin_environment("studio")},
                  .settings = {{"source", "closed form"}},
                  .psnr_db = 45,
                  .reference_receivers = reference_receivers,
                  .retraced = retraced,
                  .finer = finer},
                 folder, {});
}

}  // namespace rimlight::test

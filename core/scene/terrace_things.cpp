// The default scene's vase, ring, bench and bowl.

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "core/scene/mesh_geometry.h"
#include "core/scene/shapes.h"
#include "core/scene/terrace.h"

namespace rimlight::terrace {
namespace {

constexpr double kPi = std::numbers::pi;

/// The ring is open towards the sun of `sunny`, which its hollow side gathers on the stone before
/// it.
constexpr double kBandAngle = 200 * kPi / 180;
constexpr double kBandMiddle = 152 * kPi / 180;

/// A smooth profile through points (Catmull and Rom 1974), `steps` a span; radii stay at least 0.
std::vector<ProfilePoint> smooth_profile(std::span<const ProfilePoint> points, int steps) {
  const auto at = [&](std::size_t i, std::size_t back) {
    const std::size_t k = i < back ? 0 : i - back;
    return points[std::min(k, points.size() - 1)];
  };
  std::vector<ProfilePoint> profile;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const ProfilePoint a = at(i, 1), b = at(i, 0), c = points[i + 1],
                       d = points[std::min(i + 2, points.size() - 1)];
    for (int s = 0; s < steps; ++s) {
      const double t = static_cast<double>(s) / steps;
      const auto blend = [t](double p, double q, double r, double u) {
        return q + 0.5 * t * (r - p + t * (2 * p - 5 * q + 4 * r - u + t * (3 * (q - r) + u - p)));
      };
      profile.push_back({std::max(0.0, blend(a.radius, b.radius, c.radius, d.radius)),
                         blend(a.height, b.height, c.height, d.height)});
    }
  }
  profile.push_back(points.back());
  return profile;
}

/// |x|^e + |y|^e + |z|^e = 1 stretched to a cushion, thinner towards its edges.
Mesh cushion(const Vec3d& size) {
  Mesh mesh = make_sphere(1, 64);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3d p(mesh.positions[i]);
    const auto spread = [](double a) { return std::copysign(std::pow(std::abs(a), 0.42), a); };
    const double x = spread(p.x);
    const double y = spread(p.y);
    const double rim = (1 - 0.8 * std::pow(std::abs(x), 6)) * (1 - 0.8 * std::pow(std::abs(y), 6));
    const double z = std::copysign(std::pow(std::abs(p.z), 0.8), p.z) * rim;
    mesh.positions[i] = Vec3f(Vec3d(x, y, z) * size * 0.5);
  }
  smooth_normals(mesh);
  return mesh;
}

struct Band {
  double inner, outer, height;
};

/// An upright band, bent to a part of a circle: closed at its ends, smooth along its curve.
Mesh open_band(const Band& band) {
  const ProfilePoint corners[] = {
      {band.inner, band.height}, {band.inner, 0}, {band.outer, 0}, {band.outer, band.height}};
  std::vector<ProfilePoint> creased;
  for (const ProfilePoint& p : corners) creased.insert(creased.end(), {p, p});
  creased.push_back(corners[0]);
  Mesh mesh = lathe(creased, 192, kBandAngle);
  for (const double phi : {0.0, kBandAngle}) {
    const Vec3d along(std::cos(phi), 0, -std::sin(phi));
    const Vec3d side = Vec3d(-std::sin(phi), 0, -std::cos(phi)) * (phi == 0 ? -1.0 : 1.0);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const ProfilePoint& p : corners) {
      mesh.positions.push_back(Vec3f(along * p.radius + Vec3d(0, p.height, 0)));
      mesh.normals.push_back(Vec3f(side));
      mesh.texture_coordinates.push_back({});
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  return mesh;
}

Brdf glaze(const Vec3f& albedo, float roughness) {
  return {.model = BrdfModel::cook_torrance,
          .albedo = albedo,
          .specular = {1, 1, 1},
          .roughness = roughness,
          .eta = {1.5f, 1.5f, 1.5f}};
}

}  // namespace

void add_vase(Builder& builder, const Vec3d& place) {
  const std::uint32_t plinth_stone =
      builder.material("plinth stone", {.albedo = {0.72f, 0.69f, 0.63f}});
  constexpr double kPlinth = 0.34;
  builder.add("plinth", chamfered_box({0.78, kPlinth, 0.78}, 0.015), plinth_stone,
              translation(place + Vec3d(0, kPlinth / 2, 0)));
  const ProfilePoint outline[] = {
      {0, 0},         {0.13, 0},      {0.15, 0.015},  {0.155, 0.05}, {0.235, 0.25},  {0.29, 0.46},
      {0.275, 0.65},  {0.18, 0.80},   {0.105, 0.885}, {0.095, 0.96}, {0.135, 1.035}, {0.145, 1.05},
      {0.135, 1.052}, {0.085, 0.965}, {0.09, 0.88},   {0.17, 0.77},  {0.22, 0.5},    {0, 0.3}};
  builder.add("vase", lathe(smooth_profile(outline, 5), 96),
              builder.material("cobalt glaze", glaze({0.015f, 0.07f, 0.30f}, 0.05f)),
              translation(place + Vec3d(0, kPlinth, 0)));
}

void add_ring(Builder& builder, const Vec3d& place) {
  const std::uint32_t basalt = builder.material("basalt", {.albedo = {0.33f, 0.31f, 0.29f}});
  constexpr double kSlab = 0.07;
  const ProfilePoint slab[] = {
      {0, 0},         {0.66, 0},      {0.66, 0}, {0.66, kSlab - 0.012}, {0.66, kSlab - 0.012},
      {0.648, kSlab}, {0.648, kSlab}, {0, kSlab}};
  builder.add("basalt disc", lathe(slab, 96), basalt, translation(place));
  // Gold at 630, 532 and 465 nm (Johnson and Christy 1972).
  const Brdf gold{.model = BrdfModel::cook_torrance,
                  .albedo = {},
                  .specular = {1, 1, 1},
                  .roughness = 0.07f,
                  .eta = {0.19f, 0.54f, 1.36f},
                  .k = {3.29f, 2.23f, 1.93f}};
  builder.add("gold ring", open_band({.inner = 0.40, .outer = 0.425, .height = 0.27}),
              builder.material("gold", gold),
              translation(place + Vec3d(0, kSlab, 0)) *
                  rotation(axis_angle({0, 1, 0}, kBandMiddle - kBandAngle / 2)));
}

void add_bench(Builder& builder, const Vec3d& place) {
  const std::uint32_t stone = builder.material("bench stone", {.albedo = {0.62f, 0.58f, 0.51f}});
  constexpr double kSeat = 0.40;
  builder.add_piece("bench", chamfered_box({0.50, 0.07, 1.75}, 0.012), stone,
                    translation(place + Vec3d(0, kSeat, 0)));
  for (const double z : {-0.6, 0.6}) {
    builder.add_piece("bench", chamfered_box({0.40, kSeat - 0.035, 0.16}, 0.012), stone,
                      translation(place + Vec3d(0, (kSeat - 0.035) / 2, z)));
  }
  struct Cushion {
    const char* name;
    Vec3f albedo;
    double z, lean, turn;
  };
  const Cushion cushions[] = {{"mustard cloth", {0.72f, 0.43f, 0.08f}, -0.52, 0.30, 0.10},
                              {"rose cloth", {0.70f, 0.24f, 0.25f}, -0.16, 0.42, -0.12},
                              {"linen cloth", {0.74f, 0.70f, 0.62f}, 0.50, 0.34, 0.18}};
  for (const Cushion& one : cushions) {
    const double side = 0.44;
    const Transform leaning =
        translation(place + Vec3d(-0.10, kSeat + 0.035 + side / 2 * std::cos(one.lean), one.z)) *
        rotation(axis_angle({0, 1, 0}, kPi / 2 + one.turn)) *
        rotation(axis_angle({1, 0, 0}, -one.lean));
    builder.add("cushion", cushion({side, side, 0.17}),
                builder.material(one.name, {.albedo = one.albedo}), leaning);
  }
}

void add_bowl(Builder& builder, const Vec3d& place) {
  const ProfilePoint outline[] = {{0, 0},        {0.07, 0},      {0.075, 0.012}, {0.14, 0.05},
                                  {0.185, 0.11}, {0.195, 0.135}, {0.187, 0.137}, {0.175, 0.11},
                                  {0.13, 0.06},  {0.06, 0.03},   {0, 0.028}};
  builder.add("bowl", lathe(smooth_profile(outline, 4), 72),
              builder.material("celadon glaze", glaze({0.42f, 0.55f, 0.46f}, 0.12f)),
              translation(place));
  const std::uint32_t orange = builder.material("orange", {.model = BrdfModel::phong,
                                                           .albedo = {0.80f, 0.30f, 0.02f},
                                                           .specular = {0.03f, 0.03f, 0.03f},
                                                           .exponent = 14});
  const Vec3d places[] = {
      {0.062, 0.094, 0.03}, {-0.058, 0.094, 0.045}, {-0.005, 0.097, -0.075}, {0.0, 0.172, 0.0}};
  for (const Vec3d& p : places) {
    builder.add("orange", make_sphere(0.058, 36), orange, translation(place + p));
  }
}

}  // namespace rimlight::terrace

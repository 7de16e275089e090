// The default scene's plant, branching stems in a pot with thousands of bent leaves, and its
// garden.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/math/sampling.h"
#include "core/scene/mesh_geometry.h"
#include "core/scene/shapes.h"
#include "core/scene/terrace.h"

namespace rimlight::terrace {
namespace {

constexpr double kPi = std::numbers::pi;

/// A point along a stem.
struct StemPoint {
  Vec3d position;
  Vec3d direction;  // unit
  double radius;
};
using Stem = std::vector<StemPoint>;

struct Growth {
  double length, radius;
  double wander;  // how far a step may turn, radians
  double upward;  // how strongly it seeks the light, per step
  int steps;
};

Stem grow(const StemPoint& root, const Growth& growth, Random& random) {
  Stem stem{root};
  stem[0].radius = growth.radius;
  for (int i = 1; i <= growth.steps; ++i) {
    const StemPoint& last = stem.back();
    const Vec3d turn = uniform_sphere(random_sample(random)) * growth.wander;
    const Vec3d direction = normalized(last.direction + turn + Vec3d(0, growth.upward, 0));
    const double taper = 1 - 0.75 * i / growth.steps;
    stem.push_back({last.position + direction * (growth.length / growth.steps), direction,
                    growth.radius * taper});
  }
  return stem;
}

/// A tube of six sides along a stem.
Mesh tube(const Stem& stem) {
  constexpr std::uint32_t kSides = 6;
  Mesh mesh;
  for (const StemPoint& point : stem) {
    const Frame<double> frame(point.direction);
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const double phi = 2 * kPi * k / kSides;
      const Vec3d out = frame.tangent * std::cos(phi) + frame.bitangent * std::sin(phi);
      mesh.positions.push_back(Vec3f(point.position + out * point.radius));
      mesh.normals.push_back(Vec3f(out));
    }
  }
  for (std::uint32_t i = 0; i + 1 < stem.size(); ++i) {
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const std::uint32_t a = i * kSides + k;
      const std::uint32_t b = i * kSides + (k + 1) % kSides;
      mesh.triangles.push_back({a, b, b + kSides});
      mesh.triangles.push_back({a, b + kSides, a + kSides});
    }
  }
  return mesh;
}

/// A leaf of length 1 from the origin along +z, its face to +y: pointed, folded along its middle,
/// drooping by `droop` towards the tip. Eight triangles.
Mesh leaf(double droop, double fold) {
  Mesh mesh;
  constexpr double kAlong[] = {0, 0.22, 0.5, 0.78, 1};
  constexpr double kWidth[] = {0.02, 0.16, 0.20, 0.12, 0};
  for (int i = 0; i < 5; ++i) {
    const double bend = droop * kAlong[i] * kAlong[i];
    const Vec3d middle(0, -bend, kAlong[i] * (1 - 0.3 * bend));
    for (const double side : {-1.0, 0.0, 1.0}) {
      mesh.positions.push_back(
          Vec3f(middle + Vec3d(side * kWidth[i], std::abs(side) * kWidth[i] * fold, 0)));
    }
  }
  for (std::uint32_t i = 0; i < 4; ++i) {
    for (const std::uint32_t k : {0u, 1u}) {
      const std::uint32_t a = 3 * i + k;
      if (i < 3) mesh.triangles.push_back({a, a + 3, a + 4});
      mesh.triangles.push_back({a, i < 3 ? a + 4 : 3 * i + 4, a + 1});
    }
  }
  smooth_normals(mesh);
  return mesh;
}

/// Leaves of a shape that is clipped rather than grown: scattered over its surface, pointing out
/// and up.
class Topiary {
 public:
  Topiary(Builder& builder, std::string part, const Vec3f& green)
      : builder_(builder), part_(std::move(part)), tones_(builder.tones(part_, green, 0.4, 4)) {}

  std::uint32_t core_material() const { return tones_[0]; }

  void add_leaf(const Vec3d& position, const Vec3d& outward, double size, Random& random) {
    const Vec3d way =
        normalized(outward * 0.5 + Vec3d(0, 0.8, 0) + uniform_sphere(random_sample(random)) * 0.45);
    Vec3d right = cross(Vec3d(outward.z, 0.3, -outward.x), way);
    right = length(right) > 1e-3 ? normalized(right) : Vec3d(1, 0, 0);
    const Vec3d up = cross(way, right);
    Transform turn;
    turn.linear = {{{right.x, up.x, way.x}, {right.y, up.y, way.y}, {right.z, up.z, way.z}}};
    builder_.add_piece(part_, leaf(0.1, 0.3), tones_[random.below(tones_.size())],
                       translation(position) * turn * scaling(Vec3d::filled(size)));
  }

 private:
  Builder& builder_;
  std::string part_;
  std::vector<std::uint32_t> tones_;
};

/// A cypress: a slender spindle within its leaves.
void add_cypress(Builder& builder, Topiary& leaves, const Vec3d& place, double height,
                 Random& random) {
  const double widest = 0.095 * height;
  const auto radius = [&](double along) {
    return widest * std::pow(along, 0.35) * std::pow(1 - along, 0.75) * 1.9;
  };
  std::vector<ProfilePoint> spindle;
  for (int i = 0; i <= 20; ++i) {
    const double along = i / 20.0;
    spindle.push_back({i == 20 ? 0 : 0.85 * radius(along), height * (0.03 + 0.96 * along)});
  }
  builder.add("cypress", lathe(spindle, 24), leaves.core_material(), translation(place));
  for (int i = 0; i < 1100; ++i) {
    const double along = 1 - std::sqrt(1 - 0.995 * random.uniform());
    const double phi = random.uniform(0, 2 * kPi);
    const Vec3d out(std::cos(phi), 0, std::sin(phi));
    const Vec3d at = place + out * (radius(along) * random.uniform(0.75, 1)) +
                     Vec3d(0, height * (0.03 + 0.96 * along), 0);
    leaves.add_leaf(at, out, random.uniform(0.16, 0.26), random);
  }
}

class Plant {
 public:
  Plant(Builder& builder, const Vec3d& root)
      : builder_(builder), random_(builder.random(3)), root_(root) {
    bark_ = builder.material("bark", {.albedo = {0.20f, 0.15f, 0.10f}});
    // Yellower where the light falls, bluer below: chosen leaf by leaf.
    const Vec3f greens[] = {{0.12f, 0.29f, 0.06f},
                            {0.17f, 0.37f, 0.07f},
                            {0.24f, 0.44f, 0.09f},
                            {0.32f, 0.49f, 0.11f},
                            {0.42f, 0.52f, 0.13f}};
    for (const Vec3f& green : greens) {
      leaves_.push_back(builder.material("leaf " + std::to_string(leaves_.size() + 1),
                                         {.model = BrdfModel::phong,
                                          .albedo = green,
                                          .specular = {0.05f, 0.05f, 0.05f},
                                          .exponent = 12}));
    }
  }

  void grow_all() {
    constexpr int kMainStems = 6;
    for (int i = 0; i < kMainStems; ++i) {
      const double phi = 2 * kPi * (i + random_.uniform(-0.3, 0.3)) / kMainStems;
      const Vec3d lean(0.30 * std::cos(phi), 1, 0.30 * std::sin(phi));
      const StemPoint foot{root_ + Vec3d(0.06 * std::cos(phi), 0, 0.06 * std::sin(phi)),
                           normalized(lean), 0};
      branch(foot, {random_.uniform(0.95, 1.35), 0.017, 0.10, 0.02, 12}, 0);
    }
  }

  /// Some lie on the floor around the pot.
  void shed(int count) {
    for (int i = 0; i < count; ++i) {
      const double phi = random_.uniform(0, 2 * kPi);
      const double distance = 0.42 + 0.75 * random_.uniform() * random_.uniform();
      const Vec3d place(root_.x + distance * std::cos(phi), 0.012,
                        root_.z + distance * std::sin(phi));
      if (place.z < kBack + 0.1) continue;
      const double turn = random_.uniform(0, 2 * kPi);
      add_leaf(place, {std::cos(turn), 0.02, std::sin(turn)}, random_.uniform(0.08, 0.12));
    }
  }

 private:
  void branch(const StemPoint& from, const Growth& growth, int level) {
    const Stem stem = grow(from, growth, random_);
    builder_.add_piece("stems", tube(stem), bark_, {});
    constexpr int kLeafLevel = 1;
    if (level >= kLeafLevel) add_leaves(stem, level);
    if (level == 2) return;
    const int children = level == 0 ? 11 : 6;
    for (int i = 0; i < children; ++i) {
      const double along = level == 0 ? random_.uniform(0.25, 1) : random_.uniform(0.25, 0.95);
      const StemPoint& at =
          stem[static_cast<std::size_t>(along * (static_cast<double>(stem.size()) - 1))];
      const Frame<double> frame(at.direction);
      const double phi = random_.uniform(0, 2 * kPi);
      const Vec3d out = frame.tangent * std::cos(phi) + frame.bitangent * std::sin(phi);
      const StemPoint bud{at.position, normalized(at.direction * 0.6 + out), 0};
      const double shorter = random_.uniform(0.75, 1.1);
      branch(bud,
             level == 0 ? Growth{0.44 * shorter * (1.25 - 0.5 * along), 0.007, 0.16, 0.07, 7}
                        : Growth{0.20 * shorter, 0.003, 0.2, 0.05, 5},
             level + 1);
    }
  }

  void add_leaves(const Stem& stem, int level) {
    const int count = level == 1 ? 6 : 10;
    double phi = random_.uniform(0, 2 * kPi);
    for (int i = 0; i < count; ++i) {
      phi += 2.4;  // the golden angle, as leaves are arranged
      const double along = (i + 1.0) / count;
      const auto place = static_cast<std::size_t>(along * (static_cast<double>(stem.size()) - 1));
      const StemPoint& at = stem[place];
      const Frame<double> frame(at.direction);
      const Vec3d out = frame.tangent * std::cos(phi) + frame.bitangent * std::sin(phi);
      const Vec3d way =
          normalized(at.direction * 0.45 + out + Vec3d(0, random_.uniform(-0.3, 0.25), 0));
      add_leaf(at.position, way, random_.uniform(0.085, 0.14) * (level == 1 ? 1.15 : 1));
    }
  }

  /// A leaf turns its face up as far as its way allows.
  void add_leaf(const Vec3d& position, const Vec3d& way, double size) {
    Vec3d up = Vec3d(0, 1, 0) + uniform_sphere(random_sample(random_)) * 0.35;
    Vec3d right = cross(up, way);
    if (length(right) < 1e-3) right = {1, 0, 0};
    right = normalized(right);
    up = cross(way, right);
    Transform turn;
    turn.linear = {{{right.x, up.x, way.x}, {right.y, up.y, way.y}, {right.z, up.z, way.z}}};
    const double light = (position.y - root_.y) / 1.6 + random_.uniform(-0.35, 0.35);
    const auto tone = static_cast<std::size_t>(std::clamp(
        light * static_cast<double>(leaves_.size()), 0.0, static_cast<double>(leaves_.size()) - 1));
    builder_.add_piece("leaves", leaf(random_.uniform(0.1, 0.45), random_.uniform(0.15, 0.5)),
                       leaves_[tone], translation(position) * turn * scaling(Vec3d::filled(size)));
  }

  Builder& builder_;
  Random random_;
  Vec3d root_;
  std::uint32_t bark_;
  std::vector<std::uint32_t> leaves_;
};

}  // namespace

void add_plant(Builder& builder, const Vec3d& place) {
  const ProfilePoint pot[] = {{0, 0},        {0.21, 0},     {0.21, 0},     {0.29, 0.42},
                              {0.29, 0.42},  {0.32, 0.42},  {0.32, 0.42},  {0.325, 0.50},
                              {0.325, 0.50}, {0.285, 0.50}, {0.285, 0.50}, {0.28, 0.45}};
  builder.add("pot", lathe(pot, 96), builder.material("clay", {.albedo = {0.50f, 0.23f, 0.14f}}),
              translation(place));
  builder.add("soil", make_disc(0.283, 48),
              builder.material("soil", {.albedo = {0.07f, 0.05f, 0.04f}}),
              translation(place + Vec3d(0, 0.452, 0)));
  Plant plant(builder, place + Vec3d(0, 0.45, 0));
  plant.grow_all();
  plant.shed(40);
}

void add_garden(Builder& builder) {
  Random random = builder.random(4);
  builder.add("lawn", make_plane(16, 14),
              builder.material("lawn", {.albedo = {0.16f, 0.27f, 0.07f}}),
              translation({0, -0.06, kBack - 7.35}));
  Topiary hedge(builder, "hedge", {0.10f, 0.20f, 0.05f});
  const Vec3d size(9, 1.25, 0.9);
  const Vec3d place(0.5, 0.55, kBack - 8.5);
  builder.add("hedge core", make_box(size), hedge.core_material(), translation(place));
  for (int i = 0; i < 1100; ++i) {
    // The top and the side that is seen, by their areas.
    const bool top = random.uniform() < size.z / (size.z + size.y);
    const double x = random.uniform(-0.5, 0.5) * size.x;
    const double s = random.uniform(-0.5, 0.5);
    const Vec3d at =
        top ? Vec3d(x, size.y / 2 - 0.02, s * size.z) : Vec3d(x, s * size.y, size.z / 2);
    hedge.add_leaf(place + at, top ? Vec3d(0, 1, 0) : Vec3d(0, 0, 1), random.uniform(0.10, 0.16),
                   random);
  }
  Topiary cypress(builder, "cypress leaves", {0.07f, 0.15f, 0.05f});
  add_cypress(builder, cypress, {-0.55, -0.06, kBack - 5.6}, 4.4, random);
  add_cypress(builder, cypress, {0.62, -0.06, kBack - 6.8}, 3.6, random);
}

}  // namespace rimlight::terrace

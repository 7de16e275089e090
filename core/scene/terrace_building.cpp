// The default scene's floor, walls and pergola.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/scene/mesh_geometry.h"
#include "core/scene/shapes.h"
#include "core/scene/terrace.h"

namespace rimlight::terrace {
namespace {

constexpr double kWallHeight = 2.9;
constexpr double kWallThickness = 0.3;
/// The opening in the back wall.
constexpr double kArchMiddle = 0.42, kArchRadius = 0.68, kArchSpring = 1.45;
constexpr int kArchSteps = 48;

void add_quad(Mesh& mesh, const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3d& p : {a, b, c, d}) mesh.positions.push_back(Vec3f(p));
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

/// The back wall in slices of x, each from the opening (or the ground) to the top.
Mesh back_wall() {
  struct Station {
    double x, bottom;
  };
  std::vector<Station> stations{{kLeft - kWallThickness, 0}, {kArchMiddle - kArchRadius, 0}};
  for (int i = 0; i <= kArchSteps; ++i) {
    const double angle = std::numbers::pi * (1 - static_cast<double>(i) / kArchSteps);
    stations.push_back(
        {kArchMiddle + kArchRadius * std::cos(angle), kArchSpring + kArchRadius * std::sin(angle)});
  }
  stations.push_back({kArchMiddle + kArchRadius, 0});
  stations.push_back({kRight + 0.25, 0});
  Mesh wall;
  const double front = kBack;
  const double back = kBack - kWallThickness;
  for (std::size_t i = 0; i + 1 < stations.size(); ++i) {
    const auto& [x0, y0] = stations[i];
    const auto& [x1, y1] = stations[i + 1];
    add_quad(wall, {x0, y0, back}, {x1, y1, back}, {x1, y1, front}, {x0, y0, front});
    if (x1 - x0 < 1e-9) continue;  // a jamb
    const double top = kWallHeight;
    add_quad(wall, {x0, y0, front}, {x1, y1, front}, {x1, top, front}, {x0, top, front});
    add_quad(wall, {x1, y1, back}, {x0, y0, back}, {x0, top, back}, {x1, top, back});
    add_quad(wall, {x0, top, front}, {x1, top, front}, {x1, top, back}, {x0, top, back});
  }
  const double right = stations.back().x;
  add_quad(wall, {right, 0, front}, {right, 0, back}, {right, kWallHeight, back},
           {right, kWallHeight, front});
  return wall;
}

/// Light blocks around the opening.
void add_arch_stones(Builder& builder, const std::vector<std::uint32_t>& stone) {
  Random random = builder.random(11);
  const auto tone = [&] { return stone[random.below(stone.size())]; };
  constexpr double kWidth = 0.17;
  const double z = kBack - kWallThickness / 2;
  const double depth = kWallThickness + 0.05;
  constexpr int kCount = 15;
  const double step = std::numbers::pi / kCount;
  const double middle = kArchRadius + kWidth / 2;
  const Mesh voussoir = chamfered_box({kWidth, middle * step - 0.008, depth}, 0.008);
  for (int i = 0; i < kCount; ++i) {
    const double angle = step * (i + 0.5);
    const Transform place = translation({kArchMiddle + middle * std::cos(angle),
                                         kArchSpring + middle * std::sin(angle), z}) *
                            rotation(axis_angle({0, 0, 1}, angle));
    builder.add_piece("arch", voussoir, tone(), place);
  }
  constexpr int kJambStones = 5;
  const double height = kArchSpring / kJambStones;
  for (int i = 0; i < kJambStones; ++i) {
    for (const double side : {-1.0, 1.0}) {
      const double width = i % 2 == 0 ? kWidth : kWidth + 0.09;
      const double x = kArchMiddle + side * (kArchRadius + width / 2);
      builder.add_piece("arch", chamfered_box({width, height - 0.008, depth}, 0.008), tone(),
                        translation({x, height * (i + 0.5), z}));
    }
  }
}

void add_coping(Builder& builder, const std::vector<std::uint32_t>& stone) {
  Random random = builder.random(12);
  constexpr double kLength = 0.9;
  const Mesh along_x = chamfered_box({kLength - 0.008, 0.07, kWallThickness + 0.12}, 0.012);
  for (double x = kLeft - 0.3 + kLength / 2; x < kRight + 0.5; x += kLength) {
    builder.add_piece("coping", along_x, stone[random.below(stone.size())],
                      translation({x, kWallHeight + 0.035, kBack - kWallThickness / 2}));
  }
  const Mesh along_z = chamfered_box({kWallThickness + 0.12, 0.07, kLength - 0.008}, 0.012);
  for (double z = kBack + kLength / 2 + 0.06; z < 1.5; z += kLength) {
    builder.add_piece("coping", along_z, stone[random.below(stone.size())],
                      translation({kLeft - kWallThickness / 2, kWallHeight + 0.035, z}));
  }
}

}  // namespace

void add_floor(Builder& builder) {
  const auto stone = builder.tones("slab", {0.60f, 0.525f, 0.42f}, 0.15, 7);
  const std::uint32_t mortar = builder.material("joint", {.albedo = {0.25f, 0.23f, 0.2f}});
  Random random = builder.random(1);
  constexpr double kJoint = 0.014;
  constexpr double kThickness = 0.06;
  // Rows of slabs of different lengths, as they are laid.
  for (double z = kBack; z < kFront - 0.01;) {
    const double depth = std::min(random.uniform(0.5, 0.62), kFront - z);
    double x = kLeft - random.uniform(0, 0.4);
    while (x < kRight) {
      const double width = random.uniform(0.5, 0.95);
      const double left = std::max(x, kLeft);
      const double right = std::min(x + width, kRight);
      x += width;
      if (right - left < 0.1 || depth < 0.1) continue;
      const Vec3d tilt{random.uniform(-1, 1), 0, random.uniform(-1, 1)};
      const Mesh slab = chamfered_box({right - left - kJoint, kThickness, depth - kJoint}, 0.007);
      builder.add_piece("slabs", slab, stone[random.below(stone.size())],
                        translation({(left + right) / 2, -kThickness / 2 + 0.001, z + depth / 2}) *
                            rotation(axis_angle(tilt, random.uniform(0, 0.003))));
    }
    z += depth;
  }
  builder.add("mortar", make_plane(kRight - kLeft, kFront - kBack), mortar,
              translation({0, -0.012, (kFront + kBack) / 2}));
  // The terrace's own body, down into the ground.
  builder.add("base", make_box({kRight - kLeft + 0.04, 1, kFront - kBack + 0.04}), mortar,
              translation({0, -0.56, (kFront + kBack) / 2}));
}

void add_walls(Builder& builder) {
  const std::uint32_t teal = builder.material("teal plaster", {.albedo = {0.15f, 0.41f, 0.43f}});
  const std::uint32_t terracotta =
      builder.material("terracotta plaster", {.albedo = {0.66f, 0.27f, 0.14f}});
  const auto stone = builder.tones("dressed stone", {0.66f, 0.62f, 0.54f}, 0.08, 4);
  builder.add("back wall", back_wall(), teal);
  builder.add("left wall", make_box({kWallThickness, kWallHeight, 4.4}), terracotta,
              translation({kLeft - kWallThickness / 2, kWallHeight / 2, kBack + 2.2}));
  add_arch_stones(builder, stone);
  add_coping(builder, stone);
  // A step through the arch, and a low wall on the open side.
  builder.add("step", chamfered_box({2 * kArchRadius - 0.02, 0.14, 0.62}, 0.012), stone[2],
              translation({kArchMiddle, 0.07, kBack - 0.02}));
  builder.add("parapet", chamfered_box({0.24, 0.46, 3.1}, 0.012), stone[1],
              translation({kRight - 0.12, 0.23, kBack + 1.55}));
}

void add_pergola(Builder& builder) {
  const auto wood = builder.tones("cedar", {0.40f, 0.235f, 0.13f}, 0.22, 5);
  Random random = builder.random(2);
  const auto tone = [&] { return wood[random.below(wood.size())]; };
  constexpr double kBeamHeight = 2.62;
  constexpr double kEnd = 0.55;
  const double length = kEnd - kBack;
  const double beam_x[] = {kLeft + 0.09, kRight - 0.12};
  for (const double x : beam_x) {
    builder.add_piece("beams", chamfered_box({0.14, 0.2, length + 0.3}, 0.012), tone(),
                      translation({x, kBeamHeight, kBack + length / 2 + 0.15}));
  }
  for (const double z : {kBack + 0.25, kEnd - 0.1}) {
    const double foot = z < kBack + 3 ? 0.46 : 0;
    builder.add_piece("posts", chamfered_box({0.14, kBeamHeight - 0.1 - foot, 0.14}, 0.012), tone(),
                      translation({kRight - 0.12, (kBeamHeight - 0.1 + foot) / 2, z}));
    builder.add_piece("posts", chamfered_box({0.12, kBeamHeight - 0.1, 0.12}, 0.012), tone(),
                      translation({kLeft + 0.09, (kBeamHeight - 0.1) / 2, z}));
  }
  constexpr double kPitch = 0.40;
  const double width = kRight - kLeft + 0.5;
  for (double z = kBack + 0.22; z < kEnd + 0.1; z += kPitch) {
    builder.add_piece("slats", chamfered_box({width, 0.11, 0.075}, 0.008), tone(),
                      translation({0.1, kBeamHeight + 0.155, z + random.uniform(-0.008, 0.008)}) *
                          rotation(axis_angle({0, 1, 0}, random.uniform(-0.003, 0.003))));
  }
  // Laths across, at rest on the slats: a finer rhythm in the shadow.
  for (double x = kLeft + 0.4; x < kRight; x += 0.62) {
    builder.add_piece("laths", chamfered_box({0.05, 0.035, length + 0.2}, 0.006), tone(),
                      translation({x + random.uniform(-0.01, 0.01), kBeamHeight + 0.228,
                                   kBack + length / 2 + 0.1}));
  }
}

}  // namespace rimlight::terrace

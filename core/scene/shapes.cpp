#include "core/scene/shapes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/check.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;

bool same_point(const ProfilePoint& a, const ProfilePoint& b) {
  return a.radius == b.radius && a.height == b.height;
}

double distance(const ProfilePoint& a, const ProfilePoint& b) {
  return std::hypot(a.radius - b.radius, a.height - b.height);
}

/// The profile's normal at point i: to the right of its way, from the neighbours of its smooth run.
ProfilePoint profile_normal(std::span<const ProfilePoint> profile, std::size_t i) {
  const bool crease_before = i > 0 && same_point(profile[i - 1], profile[i]);
  const bool crease_after = i + 1 < profile.size() && same_point(profile[i + 1], profile[i]);
  ProfilePoint way;
  const auto add = [&way](const ProfilePoint& from, const ProfilePoint& to) {
    // By the inverse of the length: the nearer neighbour tells more about the curve here.
    const double squared = std::pow(distance(from, to), 2);
    way.radius += (to.radius - from.radius) / squared;
    way.height += (to.height - from.height) / squared;
  };
  if (i > 0 && !crease_before) add(profile[i - 1], profile[i]);
  if (i + 1 < profile.size() && !crease_after) add(profile[i], profile[i + 1]);
  // A smooth surface is level on the axis; an apex is a crease.
  if (profile[i].radius == 0 && !crease_before && !crease_after) way.height = 0;
  const double size = std::hypot(way.radius, way.height);
  if (!(size > 0)) return {1, 0};
  return {way.height / size, -way.radius / size};
}

/// Two triangles between rows of vertices, or one where a row is the axis.
void add_cell(Mesh& mesh, std::uint32_t lower, std::uint32_t upper, bool lower_on_axis,
              bool upper_on_axis) {
  if (!lower_on_axis) mesh.triangles.push_back({lower, lower + 1, upper});
  if (!upper_on_axis) mesh.triangles.push_back({lower + 1, upper + 1, upper});
}

}  // namespace

Mesh lathe(std::span<const ProfilePoint> profile, int segments, double angle) {
  RIMLIGHT_CHECK(profile.size() >= 2 && segments >= 3);
  double total = 0;
  for (std::size_t i = 1; i < profile.size(); ++i) total += distance(profile[i - 1], profile[i]);
  RIMLIGHT_CHECK(total > 0);

  Mesh mesh;
  const auto row_size = static_cast<std::uint32_t>(segments) + 1;
  double walked = 0;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    if (i > 0) walked += distance(profile[i - 1], profile[i]);
    const ProfilePoint normal = profile_normal(profile, i);
    for (std::uint32_t k = 0; k < row_size; ++k) {
      // The last column of a full turn is the first one again, to the bit, with another u.
      const bool closes = k + 1 == row_size && angle == 2 * kPi;
      const double phi = closes ? 0 : angle * k / segments;
      const Vec3d around(std::cos(phi), 0, -std::sin(phi));
      mesh.positions.push_back(Vec3f(around * profile[i].radius + Vec3d(0, profile[i].height, 0)));
      mesh.normals.push_back(Vec3f(around * normal.radius + Vec3d(0, normal.height, 0)));
      mesh.texture_coordinates.push_back({static_cast<float>(k) / static_cast<float>(segments),
                                          static_cast<float>(walked / total)});
    }
  }
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    if (same_point(profile[i], profile[i + 1])) continue;
    const bool lower_on_axis = profile[i].radius == 0;
    const bool upper_on_axis = profile[i + 1].radius == 0;
    if (lower_on_axis && upper_on_axis) continue;
    const auto lower = static_cast<std::uint32_t>(i) * row_size;
    for (std::uint32_t k = 0; k + 1 < row_size; ++k) {
      add_cell(mesh, lower + k, lower + row_size + k, lower_on_axis, upper_on_axis);
    }
  }
  return mesh;
}

Mesh make_sphere(double radius, int segments) {
  const int rings = std::max(2, segments / 2);
  std::vector<ProfilePoint> profile;
  for (int i = 0; i <= rings; ++i) {
    const double theta = kPi * i / rings;
    const bool pole = i == 0 || i == rings;
    profile.push_back({pole ? 0 : radius * std::sin(theta), -radius * std::cos(theta)});
  }
  Mesh mesh = lathe(profile, segments);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.normals[i] = Vec3f(normalized(Vec3d(mesh.positions[i])));
  }
  return mesh;
}

Mesh make_box(const Vec3d& size) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vec3d normal;
      normal[axis] = side;
      Vec3d right;
      right[(axis + 1) % 3] = side;
      const Vec3d up = cross(normal, right);
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const auto& [s, t] : {std::pair{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) {
        mesh.positions.push_back(Vec3f((normal + right * s + up * t) * size * 0.5));
        mesh.normals.push_back(Vec3f(normal));
        mesh.texture_coordinates.push_back(
            {static_cast<float>((1 + s) / 2), static_cast<float>((1 + t) / 2)});
      }
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    }
  }
  return mesh;
}

Mesh make_torus(double radius, double thickness, int segments) {
  const int around = std::max(8, segments / 2);
  std::vector<ProfilePoint> profile;
  for (int i = 0; i <= around; ++i) {
    const double phi = 2 * kPi * (i == around ? 0 : i) / around;
    profile.push_back({radius + thickness / 2 * std::cos(phi), thickness / 2 * std::sin(phi)});
  }
  Mesh mesh = lathe(profile, segments);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3d p(mesh.positions[i]);
    const Vec3d middle = normalized(Vec3d(p.x, 0, p.z)) * radius;
    mesh.normals[i] = Vec3f(normalized(p - middle));
  }
  return mesh;
}

Mesh make_plane(double size_x, double size_z) {
  Mesh mesh;
  const auto x = static_cast<float>(size_x / 2);
  const auto z = static_cast<float>(size_z / 2);
  mesh.positions = {{-x, 0, z}, {x, 0, z}, {x, 0, -z}, {-x, 0, -z}};
  mesh.normals.assign(4, {0, 1, 0});
  mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Mesh make_disc(double radius, int segments) {
  const ProfilePoint profile[] = {{radius, 0}, {0, 0}};
  return lathe(profile, segments);
}

Mesh make_cylinder(double radius, double height, int segments) {
  const ProfilePoint profile[] = {{0, 0},           {radius, 0},      {radius, 0},
                                  {radius, height}, {radius, height}, {0, height}};
  return lathe(profile, segments);
}

Mesh make_cone(double radius, double height, int segments) {
  const ProfilePoint profile[] = {{0, 0}, {radius, 0}, {radius, 0}, {0, height}, {0, height}};
  return lathe(profile, segments);
}

}  // namespace rimlight

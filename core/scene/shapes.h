#pragma once

#include <numbers>
#include <span>

#include "core/math/vec.h"
#include "core/scene/scene.h"

namespace rimlight {

/// The built-in shapes, y up, with normals and texture coordinates; material 0. Round ones take the
/// number of segments around them (at least 3).

/// A point of a profile that is turned about the y axis.
struct ProfilePoint {
  double radius = 0;  // not negative
  double height = 0;
};

/// The surface of revolution of a profile. A point that is given twice in a row is a crease, else
/// the surface is smooth across it. u goes around, v along the profile by its length. Normals lie
/// to the right of the profile's way: outside, when it is walked upward. An `angle` below a full
/// turn starts at +x towards −z and leaves its two ends open.
Mesh lathe(std::span<const ProfilePoint> profile, int segments,
           double angle = 2 * std::numbers::pi);

/// About the origin.
Mesh make_sphere(double radius, int segments);
/// About the origin; sides x, y, z.
Mesh make_box(const Vec3d& size);
/// Around the y axis, about the origin: `thickness` is the tube's diameter, `radius` its middle's.
Mesh make_torus(double radius, double thickness, int segments);
/// In the plane y = 0, about the origin, facing up.
Mesh make_plane(double size_x, double size_z);
Mesh make_disc(double radius, int segments);
/// Standing on y = 0 around the y axis, closed.
Mesh make_cylinder(double radius, double height, int segments);
Mesh make_cone(double radius, double height, int segments);

}  // namespace rimlight

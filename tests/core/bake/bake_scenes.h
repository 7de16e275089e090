#pragma once

#include <memory>

#include "core/scene/scene.h"

namespace rimlight {

/// Small scenes whose radiance under a uniform sky is known, built without any file.
Mesh quad(const Vec3f& corner, const Vec3f& side_a, const Vec3f& side_b, std::uint32_t material);
Mesh box(const Vec3f& low, const Vec3f& high, std::uint32_t material);

Material lambert(float albedo);
Material metal(float roughness);

/// One white box that fills most of the picture: convex, so that light reaches it from the sky
/// only.
std::shared_ptr<Scene> convex_scene(const Material& material);

/// Floor, two walls and a box in the corner, all of one material: light goes from wall to wall.
std::shared_ptr<Scene> corner_scene(const Material& material);

}  // namespace rimlight

#pragma once

#include "core/material/brdf.h"

/// The Ashikhmin–Shirley lobe and the diffuse term below it (brdf.h); both directions above the
/// horizon.
namespace rimlight::ashikhmin_shirley {

Vec3f lobe(const Brdf& brdf, const Vec3f& in, const Vec3f& out);
/// The density of draw().
float density(const Brdf& brdf, const Vec3f& in, const Vec3f& out);
/// May lie below the horizon.
Vec3f draw(const Brdf& brdf, const Vec3f& out, const Sample2& at);
Vec3f diffuse(const Brdf& brdf, const Vec3f& in, const Vec3f& out);

}  // namespace rimlight::ashikhmin_shirley

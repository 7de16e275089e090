#pragma once

#include "core/material/brdf.h"

/// The Phong lobe (brdf.h); both directions above the horizon.
namespace rimlight::phong {

Vec3f lobe(const Brdf& brdf, const Vec3f& in, const Vec3f& out);
/// The density of draw().
float density(const Brdf& brdf, const Vec3f& in, const Vec3f& out);
/// May lie below the horizon.
Vec3f draw(const Brdf& brdf, const Vec3f& out, const Sample2& at);

}  // namespace rimlight::phong

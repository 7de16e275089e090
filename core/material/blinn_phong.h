#pragma once

#include "core/material/brdf.h"

/// The Blinn–Phong lobe (brdf.h); both directions above the horizon.
namespace rimlight::blinn_phong {

Vec3f lobe(const Brdf& brdf, const Vec3f& in, const Vec3f& out);
/// The density of draw().
float density(const Brdf& brdf, const Vec3f& in, const Vec3f& out);
/// May lie below the horizon.
Vec3f draw(const Brdf& brdf, const Vec3f& out, const Sample2& at);
/// C(n) = (n + 2)(n + 4) / (8π (2^(−n/2) + n)).
float normalization(float exponent);

}  // namespace rimlight::blinn_phong

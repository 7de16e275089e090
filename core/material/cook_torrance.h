#pragma once

#include "core/material/brdf.h"
#include "core/material/half_vector.h"

/// The Cook–Torrance lobe and the Lambert part below it (brdf.h); both directions above the
/// horizon.
namespace rimlight::cook_torrance {

Vec3f lobe(const Brdf& brdf, const Vec3f& in, const Vec3f& out);
Vec3f diffuse(const Brdf& brdf, float cosine_in, float cosine_out);
/// The density of draw().
float density(const Brdf& brdf, const Vec3f& in, const Vec3f& out);
/// May lie below the horizon. `side` in [0, 1) picks the side of the cavity.
Vec3f draw(const Brdf& brdf, const Vec3f& out, double side, const Sample2& at);

/// Beckmann's D(θ_h); 0 when there is no half vector.
float beckmann(float roughness, const HalfVector& half);
/// G, the V-cavity's masking and shadowing.
float masking_shadowing(const HalfVector& half, const Vec3f& in, const Vec3f& out);

}  // namespace rimlight::cook_torrance

#pragma once

#include "core/math/vec.h"

namespace rimlight {

/// Unpolarised Fresnel reflectance of the complex index eta + i k (against 1) at an angle of this
/// cosine; cosines below 1e-5 are taken as 1e-5. eta > 0, k ≥ 0.
float fresnel(float eta, float k, float cosine);
Vec3f fresnel(const Vec3f& eta, const Vec3f& k, float cosine);

/// Schlick's approximation (1994) from the reflectance at normal incidence.
Vec3f schlick_fresnel(const Vec3f& normal_reflectance, float cosine);

}  // namespace rimlight

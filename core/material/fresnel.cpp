#include "core/material/fresnel.h"

#include <algorithm>
#include <cmath>

namespace rimlight {

// With (a + i b)² = (eta + i k)² − s², s the angle's sine:
//   R_s = ((a − c)² + b²) / ((a + c)² + b²),
//   R_p = R_s ((ac − s²)² + b²c²) / ((ac + s²)² + b²c²),     F = (R_s + R_p) / 2.
float fresnel(float eta, float k, float cosine) {
  const float c = std::clamp(cosine, 1e-5f, 1.0f);
  const float c2 = c * c;
  const float s2 = 1 - c2;
  const float real = eta * eta - k * k - s2;
  const float imaginary = 2 * eta * k;
  const float modulus = std::sqrt(real * real + imaginary * imaginary);
  const float a = std::sqrt(std::max(0.0f, 0.5f * (modulus + real)));
  const float b2 = std::max(0.0f, 0.5f * (modulus - real));
  const float s_low = (a - c) * (a - c) + b2;
  const float s_high = (a + c) * (a + c) + b2;
  const float p_low = (a * c - s2) * (a * c - s2) + b2 * c2;
  const float p_high = (a * c + s2) * (a * c + s2) + b2 * c2;
  return 0.5f * s_low * (p_high + p_low) / (s_high * p_high);
}

Vec3f fresnel(const Vec3f& eta, const Vec3f& k, float cosine) {
  const float x = fresnel(eta.x, k.x, cosine);
  const bool grey = eta == Vec3f::filled(eta.x) && k == Vec3f::filled(k.x);
  if (grey) return Vec3f::filled(x);
  return {x, fresnel(eta.y, k.y, cosine), fresnel(eta.z, k.z, cosine)};
}

Vec3f schlick_fresnel(const Vec3f& normal_reflectance, float cosine) {
  const float rest = 1 - std::clamp(cosine, 0.0f, 1.0f);
  const float squared = rest * rest;
  const float power = squared * squared * rest;
  return normal_reflectance + (Vec3f{1, 1, 1} - normal_reflectance) * power;
}

}  // namespace rimlight

#include "core/material/blinn_phong.h"

#include <cmath>
#include <numbers>

#include "core/material/half_vector.h"

namespace rimlight::blinn_phong {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// cos^n θ_h by way of tan² θ_h, which keeps the digits of a narrow lobe.
float power(float exponent, const HalfVector& half) {
  return half.exists ? std::exp(-0.5f * exponent * std::log1p(half.tangent_squared())) : 0;
}

}  // namespace

// 1 / ∫ cos^n θ_h cos θ_i dω_i at normal incidence, where θ_i = 2 θ_h. Elsewhere less is reflected.
float normalization(float exponent) {
  return (exponent + 2) * (exponent + 4) / (8 * kPi * (std::exp2(-0.5f * exponent) + exponent));
}

Vec3f lobe(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  return brdf.specular *
         (normalization(brdf.exponent) * power(brdf.exponent, half_vector(in, out)));
}

float density(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  const HalfVector half = half_vector(in, out);
  if (!half.exists) return 0;
  return (brdf.exponent + 1) / (8 * kPi) * power(brdf.exponent, half) / half.out_half;
}

/// A half vector with density (n + 1) / 2π · cos^n θ_h.
Vec3f draw(const Brdf& brdf, const Vec3f& out, const Sample2& at) {
  const double cosine = std::pow(1 - at.u, 1 / (static_cast<double>(brdf.exponent) + 1));
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const double phi = 2 * std::numbers::pi * at.v;
  return mirrored({sine * std::cos(phi), sine * std::sin(phi), cosine}, out);
}

}  // namespace rimlight::blinn_phong

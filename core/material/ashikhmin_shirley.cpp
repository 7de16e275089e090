#include "core/material/ashikhmin_shirley.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/material/fresnel.h"
#include "core/material/half_vector.h"

// With e = n_x cos² φ_h + n_y sin² φ_h and R_s = specular, R_d = albedo (their equations 4 and 5),
//     f_s = √((n_x + 1)(n_y + 1)) / 8π · cos^e θ_h / (cos θ_d max(cos θ_i, cos θ_o)) · F(θ_d),
//     f_d = 28 R_d / 23π · (1 − R_s) (1 − (1 − cos θ_i / 2)^5) (1 − (1 − cos θ_o / 2)^5).
// Half vectors are drawn with density √((n_x + 1)(n_y + 1)) / 2π · cos^e θ_h; the weight
// f_s cos θ_i / density is F cos θ_i / max(cos θ_i, cos θ_o) ≤ 1.

namespace rimlight::ashikhmin_shirley {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// √((n_x + 1)(n_y + 1)) cos^e θ_h.
float distribution(const Brdf& brdf, const HalfVector& half) {
  if (!half.exists) return 0;
  const float x2 = half.sum.x * half.sum.x, y2 = half.sum.y * half.sum.y;
  const float flat = x2 + y2;
  const float exponent =
      flat > 0 ? (brdf.exponent * x2 + brdf.exponent_across * y2) / flat : brdf.exponent;
  return std::sqrt((brdf.exponent + 1) * (brdf.exponent_across + 1)) *
         std::exp(-0.5f * exponent * std::log1p(half.tangent_squared()));
}

/// 1 − (1 − μ/2)^5.
float diffuse_rest(float mu) {
  const float x = 1 - 0.5f * mu;
  const float x2 = x * x;
  return 1 - x2 * x2 * x;
}

}  // namespace

Vec3f lobe(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  const HalfVector half = half_vector(in, out);
  const float d = distribution(brdf, half);
  if (d == 0) return {};
  const float rest = d / (8 * kPi * half.out_half * std::max(in.z, out.z));
  return schlick_fresnel(brdf.specular, half.out_half) * rest;
}

Vec3f diffuse(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  const float scale = 28 / (23 * kPi) * diffuse_rest(in.z) * diffuse_rest(out.z);
  return brdf.albedo * (Vec3f{1, 1, 1} - brdf.specular) * scale;
}

float density(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  const HalfVector half = half_vector(in, out);
  const float d = distribution(brdf, half);
  return d == 0 ? 0 : d / (8 * kPi * half.out_half);
}

Vec3f draw(const Brdf& brdf, const Vec3f& out, const Sample2& at) {
  const double nx = brdf.exponent, ny = brdf.exponent_across;
  // tan φ = √((n_x + 1)/(n_y + 1)) tan 2πv, in v's own quadrant.
  const double turn = 2 * std::numbers::pi * at.v;
  double x = std::sqrt(ny + 1) * std::cos(turn), y = std::sqrt(nx + 1) * std::sin(turn);
  const double scale = 1 / std::hypot(x, y);
  x *= scale;
  y *= scale;
  const double cosine = std::pow(1 - at.u, 1 / (nx * x * x + ny * y * y + 1));
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  return mirrored({sine * x, sine * y, cosine}, out);
}

}  // namespace rimlight::ashikhmin_shirley

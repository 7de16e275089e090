#include "core/material/cook_torrance.h"

#include <cmath>
#include <numbers>

#include "core/material/fresnel.h"

// Cook–Torrance with a Lambert part below it, per channel, μ = cos θ:
//
//   The V-cavity lobe with F = 1 reflects at most what it gets (Heitz 2014, JCGT 3(2), section 5).
//   For an index eta ≥ 1, k = 0, with F0 its Fresnel reflectance at normal incidence,
//       F(c) ≤ F0' + (1 − F0') (1 − c)^5,     F0' = F0 + 0.035 (1 − F0):
//   Schlick's form falls short of the exact Fresnel by at most 0.030 (1 − F0). Averaged over the
//   lobe's half vectors, (1 − c)^5 exceeds (1 − μ)^5 by at most 0.004, which the rest of the 0.035
//   holds. So the lobe's directional albedo is at most
//       E(μ) = specular · (F0' + (1 − F0') (1 − μ)^5),
//   and what it leaves, T = 1 − E, is shared out reciprocally (Kelemen and Szirmay-Kalos 2001):
//       f_d = albedo / π · T(μ_i) T(μ_o) / T̄,     T̄ = 2 ∫ T μ dμ = 1 − specular (F0' + (1 −
//       F0')/21).
//   Its directional albedo is albedo · T(μ_o), and the sum of both at most E + T = 1.
//   Tests: Brdf.ReflectsNoMoreThanItGets.

namespace rimlight::cook_torrance {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kInversePi = std::numbers::inv_pi_v<float>;
constexpr float kSchlickShortfall = 0.035f;
/// exp(−x) beyond this is not worth a multiplication, and 0/0 lies out there.
constexpr float kLargestExponent = 80;

/// 1 − (1 − μ)^5.
float schlick_rest(float mu) {
  const float x = 1 - mu;
  const float x2 = x * x;
  return 1 - x2 * x2 * x;
}

/// What the lobe leaves in one channel: T(μ) = base + slope · (1 − (1 − μ)^5).
struct Undercoat {
  float base = 0;
  float slope = 0;

  float at(float rest) const { return base + slope * rest; }
  /// T̄: the mean of (1 − μ)^5 under 2μ dμ is 1/21.
  float mean() const { return base + slope * (20.0f / 21); }
};

Undercoat undercoat(float eta, float k, float specular) {
  if (!(specular > 0)) return {1, 0};
  if (k > 0 || eta < 1) return {0, 0};
  const float root = (eta - 1) / (eta + 1);
  const float f0 = root * root;
  const float bound = f0 + kSchlickShortfall * (1 - f0);
  return {1 - specular, specular * (1 - bound)};
}

/// T(μ_i) T(μ_o) / T̄ in one channel.
float undercoat_factor(const Undercoat& coat, float rest_in, float rest_out) {
  const float average = coat.mean();
  return average > 0 ? coat.at(rest_in) * coat.at(rest_out) / average : 0;
}

/// The V-cavity's masking of one direction: G₁ = min(1, 2 cos θ_h cos θ / cos θ_d).
float masking(const HalfVector& h, float mu) {
  return std::min(1.0f, 2 * h.z * mu / std::max(h.out_half, 1e-6f));
}

}  // namespace

float beckmann(float roughness, const HalfVector& half) {
  if (!half.exists) return 0;
  const Vec3f& sum = half.sum;
  const float z = half.z;
  const float m2 = roughness * roughness;
  const float exponent = (sum.x * sum.x + sum.y * sum.y) / (sum.z * sum.z * m2);
  if (!(exponent < kLargestExponent)) return 0;
  return std::exp(-exponent) / (kPi * m2 * z * z * z * z);
}

float masking_shadowing(const HalfVector& half, const Vec3f& in, const Vec3f& out) {
  return masking(half, std::min(in.z, out.z));
}

Vec3f diffuse(const Brdf& brdf, float cosine_in, float cosine_out) {
  if (!(max_component(brdf.albedo) > 0)) return {};
  const float in = schlick_rest(cosine_in);
  const float out = schlick_rest(cosine_out);
  Vec3f result;
  for (int c = 0; c < 3; ++c) {
    const Undercoat coat = undercoat(brdf.eta[c], brdf.k[c], brdf.specular[c]);
    result[c] = brdf.albedo[c] * kInversePi * undercoat_factor(coat, in, out);
  }
  return result;
}

Vec3f lobe(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  const HalfVector half = half_vector(in, out);
  const float d = beckmann(brdf.roughness, half);
  if (d == 0) return {};
  const float g = masking_shadowing(half, in, out);
  return brdf.specular * fresnel(brdf.eta, brdf.k, half.out_half) * (d * g / (4 * in.z * out.z));
}

float density(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  const HalfVector half = half_vector(in, out);
  return beckmann(brdf.roughness, half) * masking(half, out.z) / (4 * out.z);
}

/// Visible normals of V-cavities (Heitz and d'Eon 2014, section 4): a half vector with density
/// D cos θ_h, turned to the cavity's other side as often as that side is seen. The weight
/// f cos θ_i / density is then F · G₂/G₁ ≤ 1.
Vec3f draw(const Brdf& brdf, const Vec3f& out, double side, const Sample2& at) {
  const double m = brdf.roughness;
  const double tangent = m * std::sqrt(-std::log1p(-at.u));
  const double cosine = 1 / std::sqrt(1 + tangent * tangent);
  const double phi = 2 * std::numbers::pi * at.v;
  const double sine = tangent * cosine;
  Vec3d half{sine * std::cos(phi), sine * std::sin(phi), cosine};
  const Vec3d o(out);
  const double flat = o.x * half.x + o.y * half.y;
  const double upright = o.z * half.z;
  const double here = std::max(0.0, upright + flat);
  const double there = std::max(0.0, upright - flat);
  if (side * (here + there) >= here) half = {-half.x, -half.y, half.z};
  return mirrored(half, out);
}

}  // namespace rimlight::cook_torrance

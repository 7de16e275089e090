#include "core/material/brdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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

namespace rimlight {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kInversePi = std::numbers::inv_pi_v<float>;
constexpr float kSchlickShortfall = 0.035f;
/// exp(−x) beyond this is not worth a multiplication, and 0/0 lies out there.
constexpr float kLargestExponent = 80;

bool is_above_horizon(const Vec3f& in, const Vec3f& out) { return in.z > 0 && out.z > 0; }

float mean(const Vec3f& rgb) { return (rgb.x + rgb.y + rgb.z) * (1.0f / 3); }

bool is_black(const Vec3f& rgb) { return !(max_component(rgb) > 0); }

/// Unpolarised Fresnel reflectance of eta + i k at an angle of cosine c, sine s, with
/// (a + i b)² = (eta + i k)² − s²:
///   R_s = ((a − c)² + b²) / ((a + c)² + b²),
///   R_p = R_s ((ac − s²)² + b²c²) / ((ac + s²)² + b²c²),     F = (R_s + R_p) / 2.
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

Vec3f fresnel(const Brdf& brdf, float cosine) {
  const float x = fresnel(brdf.eta.x, brdf.k.x, cosine);
  const bool grey = brdf.eta == Vec3f::filled(brdf.eta.x) && brdf.k == Vec3f::filled(brdf.k.x);
  if (grey) return Vec3f::filled(x);
  return {x, fresnel(brdf.eta.y, brdf.k.y, cosine), fresnel(brdf.eta.z, brdf.k.z, cosine)};
}

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

Vec3f diffuse_under_lobe(const Brdf& brdf, float mu_in, float mu_out) {
  if (is_black(brdf.albedo)) return {};
  const float in = schlick_rest(mu_in);
  const float out = schlick_rest(mu_out);
  Vec3f result;
  for (int c = 0; c < 3; ++c) {
    const Undercoat coat = undercoat(brdf.eta[c], brdf.k[c], brdf.specular[c]);
    result[c] = brdf.albedo[c] * kInversePi * undercoat_factor(coat, in, out);
  }
  return result;
}

/// A half vector seen from `out`, with what D and G need.
struct HalfVector {
  float z;         // cos θ_h
  float out_half;  // cos θ_d
  float beckmann;  // D(θ_h); 0 when there is no half vector to speak of
};

HalfVector half_vector(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  const Vec3f sum = in + out;
  const float squared = dot(sum, sum);
  if (!(squared > 1e-12f)) return {1, 0, 0};
  const float scale = 1 / std::sqrt(squared);
  const float z = sum.z * scale;
  const float m2 = brdf.roughness * brdf.roughness;
  // tan² from the sum's own components: 1 − cos² would lose a narrow lobe's digits.
  const float exponent = (sum.x * sum.x + sum.y * sum.y) / (sum.z * sum.z * m2);
  const float out_half = std::min(1.0f, 0.5f * squared * scale);
  if (!(exponent < kLargestExponent)) return {z, out_half, 0};
  return {z, out_half, std::exp(-exponent) / (kPi * m2 * z * z * z * z)};
}

/// The V-cavity's masking of one direction: G₁ = min(1, 2 cos θ_h cos θ / cos θ_d).
float masking(const HalfVector& h, float mu) {
  return std::min(1.0f, 2 * h.z * mu / std::max(h.out_half, 1e-6f));
}

Vec3f microfacet(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  const HalfVector h = half_vector(brdf, in, out);
  if (h.beckmann == 0) return {};
  const float g = masking(h, std::min(in.z, out.z));
  return brdf.specular * fresnel(brdf, h.out_half) * (h.beckmann * g / (4 * in.z * out.z));
}

float mirror_cosine(const Vec3f& in, const Vec3f& out) {
  return std::clamp(in.z * out.z - in.x * out.x - in.y * out.y, 0.0f, 1.0f);
}

Vec3f phong_lobe(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  const float power = std::pow(mirror_cosine(in, out), brdf.exponent);
  return brdf.specular * ((brdf.exponent + 2) * (0.5f * kInversePi) * power);
}

/// The density of the specular lobe's own sampling.
float specular_density(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  if (brdf.model == BrdfModel::phong) {
    return (brdf.exponent + 1) * (0.5f * kInversePi) *
           std::pow(mirror_cosine(in, out), brdf.exponent);
  }
  const HalfVector h = half_vector(brdf, in, out);
  return h.beckmann * masking(h, out.z) / (4 * out.z);
}

/// The probability with which sample() takes the specular lobe: its share of the albedo, roughly,
/// but never so little that its weights grow large.
float specular_probability(const Brdf& brdf, float mu_out) {
  if (brdf.model == BrdfModel::lambert || is_black(brdf.specular)) return 0;
  if (is_black(brdf.albedo)) return 1;
  float specular = mean(brdf.specular);
  float diffuse = mean(brdf.albedo);
  if (brdf.model == BrdfModel::cook_torrance) {
    specular = mean(brdf.specular * fresnel(brdf, mu_out));
    diffuse = mean(diffuse_under_lobe(brdf, 1, mu_out)) * kPi;
    if (diffuse == 0) return 1;
  }
  return std::clamp(specular / (specular + diffuse), 0.1f, 0.9f);
}

Vec3f sample_phong(const Brdf& brdf, const Vec3f& out, const Sample2& at) {
  const double cosine = std::pow(1 - at.u, 1 / (static_cast<double>(brdf.exponent) + 1));
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const double phi = 2 * std::numbers::pi * at.v;
  const Frame<double> mirror(normalized(Vec3d(-out.x, -out.y, out.z)));
  return Vec3f(mirror.to_world({sine * std::cos(phi), sine * std::sin(phi), cosine}));
}

/// Visible normals of V-cavities (Heitz and d'Eon 2014, section 4): a half vector with density
/// D cos θ_h, turned to the cavity's other side as often as that side is seen. The weight
/// f cos θ_i / density is then F · G₂/G₁ ≤ 1.
Vec3f sample_microfacet(const Brdf& brdf, const Vec3f& out, double side, const Sample2& at) {
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
  return Vec3f(normalized(half * (2 * dot(o, half)) - o));
}

}  // namespace

Vec3f evaluate_diffuse(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  if (!is_above_horizon(in, out)) return {};
  if (brdf.model == BrdfModel::cook_torrance) return diffuse_under_lobe(brdf, in.z, out.z);
  return brdf.albedo * kInversePi;
}

Vec3f evaluate_specular(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  if (brdf.model == BrdfModel::lambert || !is_above_horizon(in, out)) return {};
  return brdf.model == BrdfModel::phong ? phong_lobe(brdf, in, out) : microfacet(brdf, in, out);
}

Vec3f evaluate(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  if (!is_above_horizon(in, out)) return {};
  switch (brdf.model) {
    case BrdfModel::lambert:
      return brdf.albedo * kInversePi;
    case BrdfModel::phong:
      return brdf.albedo * kInversePi + phong_lobe(brdf, in, out);
    case BrdfModel::cook_torrance:
      return diffuse_under_lobe(brdf, in.z, out.z) + microfacet(brdf, in, out);
  }
  return {};
}

float density(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  if (!is_above_horizon(in, out)) return 0;
  const float diffuse = in.z * kInversePi;
  const float specular_share = specular_probability(brdf, out.z);
  if (specular_share == 0) return diffuse;
  return (1 - specular_share) * diffuse + specular_share * specular_density(brdf, in, out);
}

std::optional<BrdfSample> sample(const Brdf& brdf, const Vec3f& out, float choice,
                                 const Sample2& at) {
  if (!(out.z > 0)) return std::nullopt;
  const float share = specular_probability(brdf, out.z);
  BrdfSample result;
  if (!(choice < share)) {
    result.direction = Vec3f(cosine_hemisphere(at));
  } else if (brdf.model == BrdfModel::phong) {
    result.direction = sample_phong(brdf, out, at);
  } else {
    // What is left of `choice` within its lobe is as uniform as it was.
    result.direction = sample_microfacet(brdf, out, choice / share, at);
  }
  result.density = density(brdf, result.direction, out);
  if (!(result.density > 0)) return std::nullopt;
  result.weight = evaluate(brdf, result.direction, out) * (result.direction.z / result.density);
  if (is_black(result.weight)) return std::nullopt;
  return result;
}

bool is_glossy(const Brdf& brdf) {
  if (is_black(brdf.specular)) return false;
  return (brdf.model == BrdfModel::phong && brdf.exponent > 16) ||
         (brdf.model == BrdfModel::cook_torrance && brdf.roughness < 0.35f);
}

}  // namespace rimlight

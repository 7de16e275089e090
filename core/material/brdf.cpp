#include "core/material/brdf.h"

#include <algorithm>
#include <numbers>

#include "core/material/ashikhmin_shirley.h"
#include "core/material/blinn_phong.h"
#include "core/material/cook_torrance.h"
#include "core/material/fresnel.h"
#include "core/material/measured_lobe.h"
#include "core/material/phong.h"
#include "core/material/ward.h"

namespace rimlight {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kInversePi = std::numbers::inv_pi_v<float>;

bool is_above_horizon(const Vec3f& in, const Vec3f& out) { return in.z > 0 && out.z > 0; }

float mean(const Vec3f& rgb) { return (rgb.x + rgb.y + rgb.z) * (1.0f / 3); }

bool is_black(const Vec3f& rgb) { return !(max_component(rgb) > 0); }

/// Ashikhmin and Shirley's Fresnel reflects at grazing angles without any at normal incidence.
bool has_lobe(const Brdf& brdf) {
  if (brdf.model == BrdfModel::lambert) return false;
  return brdf.model == BrdfModel::ashikhmin_shirley || brdf.model == BrdfModel::measured ||
         !is_black(brdf.specular);
}

Vec3f diffuse_term(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  switch (brdf.model) {
    case BrdfModel::cook_torrance:
      return cook_torrance::diffuse(brdf, in.z, out.z);
    case BrdfModel::ashikhmin_shirley:
      return ashikhmin_shirley::diffuse(brdf, in, out);
    case BrdfModel::measured:
      return {};
    default:
      return brdf.albedo * kInversePi;
  }
}

Vec3f specular_term(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  switch (brdf.model) {
    case BrdfModel::lambert:
      return {};
    case BrdfModel::phong:
      return phong::lobe(brdf, in, out);
    case BrdfModel::cook_torrance:
      return cook_torrance::lobe(brdf, in, out);
    case BrdfModel::blinn_phong:
      return blinn_phong::lobe(brdf, in, out);
    case BrdfModel::ward:
      return ward::lobe(brdf, in, out);
    case BrdfModel::ashikhmin_shirley:
      return ashikhmin_shirley::lobe(brdf, in, out);
    case BrdfModel::measured:
      return brdf.measured->evaluate(in, out);
  }
  return {};
}

/// The density of the specular lobe's own sampling.
float specular_density(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  switch (brdf.model) {
    case BrdfModel::lambert:
      return 0;
    case BrdfModel::phong:
      return phong::density(brdf, in, out);
    case BrdfModel::cook_torrance:
      return cook_torrance::density(brdf, in, out);
    case BrdfModel::blinn_phong:
      return blinn_phong::density(brdf, in, out);
    case BrdfModel::ward:
      return ward::density(brdf, in, out);
    case BrdfModel::ashikhmin_shirley:
      return ashikhmin_shirley::density(brdf, in, out);
    case BrdfModel::measured:
      return brdf.measured->density(in, out);
  }
  return 0;
}

/// `rest` in [0, 1) is a third random number.
Vec3f draw_specular(const Brdf& brdf, const Vec3f& out, double rest, const Sample2& at) {
  switch (brdf.model) {
    case BrdfModel::lambert:
      break;
    case BrdfModel::phong:
      return phong::draw(brdf, out, at);
    case BrdfModel::cook_torrance:
      return cook_torrance::draw(brdf, out, rest, at);
    case BrdfModel::blinn_phong:
      return blinn_phong::draw(brdf, out, at);
    case BrdfModel::ward:
      return ward::draw(brdf, out, at);
    case BrdfModel::ashikhmin_shirley:
      return ashikhmin_shirley::draw(brdf, out, at);
    case BrdfModel::measured:
      return brdf.measured->draw(out, at);
  }
  return {};
}

/// The probability with which sample() takes the specular lobe: its share of the albedo, roughly,
/// but never so little that its weights grow large.
float specular_probability(const Brdf& brdf, float mu_out) {
  if (!has_lobe(brdf)) return 0;
  // Half of all directions by the cosine: the factors that are not drawn from may be large.
  if (brdf.model == BrdfModel::measured) return 0.5f;
  if (is_black(brdf.albedo)) return 1;
  float specular = mean(brdf.specular);
  float diffuse = mean(brdf.albedo);
  if (brdf.model == BrdfModel::cook_torrance) {
    specular = mean(brdf.specular * fresnel(brdf.eta, brdf.k, mu_out));
    diffuse = mean(cook_torrance::diffuse(brdf, 1, mu_out)) * kPi;
    if (diffuse == 0) return 1;
  } else if (brdf.model == BrdfModel::ashikhmin_shirley) {
    specular = mean(schlick_fresnel(brdf.specular, mu_out));
    diffuse = mean(brdf.albedo * (Vec3f{1, 1, 1} - brdf.specular));
    if (diffuse == 0) return 1;
  }
  return std::clamp(specular / (specular + diffuse), 0.1f, 0.9f);
}

}  // namespace

Vec3f evaluate_diffuse(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  return is_above_horizon(in, out) ? diffuse_term(brdf, in, out) : Vec3f{};
}

Vec3f evaluate_specular(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  return is_above_horizon(in, out) ? specular_term(brdf, in, out) : Vec3f{};
}

Vec3f evaluate(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  if (!is_above_horizon(in, out)) return {};
  if (brdf.model == BrdfModel::lambert) return brdf.albedo * kInversePi;
  return diffuse_term(brdf, in, out) + specular_term(brdf, in, out);
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
  } else {
    // What is left of `choice` within its lobe is as uniform as it was.
    result.direction = draw_specular(brdf, out, choice / share, at);
  }
  result.density = density(brdf, result.direction, out);
  if (!(result.density > 0)) return std::nullopt;
  result.weight = evaluate(brdf, result.direction, out) * (result.direction.z / result.density);
  if (is_black(result.weight)) return std::nullopt;
  return result;
}

bool is_glossy(const Brdf& brdf) {
  if (!has_lobe(brdf)) return false;
  switch (brdf.model) {
    case BrdfModel::lambert:
      return false;
    case BrdfModel::phong:
    case BrdfModel::blinn_phong:
      return brdf.exponent > 16;
    case BrdfModel::cook_torrance:
      return brdf.roughness < 0.35f;
    case BrdfModel::ward:
      return std::min(brdf.roughness, brdf.roughness_across) < 0.35f;
    case BrdfModel::ashikhmin_shirley:
      return std::max(brdf.exponent, brdf.exponent_across) > 16;
    case BrdfModel::measured:
      return brdf.measured->roughness() < 0.35f;
  }
  return false;
}

bool is_anisotropic(const Brdf& brdf) {
  if (brdf.model == BrdfModel::ward) return brdf.roughness != brdf.roughness_across;
  return brdf.model == BrdfModel::ashikhmin_shirley && brdf.exponent != brdf.exponent_across;
}

}  // namespace rimlight

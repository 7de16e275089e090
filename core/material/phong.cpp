#include "core/material/phong.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rimlight::phong {
namespace {

constexpr float kInversePi = std::numbers::inv_pi_v<float>;

float mirror_cosine(const Vec3f& in, const Vec3f& out) {
  return std::clamp(in.z * out.z - in.x * out.x - in.y * out.y, 0.0f, 1.0f);
}

}  // namespace

Vec3f lobe(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  const float power = std::pow(mirror_cosine(in, out), brdf.exponent);
  return brdf.specular * ((brdf.exponent + 2) * (0.5f * kInversePi) * power);
}

float density(const Brdf& brdf, const Vec3f& in, const Vec3f& out) {
  return (brdf.exponent + 1) * (0.5f * kInversePi) *
         std::pow(mirror_cosine(in, out), brdf.exponent);
}

Vec3f draw(const Brdf& brdf, const Vec3f& out, const Sample2& at) {
  const double cosine = std::pow(1 - at.u, 1 / (static_cast<double>(brdf.exponent) + 1));
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const double phi = 2 * std::numbers::pi * at.v;
  const Frame<double> mirror(normalized(Vec3d(-out.x, -out.y, out.z)));
  return Vec3f(mirror.to_world({sine * std::cos(phi), sine * std::sin(phi), cosine}));
}

}  // namespace rimlight::phong

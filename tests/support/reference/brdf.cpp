#include "tests/support/reference/brdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rimlight::reference {
namespace {

constexpr double kPi = std::numbers::pi;

/// Midpoints of `steps` cells: of the lobe's own cumulative distribution in polar angle, equal in
/// φ.
template <typename Integrand>
double integrate_lobe(int steps, const Integrand& integrand) {
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < 2 * steps; ++j) {
      sum += integrand((i + 0.5) / steps, kPi * (j + 0.5) / steps);
    }
  }
  return sum / (2.0 * steps * steps);
}

Vec3d polar(double cosine, double phi) {
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}

double phong_albedo(const Brdf& brdf, int channel, const Vec3d& out, int steps) {
  const Frame<double> mirror(Vec3d(-out.x, -out.y, out.z));
  const double n = brdf.exponent;
  return integrate_lobe(steps, [&](double u, double phi) {
    const double cosine = std::pow(u, 1 / (n + 1));
    const Vec3d in = mirror.to_world(polar(cosine, phi));
    const double density = (n + 1) / (2 * kPi) * std::pow(cosine, n);
    return in.z > 0 ? specular(brdf, channel, in, out) * in.z / density : 0;
  });
}

double microfacet_albedo(const Brdf& brdf, int channel, const Vec3d& out, int steps) {
  const double m = brdf.roughness;
  return integrate_lobe(steps, [&](double u, double phi) {
    const double cosine = 1 / std::sqrt(1 - m * m * std::log(u));
    const Vec3d half = polar(cosine, phi);
    const double out_half = dot(out, half);
    const Vec3d in = half * (2 * out_half) - out;
    if (out_half <= 0 || in.z <= 0) return 0.0;
    const double density = beckmann(m, cosine) * cosine / (4 * out_half);
    return specular(brdf, channel, in, out) * in.z / density;
  });
}

}  // namespace

double fresnel(std::complex<double> index, double cosine) {
  const std::complex<double> refracted =
      std::sqrt(index * index - (1 - cosine * cosine));  // index · cos of the refracted angle
  const auto s = (cosine - refracted) / (cosine + refracted);
  const auto p = (index * index * cosine - refracted) / (index * index * cosine + refracted);
  return (std::norm(s) + std::norm(p)) / 2;
}

double beckmann(double roughness, double cosine) {
  const double c2 = cosine * cosine;
  const double m2 = roughness * roughness;
  return std::exp(-(1 - c2) / (c2 * m2)) / (kPi * m2 * c2 * c2);
}

double specular(const Brdf& brdf, int channel, const Vec3d& in, const Vec3d& out) {
  if (in.z <= 0 || out.z <= 0) return 0;
  if (brdf.model == BrdfModel::phong) {
    const double mirror = std::max(0.0, in.z * out.z - in.x * out.x - in.y * out.y);
    return brdf.specular[channel] * (brdf.exponent + 2.0) / (2 * kPi) *
           std::pow(mirror, static_cast<double>(brdf.exponent));
  }
  const Vec3d half = normalized(in + out);
  const double out_half = dot(out, half);
  const double g = std::min({1.0, 2 * half.z * in.z / out_half, 2 * half.z * out.z / out_half});
  const std::complex<double> index(brdf.eta[channel], brdf.k[channel]);
  return brdf.specular[channel] * fresnel(index, out_half) * beckmann(brdf.roughness, half.z) * g /
         (4 * in.z * out.z);
}

double specular_albedo(const Brdf& brdf, int channel, const Vec3d& out, int steps) {
  return brdf.model == BrdfModel::phong ? phong_albedo(brdf, channel, out, steps)
                                        : microfacet_albedo(brdf, channel, out, steps);
}

}  // namespace rimlight::reference

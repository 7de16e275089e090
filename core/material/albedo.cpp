#include "core/material/albedo.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "core/math/quadrature.h"

namespace rimlight {
namespace {

constexpr int kTurns = 48;

/// A half vector and its weight in the integral over θ_h and half of φ_h, both halves counted.
struct HalfPoint {
  Vec3d direction;
  double weight = 0;
};

std::vector<HalfPoint> half_points(int points) {
  std::vector<HalfPoint> result;
  result.reserve(kCurveBins * static_cast<std::size_t>(points * kTurns));
  const std::vector<QuadraturePoint> nodes = gauss_legendre(points);
  for (std::size_t bin = 0; bin < kCurveBins; ++bin) {
    const double begin = bin_begin(CurveAxis::half_angle, static_cast<double>(bin));
    const double end = bin_begin(CurveAxis::half_angle, static_cast<double>(bin + 1));
    for (const QuadraturePoint& node : nodes) {
      const double angle = 0.5 * (begin + end + (end - begin) * node.position);
      const double sine = std::sin(angle);
      const double weight =
          0.5 * (end - begin) * node.weight * sine * 2 * std::numbers::pi / kTurns;
      for (int turn = 0; turn < kTurns; ++turn) {
        const double phi = std::numbers::pi * (turn + 0.5) / kTurns;
        result.push_back({{sine * std::cos(phi), sine * std::sin(phi), std::cos(angle)}, weight});
      }
    }
  }
  return result;
}

/// dω_i = 4 cos θ_d dω_h.
Vec3d albedo_at(const IsotropicBrdf& f, const std::vector<HalfPoint>& points, double cosine) {
  const Vec3d out{std::sqrt(1 - cosine * cosine), 0, cosine};
  Vec3d sum;
  for (const HalfPoint& point : points) {
    const double out_half = dot(out, point.direction);
    const Vec3d in = point.direction * (2 * out_half) - out;
    if (!(out_half > 0 && in.z > 0)) continue;
    sum += f(in, out) * (4 * out_half * in.z * point.weight);
  }
  return sum;
}

/// ∫ of the diffuse term, which knows no φ.
Vec3d diffuse_albedo(const Brdf& brdf, double cosine) {
  static const std::vector<QuadraturePoint> nodes = gauss_legendre(16);
  const Vec3f out(Vec3d{std::sqrt(1 - cosine * cosine), 0, cosine});
  Vec3d sum;
  for (const QuadraturePoint& node : nodes) {
    const double mu = 0.5 * (1 + node.position);
    const Vec3f in(Vec3d{std::sqrt(1 - mu * mu), 0, mu});
    sum += Vec3d(evaluate_diffuse(brdf, in, out)) * (std::numbers::pi * node.weight * mu);
  }
  return sum;
}

}  // namespace

std::vector<DirectionalAlbedo> directional_albedos(const IsotropicBrdf& f, int points) {
  const std::vector<HalfPoint> half = half_points(points);
  std::vector<DirectionalAlbedo> result;
  for (const double cosine : {1.0, 0.9, 0.8, 0.65, 0.5, 0.35, 0.2, 0.1, 0.05, 0.02}) {
    result.push_back({cosine, albedo_at(f, half, cosine)});
  }
  return result;
}

std::vector<DirectionalAlbedo> directional_albedos(const CurvedBrdf& brdf) {
  RIMLIGHT_CHECK(!is_anisotropic(brdf.base));
  CurvedBrdf lobe = brdf;
  lobe.base.albedo = {};
  auto result = directional_albedos(
      [&](const Vec3d& in, const Vec3d& out) { return evaluate(lobe, in, out); });
  for (DirectionalAlbedo& at : result) at.albedo += diffuse_albedo(brdf.base, at.cosine);
  return result;
}

double largest_albedo(const std::vector<DirectionalAlbedo>& albedos) {
  double largest = 0;
  for (const DirectionalAlbedo& at : albedos) {
    largest = std::max(largest, max_component(at.albedo));
  }
  return largest;
}

}  // namespace rimlight

#include "core/material/brdf_curve.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/base/check.h"
#include "core/material/half_difference.h"
#include "core/math/quadrature.h"

// In double, apart from the renderer's float models: the quotient must be finite and exact where
// the factor is hundreds of orders of magnitude below its peak, for a drawn curve may be large
// there.

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHalfPi = kPi / 2;

/// Beckmann's D(θ_h) of roughness m.
double beckmann(double m, double angle) {
  const double cosine = std::max(std::cos(angle), 1e-12);
  const double tangent = std::sin(angle) / (cosine * m);
  return std::exp(-tangent * tangent - 4 * std::log(cosine)) / (kPi * m * m);
}

double blinn_phong_factor(double n, double angle) {
  const double scale = (n + 2) * (n + 4) / (8 * kPi * (std::exp2(-n / 2) + n));
  return scale * std::pow(std::max(0.0, std::cos(angle)), n);
}

double fresnel(std::complex<double> index, double angle) {
  const double cosine = std::max(std::cos(angle), 0.0), sine = std::sin(angle);
  const std::complex<double> refracted = std::sqrt(index * index - sine * sine);
  const auto s = (cosine - refracted) / (cosine + refracted);
  const auto p = (index * index * cosine - refracted) / (index * index * cosine + refracted);
  const double reflectance = (std::norm(s) + std::norm(p)) / 2;
  return std::isfinite(reflectance) ? reflectance : 1;  // 0/0: index 1 along the surface
}

Vec3d fresnel(const Brdf& brdf, double angle) {
  Vec3d result;
  for (int c = 0; c < 3; ++c) result[c] = fresnel({brdf.eta[c], brdf.k[c]}, angle);
  return result;
}

Vec3d schlick(const Vec3d& normal_reflectance, double angle) {
  const double power = std::pow(1 - std::clamp(std::cos(angle), 0.0, 1.0), 5);
  return normal_reflectance + (Vec3d{1, 1, 1} - normal_reflectance) * power;
}

std::optional<Vec3d> half_angle_factor(const Brdf& brdf, double angle) {
  if (brdf.model == BrdfModel::cook_torrance) {
    return Vec3d::filled(beckmann(brdf.roughness, angle));
  }
  if (brdf.model == BrdfModel::blinn_phong) {
    return Vec3d::filled(blinn_phong_factor(brdf.exponent, angle));
  }
  return std::nullopt;
}

std::optional<Vec3d> difference_angle_factor(const Brdf& brdf, double angle) {
  if (brdf.model == BrdfModel::cook_torrance) return fresnel(brdf, angle);
  if (brdf.model == BrdfModel::ashikhmin_shirley) return schlick(Vec3d(brdf.specular), angle);
  return std::nullopt;
}

/// G / (4 cos θ_i cos θ_o) of V-cavities. G = min(1, 2 cos θ_h cos θ / cos θ_d) with the lower θ,
/// so its quotient by cos θ_i cos θ_o is at most cos θ_h / (2 cos θ_d · the higher cosine).
double cavity(const HalfDifference& angles, const Vec3d& in, const Vec3d& out) {
  const double low = std::min(in.z, out.z), high = std::max(in.z, out.z);
  const double edge = 2 * std::cos(angles.half) / std::max(std::cos(angles.difference), 1e-12);
  return std::min(1 / low, edge) / (4 * high);
}

/// √((n_x + 1)(n_y + 1)) / 8π · cos^e θ_h / (cos θ_d · max(cos θ_i, cos θ_o)).
double anisotropic_rest(const Brdf& brdf, const Vec3d& in, const Vec3d& out) {
  const Vec3d sum = in + out;
  const double nx = brdf.exponent, ny = brdf.exponent_across;
  const double x2 = sum.x * sum.x, y2 = sum.y * sum.y, flat = x2 + y2;
  const double exponent = flat > 0 ? (nx * x2 + ny * y2) / flat : nx;
  const double power = std::exp(-0.5 * exponent * std::log1p(flat / (sum.z * sum.z)));
  const double difference_cosine = std::max(0.5 * length(sum), 1e-12);
  return std::sqrt((nx + 1) * (ny + 1)) / (8 * kPi) * power /
         (difference_cosine * std::max(in.z, out.z));
}

/// The lobe without any factor that factor() knows.
Vec3d bare(const Brdf& brdf, const HalfDifference& angles, const Vec3d& in, const Vec3d& out) {
  switch (brdf.model) {
    case BrdfModel::cook_torrance:
      return Vec3d(brdf.specular) * cavity(angles, in, out);
    case BrdfModel::ashikhmin_shirley:
      return Vec3d::filled(anisotropic_rest(brdf, in, out));
    case BrdfModel::blinn_phong:
      return Vec3d(brdf.specular);
    default:
      return Vec3d(evaluate_specular(brdf, Vec3f(in), Vec3f(out)));
  }
}

Vec3d curve_at(const BrdfCurve& curve, double angle) {
  return Vec3d(curve.values[bin_of(curve.axis, angle)]);
}

}  // namespace

double bin_begin(CurveAxis axis, double bin) {
  const double position = bin / kCurveBins;
  return kHalfPi * (axis == CurveAxis::half_angle ? position * position : position);
}

std::size_t bin_of(CurveAxis axis, double angle) {
  const double share = std::clamp(angle / kHalfPi, 0.0, 1.0);
  const double position = axis == CurveAxis::half_angle ? std::sqrt(share) : share;
  return std::min(kCurveBins - 1, static_cast<std::size_t>(position * kCurveBins));
}

BrdfCurve bin_averages(CurveAxis axis, const std::function<Vec3d(double)>& factor) {
  static const std::vector<QuadraturePoint> points = gauss_legendre(8);
  BrdfCurve curve{axis, {}};
  for (std::size_t bin = 0; bin < kCurveBins; ++bin) {
    const double begin = bin_begin(axis, static_cast<double>(bin));
    const double end = bin_begin(axis, static_cast<double>(bin + 1));
    Vec3d sum;
    double weights = 0;
    for (const QuadraturePoint& point : points) {
      const double angle = 0.5 * (begin + end + (end - begin) * point.position);
      const double weight = point.weight * (axis == CurveAxis::half_angle ? std::sin(angle) : 1);
      sum += factor(angle) * weight;
      weights += weight;
    }
    curve.values[bin] = Vec3f(sum / weights);
  }
  return curve;
}

std::optional<Vec3d> factor(const Brdf& brdf, CurveAxis axis, double angle) {
  return axis == CurveAxis::half_angle ? half_angle_factor(brdf, angle)
                                       : difference_angle_factor(brdf, angle);
}

std::optional<BrdfCurve> factor_curve(const Brdf& brdf, CurveAxis axis) {
  if (!factor(brdf, axis, 0)) return std::nullopt;
  return bin_averages(axis, [&](double angle) { return *factor(brdf, axis, angle); });
}

Vec3d quotient(const Brdf& brdf, FactorSet without, const Vec3d& in, const Vec3d& out) {
  if (!(in.z > 0 && out.z > 0)) return {};
  const HalfDifference angles = half_difference(in, out);
  const auto half = factor(brdf, CurveAxis::half_angle, angles.half);
  const auto difference = factor(brdf, CurveAxis::difference_angle, angles.difference);
  RIMLIGHT_CHECK(half || !without.half_angle);
  RIMLIGHT_CHECK(difference || !without.difference_angle);
  Vec3d result = bare(brdf, angles, in, out);
  if (half && !without.half_angle) result *= *half;
  if (difference && !without.difference_angle) result *= *difference;
  return result;
}

Vec3d evaluate(const CurvedBrdf& brdf, const Vec3d& in, const Vec3d& out) {
  if (!(in.z > 0 && out.z > 0)) return {};
  const FactorSet drawn{brdf.half_angle.has_value(), brdf.difference_angle.has_value()};
  Vec3d lobe = quotient(brdf.base, drawn, in, out);
  const HalfDifference angles = half_difference(in, out);
  if (drawn.half_angle) lobe *= curve_at(*brdf.half_angle, angles.half);
  if (drawn.difference_angle) lobe *= curve_at(*brdf.difference_angle, angles.difference);
  return Vec3d(evaluate_diffuse(brdf.base, Vec3f(in), Vec3f(out))) + lobe;
}

}  // namespace rimlight

// A clear day: the analytic sky of Preetham, Shirley and Smits 1999 ("A practical analytic model
// for daylight", the paper's appendix A.2), a sun of its true size and radiance, hills and ground.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/light/builtin_environment_images.h"
#include "core/light/environment_samples.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTurbidity = 2.6;
/// At 40°, to the right of −z, in the middle of a pixel, which then shows the sun's full radiance.
constexpr double kSunElevation = (0.5 - 142.5 / kBuiltinHeight) * kPi;
constexpr double kSunAzimuth = (688.5 / kBuiltinWidth - 0.5) * 2 * kPi;
constexpr double kSunRadius = 0.2665 * kPi / 180;
/// In the model's kcd/m²: 1.9e6 above the air, of which three quarters come down through it at 40°.
constexpr double kSunLuminance = 1.4e6;
constexpr double kUnit = 10;  // kcd/m²
const Vec3d kSunColour{1.04, 0.99, 0.86};

Vec3d sun_direction() {
  return {std::cos(kSunElevation) * std::sin(kSunAzimuth), std::sin(kSunElevation),
          -std::cos(kSunElevation) * std::cos(kSunAzimuth)};
}

/// Perez' distribution: a, b darken towards the horizon, c, d, e glow around the sun.
struct Perez {
  double a, b, c, d, e;

  double operator()(double cos_theta, double gamma) const {
    const double cos_gamma = std::cos(gamma);
    return (1 + a * std::exp(b / std::max(cos_theta, 0.02))) *
           (1 + c * std::exp(d * gamma) + e * cos_gamma * cos_gamma);
  }
};

double polynomial(double x, double c3, double c2, double c1, double c0) {
  return ((c3 * x + c2) * x + c1) * x + c0;
}

class ClearSky {
 public:
  ClearSky() {
    const double t = kTurbidity, theta = kPi / 2 - kSunElevation;
    luminance_ = {0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251,
                  0.1206 * t - 2.5771, -0.0670 * t + 0.3703};
    x_ = {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
          -0.0033 * t + 0.0452};
    y_ = {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
          -0.0109 * t + 0.0529};
    const double chi = (4.0 / 9 - t / 120) * (kPi - 2 * theta);
    zenith_ = {
        (4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192,
        polynomial(theta, 0.00166, -0.00375, 0.00209, 0) * t * t +
            polynomial(theta, -0.02903, 0.06377, -0.03202, 0.00394) * t +
            polynomial(theta, 0.11693, -0.21196, 0.06052, 0.25886),
        polynomial(theta, 0.00275, -0.00610, 0.00317, 0) * t * t +
            polynomial(theta, -0.04214, 0.08970, -0.04153, 0.00516) * t +
            polynomial(theta, 0.15346, -0.26756, 0.06670, 0.26688),
    };
    at_zenith_ = {luminance_(1, theta), x_(1, theta), y_(1, theta)};
  }

  /// Linear sRGB in kcd/m²; directions below the horizon look as it does.
  Vec3d radiance(const Vec3d& direction) const {
    const double cos_theta = std::max(direction.y, 0.0);
    const double gamma = std::acos(std::clamp(dot(direction, sun_direction()), -1.0, 1.0));
    const double luminance = zenith_.x * luminance_(cos_theta, gamma) / at_zenith_.x;
    const double x = zenith_.y * x_(cos_theta, gamma) / at_zenith_.y;
    const double y = zenith_.z * y_(cos_theta, gamma) / at_zenith_.z;
    const double cie_x = luminance * x / y, cie_z = luminance * (1 - x - y) / y;
    const Vec3d rgb = {3.2406 * cie_x - 1.5372 * luminance - 0.4986 * cie_z,
                       -0.9689 * cie_x + 1.8758 * luminance + 0.0415 * cie_z,
                       0.0557 * cie_x - 0.2040 * luminance + 1.0570 * cie_z};
    // Dust near the ground, which the model leaves out, warms the horizon.
    const Vec3d haze = Vec3d{0.20, 0.04, -0.12} * std::exp(-cos_theta / 0.09);
    return Vec3d{std::max(rgb.x, 0.0), std::max(rgb.y, 0.0), std::max(rgb.z, 0.0)} *
           (Vec3d::filled(1) + haze);
  }

 private:
  Perez luminance_{}, x_{}, y_{};
  Vec3d zenith_;     // (Y, x, y) of the zenith
  Vec3d at_zenith_;  // the distributions there
};

/// ∫ L cos θ dω over the upper half, sun included.
Vec3d ground_irradiance(const ClearSky& sky) {
  constexpr int kSteps = 48;
  Vec3d sum =
      kSunColour * (kSunLuminance * 2 * kPi * (1 - std::cos(kSunRadius)) * std::sin(kSunElevation));
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < 2 * kSteps; ++j) {
      const double z = std::sqrt((i + 0.5) / kSteps);  // cosine-weighted
      const double r = std::sqrt(1 - z * z), phi = kPi * (j + 0.5) / kSteps;
      sum +=
          sky.radiance({r * std::cos(phi), z, r * std::sin(phi)}) * (kPi / (2.0 * kSteps * kSteps));
    }
  }
  return sum;
}

/// Elevation of a ridge of hills, in radians.
double ridge(double azimuth, double height, std::uint64_t seed) {
  double sum = 0;
  for (int octave = 0; octave < 5; ++octave) {
    const double period = 3 << octave;
    // Noise around a circle, so that the ridge closes.
    sum += std::pow(0.5, octave) * smooth_noise(period * std::cos(azimuth) + 100,
                                                period * std::sin(azimuth) + 100,
                                                seed + static_cast<std::uint64_t>(octave));
  }
  return height * (sum - 0.55);
}

class Landscape {
 public:
  Landscape() : irradiance_(ground_irradiance(sky_)) {}

  Vec3d radiance(const Vec3d& direction) const {
    if (direction.y > kHighestRidge) return sky_.radiance(direction) / kUnit;
    const double elevation = std::asin(std::clamp(direction.y, -1.0, 1.0));
    const double azimuth = std::atan2(direction.x, -direction.z);
    const Vec3d horizon = sky_.radiance({direction.x, 0.03, direction.z});
    if (elevation < 0) return ground(direction, elevation, horizon) / kUnit;
    const Vec3d forest = Vec3d{0.05, 0.07, 0.035} * irradiance_ / kPi;
    if (elevation < ridge(azimuth, 0.045, 3)) return blended(forest, horizon, 0.45) / kUnit;
    if (elevation < ridge(azimuth + 2, 0.085, 4)) return blended(forest, horizon, 0.75) / kUnit;
    return sky_.radiance(direction) / kUnit;
  }

 private:
  static constexpr double kHighestRidge = 0.13;  // in radians, and so in y

  static Vec3d blended(const Vec3d& a, const Vec3d& b, double share) {
    return a * (1 - share) + b * share;
  }

  Vec3d ground(const Vec3d& direction, double elevation, const Vec3d& horizon) const {
    const double distance = 1 / std::max(-direction.y, 1e-3);
    const double x = direction.x * distance, z = direction.z * distance;
    const double patches = smooth_noise(0.35 * x, 0.35 * z, 7);
    const double grain = smooth_noise(3 * x, 3 * z, 8);
    const Vec3d albedo = blended({0.25, 0.20, 0.13}, {0.14, 0.15, 0.07}, patches) *
                         (0.85 + 0.3 * grain * std::min(1.0, 8 / distance));
    return blended(albedo * irradiance_ / kPi, horizon, 0.6 * std::exp(elevation / 0.06));
  }

  ClearSky sky_;
  Vec3d irradiance_;
};

/// Adds the disc: what share of each pixel's solid angle it covers, by points.
void add_sun(RgbImage& image) {
  constexpr int kPoints = 48;
  const Vec3d sun = sun_direction();
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Vec3d middle = lat_long_direction(x + 0.5, y + 0.5, image.width, image.height);
      if (dot(middle, sun) < std::cos(kSunRadius + 2 * kPi / image.width)) continue;
      int inside = 0;
      for (int i = 0; i < kPoints * kPoints; ++i) {
        const int point_x = i % kPoints, point_y = i / kPoints;
        const Vec3d direction =
            lat_long_direction(x + (point_x + 0.5) / kPoints, y + (point_y + 0.5) / kPoints,
                               image.width, image.height);
        if (dot(direction, sun) >= std::cos(kSunRadius)) ++inside;
      }
      image.at(x, y) += Vec3f(kSunColour * (kSunLuminance / kUnit * inside / (kPoints * kPoints)));
    }
  }
}

}  // namespace

RgbImage sunny_image() {
  const Landscape landscape;
  RgbImage image =
      render_lat_long(2, [&](const Vec3d& direction) { return landscape.radiance(direction); });
  add_sun(image);
  return image;
}

}  // namespace rimlight

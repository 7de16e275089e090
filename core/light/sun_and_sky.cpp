#include "core/light/sun_and_sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace rimlight {
namespace {

/// The brightest of the ring over the brightest of the spot, at most.
constexpr double kMostBrightRing = 0.5;
/// A disc of at most the spot's radius is in the middle after two.
constexpr int kMoves = 2;

double luminance(const Vec3d& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

/// Texels about the brightest one.
struct Spot {
  std::size_t brightest = 0;
  std::vector<std::size_t> texels;
  Vec3d surroundings;         // the ring's mean
  double brightest_ring = 0;  // luminance
};

std::size_t brightest_texel(const CubeLight& light) {
  std::size_t brightest = 0;
  double most = -1;
  for (std::size_t i = 0; i < light.count(); ++i) {
    const double value = luminance(Vec3d(light.at(i)));
    if (value <= most) continue;
    most = value;
    brightest = i;
  }
  return brightest;
}

/// To where the bright texels near a direction are: the brightest may be any of a disc.
Vec3d moved_to_middle(const CubeLight& light, const Vec3d& direction, double inside, double least) {
  Vec3d sum;
  for (std::size_t i = 0; i < light.count(); ++i) {
    const Vec3d way = cube::texel_direction(i, light.size);
    if (dot(way, direction) < inside) continue;
    const double value = luminance(Vec3d(light.at(i)));
    if (value >= least) sum += way * (value * cube::texel_solid_angle(i, light.size));
  }
  return dot(sum, sum) > 0 ? normalized(sum) : direction;
}

Spot find_spot(const CubeLight& light) {
  Spot spot;
  spot.brightest = brightest_texel(light);
  const double texel = std::numbers::pi / 2 / light.size;
  const double radius = std::max(kSunSpotRadius, texel / 2);
  const double inside = std::cos(radius), ring_end = std::cos(2 * radius + texel);
  Vec3d middle = cube::texel_direction(spot.brightest, light.size);
  const double least = kMostBrightRing * luminance(Vec3d(light.at(spot.brightest)));
  for (int i = 0; i < kMoves; ++i) middle = moved_to_middle(light, middle, inside, least);
  double solid_angle = 0;
  for (std::size_t i = 0; i < light.count(); ++i) {
    const double cosine = dot(cube::texel_direction(i, light.size), middle);
    if (cosine < ring_end) continue;
    if (cosine >= inside) {
      spot.texels.push_back(i);
      continue;
    }
    const double part = cube::texel_solid_angle(i, light.size);
    const Vec3d radiance(light.at(i));
    spot.surroundings += radiance * part;
    spot.brightest_ring = std::max(spot.brightest_ring, luminance(radiance));
    solid_angle += part;
  }
  if (solid_angle > 0) spot.surroundings = spot.surroundings / solid_angle;
  return spot;
}

/// What was cut off the texels of a spot: radiance · solid angle of each.
std::vector<Vec3d> cut(const Spot& spot, CubeLight& sky) {
  std::vector<Vec3d> excess(spot.texels.size());
  for (std::size_t k = 0; k < excess.size(); ++k) {
    const std::size_t texel = spot.texels[k];
    for (int c = 0; c < 3; ++c) {
      float& value = sky.channel(c)[texel];
      const float kept = std::min(value, static_cast<float>(spot.surroundings[c]));
      excess[k][c] = (static_cast<double>(value) - kept) * cube::texel_solid_angle(texel, sky.size);
      value = kept;
    }
  }
  return excess;
}

/// An even disc of radius r has the second moment r²/2 about its middle; texels of width w add
/// w²/6.
double radius_of(const Spot& spot, const std::vector<Vec3d>& excess, const Vec3d& middle,
                 int size) {
  double moment = 0, sum = 0, spread = 0;
  for (std::size_t k = 0; k < excess.size(); ++k) {
    const std::size_t texel = spot.texels[k];
    const Vec3d away = cube::texel_direction(texel, size) - middle;
    const double weight = luminance(excess[k]);
    moment += weight * dot(away, away);
    spread += weight * cube::texel_solid_angle(texel, size) / 6;
    sum += weight;
  }
  return std::sqrt(std::max(0.0, 2 * (moment - spread) / sum));
}

Sun sun_of(const Spot& spot, const std::vector<Vec3d>& excess, int size) {
  Sun sun;
  Vec3d sum;
  for (std::size_t k = 0; k < excess.size(); ++k) {
    sun.irradiance += excess[k];
    sum += cube::texel_direction(spot.texels[k], size) * luminance(excess[k]);
  }
  if (!(dot(sum, sum) > 0)) return sun;
  sun.direction = normalized(sum);
  sun.angular_radius = radius_of(spot, excess, sun.direction, size);
  return sun;
}

/// Luminous irradiance of a surface that faces a direction.
double facing_irradiance(const CubeLight& light, const Vec3d& direction) {
  double sum = 0;
  for (std::size_t i = 0; i < light.count(); ++i) {
    const double cosine = dot(cube::texel_direction(i, light.size), direction);
    if (cosine <= 0) continue;
    sum += luminance(Vec3d(light.at(i))) * cosine * cube::texel_solid_angle(i, light.size);
  }
  return sum;
}

}  // namespace

SunAndSky split_sun(const CubeLight& light) {
  const Spot spot = find_spot(light);
  const double brightest = luminance(Vec3d(light.at(spot.brightest)));
  if (!(brightest > 0) || spot.brightest_ring > kMostBrightRing * brightest) return {light, {}};
  CubeLight sky = light;
  const Sun sun = sun_of(spot, cut(spot, sky), light.size);
  const double of_sun = luminance(sun.irradiance);
  if (!(of_sun > 0)) return {light, {}};
  const double all = of_sun + facing_irradiance(sky, sun.direction);
  if (of_sun < kLeastSunShare * all) return {light, {}};
  return {std::move(sky), sun};
}

}  // namespace rimlight

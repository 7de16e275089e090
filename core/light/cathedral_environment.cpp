// A nave in the morning: two rows of lancet windows and a rose, small and very bright, over dim
// warm stone. The light of the windows on the walls is what LitRoom makes of it.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/light/builtin_environment_images.h"
#include "core/light/lit_room.h"

namespace rimlight {
namespace {

constexpr double kBay = 5;                     // metres from one window to the next
constexpr Vec3d kGlassMean{0.66, 0.41, 0.36};  // of the colours below

/// Stained glass: a colour for each pane. Gold and white are the most, so that the stone stays
/// warm.
Vec3d glass(std::int64_t i, std::int64_t j, std::uint64_t seed) {
  constexpr std::array<Vec3d, 8> kColours = {{{0.95, 0.07, 0.05},
                                              {0.06, 0.14, 1.0},
                                              {0.95, 0.52, 0.10},
                                              {1.0, 0.68, 0.20},
                                              {0.10, 0.62, 0.22},
                                              {0.32, 0.08, 0.60},
                                              {1.0, 0.86, 0.60},
                                              {0.90, 0.34, 0.08}}};
  const double choice = lattice_noise(i, j, seed);
  const double depth = 0.6 + 0.8 * lattice_noise(i, j, seed + 1);
  return kColours[static_cast<std::size_t>(choice * 8)] * depth;
}

/// A pointed window of panes between leads, with a mullion down its middle.
std::optional<Vec3d> lancet(double s, double t, double brightness, std::uint64_t seed) {
  // Above the springing line two arcs close the window to a point.
  const double arch = t > 0.45 ? (t - 0.45) / 0.55 : 0;
  if (std::abs(s) > std::sqrt(std::max(1 - arch * arch, 0.0)) * (1 - 0.25 * arch))
    return std::nullopt;
  const double across = (s + 1) * 2.5, up = (t + 1) * 7;
  const double lead_x = std::abs(across - std::round(across));
  const double lead_y = std::abs(up - std::round(up));
  if (std::abs(s) < 0.07) return Vec3d{0.02, 0.017, 0.014};
  if (lead_x < 0.06 || lead_y < 0.07) return Vec3d::filled(0.03);
  return glass(static_cast<std::int64_t>(std::floor(across)),
               static_cast<std::int64_t>(std::floor(up)), seed) *
         brightness;
}

/// A round window: an eye, and petals in two rings.
std::optional<Vec3d> rose(double s, double t, double brightness) {
  const double r = std::sqrt(s * s + t * t);
  if (r > 1) return std::nullopt;
  const double turn = std::atan2(t, s) / (2 * std::numbers::pi) + 1;
  if (r < 0.2) return Vec3d{1.0, 0.72, 0.25} * brightness;
  const int ring = r < 0.55 ? 0 : 1;
  const double petals = ring == 0 ? 12 : 24;
  const double petal = turn * petals;
  const double within = petal - std::floor(petal) - 0.5;
  const double middle = ring == 0 ? 0.375 : 0.77, half = ring == 0 ? 0.165 : 0.2;
  const double shape = std::pow(within / 0.45, 2) + std::pow((r - middle) / half, 4);
  if (shape > 1) return Vec3d{0.06, 0.05, 0.04};
  return glass(static_cast<std::int64_t>(std::floor(petal)) % static_cast<std::int64_t>(petals),
               100 + ring, 5) *
         brightness;
}

RoomLight lancet_window(double x, double z, double brightness, std::uint64_t seed) {
  RoomLight light;
  light.centre = {x, 8.2, z};
  light.half_right = {0, 0, x > 0 ? 0.62 : -0.62};  // right × up faces the nave
  light.half_up = {0, 2.3, 0};
  light.mean_radiance = kGlassMean * (0.6 * brightness);
  light.radiance = [=](double s, double t) { return lancet(s, t, brightness, seed); };
  return light;
}

RoomLight rose_window(double z, double brightness) {
  RoomLight light;
  light.centre = {0, 8.6, z};
  light.half_right = {z > 0 ? -2.3 : 2.3, 0, 0};
  light.half_up = {0, 2.3, 0};
  light.mean_radiance = kGlassMean * (0.5 * brightness);
  light.radiance = [=](double s, double t) { return rose(s, t, brightness); };
  return light;
}

/// Blocks in running bond: mortar, and a shade for each block.
double masonry(double s, double t) {
  const double course = std::floor(t / 0.55);
  const double along = s / 1.1 + 0.5 * (course - 2 * std::floor(course / 2));
  const double joint_s = std::abs(along - std::round(along)) * 1.1;
  const double joint_t = std::abs(t / 0.55 - std::round(t / 0.55)) * 0.55;
  if (joint_s < 0.03 || joint_t < 0.03) return 0.6;
  const auto block = static_cast<std::int64_t>(std::floor(along));
  return 0.82 + 0.3 * lattice_noise(block, static_cast<std::int64_t>(course), 11);
}

Vec3d stone(const WallPoint& point) {
  const Vec3d warm{0.25, 0.215, 0.165};
  const double stain = 0.75 + 0.5 * smooth_noise(0.4 * point.s, 0.4 * point.t, 12);
  const double bay = point.s / kBay;
  const double from_pier = std::abs(bay - std::round(bay)) * kBay;  // windows lie between piers
  if (point.normal.y > 0) {  // the floor: flagstones by turns
    const bool dark =
        (static_cast<int>(std::floor(point.s / 0.9) + std::floor(point.t / 0.9)) & 1) != 0;
    return Vec3d{0.22, 0.17, 0.13} * (dark ? 0.5 : 1.0) * stain;
  }
  if (point.normal.y < 0) {  // the vault: ribs across each bay and along its diagonals
    const double z = point.t / kBay - std::floor(point.t / kBay);
    const double diagonal = std::abs(std::abs(z - 0.5) * 2 - std::abs(point.s) / 5.5);
    const bool rib = std::min(z, 1 - z) < 0.04 || diagonal < 0.05;
    return warm * (rib ? 1.0 : 0.55) * stain;
  }
  const bool long_wall = point.normal.x != 0;
  if (long_wall && from_pier < 0.55) {  // a round pier
    return warm * (1.15 * std::sqrt(1 - std::pow(from_pier / 0.6, 2)) + 0.15) * stain;
  }
  if (long_wall && point.t < 4.2) {  // the arcade: dark arches into the aisles
    const double half = 1.6,
                 height =
                     2.6 + std::sqrt(std::max(0.0, 1 - std::pow((kBay / 2 - from_pier) / half, 2)));
    if (kBay / 2 - from_pier < half && point.t < height) return warm * 0.12;
  }
  if (long_wall && std::abs(point.t - 4.9) < 0.12) return warm * 1.3;  // a string course
  return warm * masonry(point.s, point.t) * stain;
}

}  // namespace

RgbImage cathedral_image() {
  LitRoom room;
  room.low = {-5.5, -1.7, -27.5};
  room.high = {5.5, 13, 12.5};
  room.ambient = {0.34, 0.25, 0.17};
  room.albedo = stone;
  std::uint64_t seed = 100;
  for (double z = -4.5 * kBay; z < 12; z += kBay) {
    // The sun stands on the right.
    room.lights.push_back(lancet_window(5.4, z, 420, seed += 10));
    room.lights.push_back(lancet_window(-5.4, z, 110, seed += 10));
  }
  room.lights.push_back(rose_window(-27.3, 260));
  room.lights.push_back(rose_window(12.3, 60));
  return render_lat_long(2, [&](const Vec3d& direction) { return room.radiance(direction); });
}

}  // namespace rimlight

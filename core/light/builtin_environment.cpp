#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/light/builtin_environment_images.h"
#include "core/light/environment.h"
#include "core/light/environment_samples.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

struct Builtin {
  const char* name;
  RgbImage (*image)();
};

constexpr std::array<Builtin, 3> kBuiltins = {
    {{"sunny", sunny_image}, {"studio", studio_image}, {"cathedral", cathedral_image}}};

}  // namespace

const std::vector<std::string>& builtin_environment_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    result.reserve(kBuiltins.size());
    for (const Builtin& builtin : kBuiltins) result.emplace_back(builtin.name);
    return result;
  }();
  return names;
}

Environment builtin_environment(const std::string& name) {
  std::string known;
  for (const Builtin& builtin : kBuiltins) {
    if (name == builtin.name) {
      return Environment(name, builtin.image(), EnvironmentLayout::lat_long);
    }
    known += known.empty() ? quote(builtin.name) : ", " + quote(builtin.name);
  }
  throw Error("environment", quote(name), known);
}

RgbImage render_lat_long(int samples, const std::function<Vec3d(const Vec3d&)>& radiance) {
  RgbImage image(kBuiltinWidth, kBuiltinHeight);
  parallel_for(kBuiltinHeight, [&](std::size_t row) {
    for (int x = 0; x < image.width; ++x) {
      Vec3d sum;
      for (int i = 0; i < samples * samples; ++i) {
        const int sample_x = i % samples, sample_y = i / samples;
        const double px = x + (sample_x + 0.5) / samples;
        const double py = static_cast<double>(row) + (sample_y + 0.5) / samples;
        sum += radiance(lat_long_direction(px, py, image.width, image.height));
      }
      image.at(x, static_cast<int>(row)) = Vec3f(sum / (static_cast<double>(samples) * samples));
    }
  });
  return image;
}

double lattice_noise(std::int64_t x, std::int64_t y, std::uint64_t seed) {
  const auto place = mix_bits(static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ULL + seed);
  return static_cast<double>(mix_bits(place + static_cast<std::uint64_t>(y)) >> 11) * 0x1p-53;
}

double smooth_noise(double x, double y, std::uint64_t seed) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy);
  const auto ease = [](double t) { return t * t * (3 - 2 * t); };
  const double sx = ease(x - fx), sy = ease(y - fy);
  return std::lerp(
      std::lerp(lattice_noise(ix, iy, seed), lattice_noise(ix + 1, iy, seed), sx),
      std::lerp(lattice_noise(ix, iy + 1, seed), lattice_noise(ix + 1, iy + 1, seed), sx), sy);
}

}  // namespace rimlight

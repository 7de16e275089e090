#include "core/light/environment.h"

#include <utility>

#include "core/base/error.h"
#include "core/light/environment_samples.h"

namespace rimlight {
namespace {

constexpr Vec3d kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

const std::array<CubeLayout, 4> kCubeLayouts = {{
    {4,
     3,
     {{{2, 1, kX, kZ, kY},
       {0, 1, -kX, -kZ, kY},
       {1, 0, kY, kX, kZ},
       {1, 2, -kY, kX, -kZ},
       {3, 1, kZ, -kX, kY},
       {1, 1, -kZ, kX, kY}}}},
    {3,
     4,
     {{{2, 1, kX, kZ, kY},
       {0, 1, -kX, -kZ, kY},
       {1, 0, kY, kX, kZ},
       {1, 2, -kY, kX, -kZ},
       {1, 3, kZ, kX, -kY},
       {1, 1, -kZ, kX, kY}}}},
    {6,
     1,
     {{{0, 0, kX, kZ, kY},
       {1, 0, -kX, -kZ, kY},
       {2, 0, kY, kX, kZ},
       {3, 0, -kY, kX, -kZ},
       {4, 0, kZ, -kX, kY},
       {5, 0, -kZ, kX, kY}}}},
    {1,
     6,
     {{{0, 0, kX, kZ, kY},
       {0, 1, -kX, -kZ, kY},
       {0, 2, kY, kX, kZ},
       {0, 3, -kY, kX, -kZ},
       {0, 4, kZ, -kX, kY},
       {0, 5, -kZ, kX, kY}}}},
}};

EnvironmentLayout layout_of_sides(int width, int height) {
  if (width == height) return EnvironmentLayout::angular_map;
  if (find_cube_layout(width, height) != nullptr) return EnvironmentLayout::cube;
  return EnvironmentLayout::lat_long;
}

std::string sides(const RgbImage& image) {
  return std::to_string(image.width) + "×" + std::to_string(image.height) + " pixels";
}

void check_sides(const std::string& name, const RgbImage& image, EnvironmentLayout layout) {
  if (image.width < 1 || image.height < 1) {
    throw Error(name, sides(image), "an image of at least one pixel");
  }
  if (layout == EnvironmentLayout::angular_map && image.width != image.height) {
    throw Error(name, sides(image), "a square image for an angular map");
  }
  if (layout == EnvironmentLayout::cube && find_cube_layout(image.width, image.height) == nullptr) {
    throw Error(name, sides(image), "sides as 4:3, 3:4, 6:1 or 1:6 for a cube");
  }
}

/// Sums of 512 texels of a face, and of those times transport, stay within floats.
constexpr float kLargestRadiance = 1e32f;

bool is_radiance(const Vec3f& pixel) {
  for (int c = 0; c < 3; ++c) {
    if (!(pixel[c] >= 0 && pixel[c] <= kLargestRadiance)) return false;
  }
  return true;
}

void check_radiance(const std::string& name, const RgbImage& image) {
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const Vec3f& pixel = image.pixels[i];
    if (is_radiance(pixel)) continue;
    const auto width = static_cast<std::size_t>(image.width);
    throw Error(
        name + ": pixel (" + std::to_string(i % width) + ", " + std::to_string(i / width) + ")",
        std::to_string(pixel.x) + " " + std::to_string(pixel.y) + " " + std::to_string(pixel.z),
        "a finite radiance of at least 0, at most 1e32");
  }
}

/// ∫ L dω of some rows.
struct IntegralSink {
  Vec3d radiance;
  Vec3d sum;

  void begin_pixel(const Vec3f& pixel) { radiance = Vec3d(pixel); }
  void add(const Vec3d&, double solid_angle) { sum += radiance * solid_angle; }
};

}  // namespace

const CubeLayout* find_cube_layout(int width, int height) {
  for (const CubeLayout& layout : kCubeLayouts) {
    if (width % layout.columns == 0 && height % layout.rows == 0 &&
        width / layout.columns == height / layout.rows) {
      return &layout;
    }
  }
  return nullptr;
}

Environment::Environment(std::string name, RgbImage image, EnvironmentLayout layout)
    : name_(std::move(name)),
      image_(std::move(image)),
      layout_(layout == EnvironmentLayout::automatic ? layout_of_sides(image_.width, image_.height)
                                                     : layout) {
  check_sides(name_, image_, layout_);
  check_radiance(name_, image_);
}

Vec3d integral(const Environment& environment) {
  // Parts of a degree: exact for lat-long at any step, to 1e-4 for the others' small images.
  const SampledRows rows = {0, environment.image().height, std::numbers::pi / 180};
  IntegralSink sink;
  sample_rows(environment, rows, sink);
  return sink.sum;
}

}  // namespace rimlight

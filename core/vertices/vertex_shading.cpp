#include "core/vertices/vertex_shading.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/basis/sh_kernel.h"
#include "core/vertices/vertex_lobe_kernel.h"

namespace rimlight {
namespace {

/// Pixels are shaded by so many in a square: those share vertices, and the rows of these stay in
/// the first-level cache.
constexpr int kBlockSide = 8;
constexpr std::size_t kBlockPixels = kBlockSide * kBlockSide;
static_assert(kBlockPixels == kPanelLanes);
constexpr int kTileSide = static_cast<int>(TileImage::kSide);

/// The highlights of one block on their way.
struct Highlights {
  std::size_t count = 0;
  alignas(64) std::array<float, kBlockPixels> x{}, y{}, z{};  // mirrored directions
  std::array<MirroringPoint, kBlockPixels> points;
  std::array<Vec3f, kBlockPixels> weights;        // of the highlight's channels
  std::array<std::uint16_t, kBlockPixels> place;  // in the tile
  std::array<float, 3 * kBlockPixels> radiance;
  AlignedVector<float> panel, rows;  // harmonics: [coefficient][pixel], [pixel][stride]

  static Highlights& of_thread() {
    thread_local Highlights highlights;
    return highlights;
  }
};

/// (s + 1)/2π · max(0, cosine)^s.
float phong_value(double exponent, double cosine) {
  // No way (zero: no highlight is there) looks like one at right angles.
  if (!(cosine > 0)) return 0;
  return static_cast<float>((exponent + 1) / (2 * std::numbers::pi) *
                            std::pow(std::min(cosine, 1.0), exponent));
}

class TileShader {
 public:
  TileShader(const VertexShading& shading, int left, int top, int width, int height,
             TileImage& image)
      : shading_(shading),
        left_(left),
        top_(top),
        width_(width),
        height_(height),
        share_(1.0f / static_cast<float>(shading.view.layer_count())),
        image_(image),
        highlights_(Highlights::of_thread()) {
    const std::size_t count = sh::coefficient_count(shading.visibility_degree);
    highlights_.panel.resize(count * kBlockPixels);
    highlights_.rows.resize(shading.lighting.stride() * kBlockPixels);
  }

  /// Pixels from (x, y) of the tile on.
  void shade_block(int x, int y) {
    for (std::size_t layer = 0; layer < shading_.view.layer_count(); ++layer) {
      highlights_.count = 0;
      const int step = shading_.view.step(), side = kBlockSide * step;
      for (int row = y; row < std::min(y + side, height_); row += step) {
        for (int column = x; column < std::min(x + side, width_); column += step) {
          shade_pixel(layer, column, row);
        }
      }
      if (highlights_.count > 0) add_highlights();
    }
  }

 private:
  void shade_pixel(std::size_t layer, int column, int row) {
    const PrimaryHit& hit = shading_.view.hit(layer, left_ + column, top_ + row);
    if (hit.is_miss()) return;
    const auto& corners = shading_.mesh.triangles[hit.triangle];
    const std::array<float, 3> weights = {1 - hit.u - hit.v, hit.u, hit.v};
    const auto& diffuse = shading_.diffuse;
    const Vec3f radiance = diffuse[corners[0]] * weights[0] + diffuse[corners[1]] * weights[1] +
                           diffuse[corners[2]] * weights[2];
    const auto place = static_cast<std::uint16_t>(row * kTileSide + column);
    add(place, radiance * share_);
    const std::uint32_t material = shading_.mesh.materials[corners[0]];
    if (shading_.sun != nullptr) {
      add(place, sunlight(layer, left_ + column, top_ + row, corners, weights) * share_);
    }
    if (!shading_.materials.has_highlight(material)) return;
    const Vec3f& way = shading_.view.mirrored(layer, left_ + column, top_ + row);
    if (way == Vec3f()) return;
    const std::size_t i = highlights_.count++;
    highlights_.x[i] = way.x;
    highlights_.y[i] = way.y;
    highlights_.z[i] = way.z;
    MirroringPoint& point = highlights_.points[i];
    for (std::size_t k = 0; k < 3; ++k) point.corners[k] = shading_.lighting.incident(corners[k]);
    point.weights = weights;
    point.lobe = shading_.materials.lobe(material);
    highlights_.weights[i] = shading_.materials.at(material).highlight * share_;
    highlights_.place[i] = place;
  }

  /// What a pixel reflects of the sun.
  Vec3f sunlight(std::size_t layer, int x, int y, const std::array<std::uint32_t, 3>& corners,
                 const std::array<float, 3>& weights) const {
    const SunAtPoint& at = shading_.shadows.at(
        layer, static_cast<std::size_t>(y) * static_cast<std::size_t>(width_of_view()) +
                   static_cast<std::size_t>(x));
    if (!(at.visible > 0)) return {};
    const VertexMesh& mesh = shading_.mesh;
    const std::uint32_t index = mesh.materials[corners[0]];
    const VertexMaterial& material = shading_.materials.at(index);
    const Vec3f tint = mesh.tints[corners[0]] * weights[0] + mesh.tints[corners[1]] * weights[1] +
                       mesh.tints[corners[2]] * weights[2];
    Vec3f reflected = tint * material.albedo * (at.cosine * std::numbers::inv_pi_v<float>);
    if (shading_.materials.has_highlight(index)) {
      const Vec3f& way = shading_.view.mirrored(layer, x, y);
      reflected += material.highlight *
                   phong_value(material.exponent, dot(Vec3d(way), shading_.sun->direction));
    }
    return reflected * Vec3f(shading_.sun->irradiance) * at.visible;
  }
  int width_of_view() const { return shading_.view.width(); }

  void add_highlights() {
    const std::size_t count = highlights_.count, padded = sh::padded(count);
    const std::size_t stride = shading_.lighting.stride();
    std::fill(highlights_.x.begin() + static_cast<std::ptrdiff_t>(count),
              highlights_.x.begin() + static_cast<std::ptrdiff_t>(padded), 1.0f);
    sh::evaluate({std::span(highlights_.x).first(padded), std::span(highlights_.y).first(padded),
                  std::span(highlights_.z).first(padded)},
                 shading_.visibility_degree, highlights_.panel, kBlockPixels);
    transpose_panel(highlights_.panel.data(), sh::coefficient_count(shading_.visibility_degree),
                    highlights_.rows.data(), stride);
    gather_lobes(std::span(highlights_.points).first(count), highlights_.rows.data(), stride,
                 highlights_.radiance.data());
    for (std::size_t i = 0; i < count; ++i) {
      const float* const radiance = highlights_.radiance.data() + 3 * i;
      add(highlights_.place[i],
          highlights_.weights[i] * Vec3f(radiance[0], radiance[1], radiance[2]));
    }
  }

  void add(std::size_t place, const Vec3f& radiance) {
    for (std::size_t c = 0; c < 3; ++c) image_.channel[c][place] += radiance[static_cast<int>(c)];
  }

  const VertexShading& shading_;
  int left_, top_, width_, height_;
  float share_;
  TileImage& image_;
  Highlights& highlights_;
};

/// The pixels of even x and y to the three beside and below.
void spread(TileImage& image) {
  for (auto& channel : image.channel) {
    for (std::size_t y = 0; y < TileImage::kSide; ++y) {
      for (std::size_t x = 0; x < TileImage::kSide; ++x) {
        const std::size_t known = (y & ~std::size_t{1}) * TileImage::kSide + (x & ~std::size_t{1});
        channel[y * TileImage::kSide + x] = channel[known];
      }
    }
  }
}

}  // namespace

double shade_tile(const VertexShading& shading, int left, int top, TileImage& image) {
  for (auto& channel : image.channel) channel.fill(0);
  const int width = std::min(kTileSide, shading.view.width() - left);
  const int height = std::min(kTileSide, shading.view.height() - top);
  TileShader shader(shading, left, top, width, height, image);
  const int side = kBlockSide * shading.view.step();
  for (int y = 0; y < height; y += side) {
    for (int x = 0; x < width; x += side) shader.shade_block(x, y);
  }
  if (shading.view.step() == 2) spread(image);
  double square = 0;
  for (const auto& channel : image.channel) {
    for (const float value : channel) square += static_cast<double>(value) * value;
  }
  return square;
}

}  // namespace rimlight

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include "core/image/image.h"
#include "core/light/environment.h"

namespace rimlight {

/// The direction of a point of a lat-long image, in pixels from its top left corner.
inline Vec3d lat_long_direction(double x, double y, int width, int height) {
  const double phi = (x / width - 0.5) * 2 * std::numbers::pi;
  const double theta = y / height * std::numbers::pi;
  const double r = std::sin(theta);
  return {r * std::sin(phi), std::cos(theta), -r * std::cos(phi)};
}

/// One face of a cube layout: its place in units of faces, and how it looks at the world.
struct CubeLayoutFace {
  int column, row;
  Vec3d forward, right, up;
};

/// A cube layout: columns × rows squares, six of which are faces.
struct CubeLayout {
  int columns, rows;
  std::array<CubeLayoutFace, cube::kFaces> faces;
};

/// The layout that fits the sides exactly; null when none does.
const CubeLayout* find_cube_layout(int width, int height);

/// Rows [begin, end) of an image, cut into parts of at most `step` radians: infinity leaves the
/// pixels whole.
struct SampledRows {
  int begin = 0;
  int end = 0;
  double step = std::numeric_limits<double>::infinity();

  int parts(double angle) const { return std::max(1, static_cast<int>(std::ceil(angle / step))); }
};

// Each function below calls, for every pixel of the rows that covers any direction,
//     sink.begin_pixel(radiance), and for every part of it
//     sink.add(direction of the part's middle, solid angle of the part).

template <typename Sink>
void sample_lat_long(const RgbImage& image, const SampledRows& rows, Sink& sink) {
  const double pixel_phi = 2 * std::numbers::pi / image.width;
  const double pixel_theta = std::numbers::pi / image.height;
  const int parts_y = rows.parts(pixel_theta);
  std::vector<Vec3d> around;  // of the parts of a row: (sin φ, 0, −cos φ)
  std::vector<Vec3d> rings(static_cast<std::size_t>(parts_y));  // (sin θ, cos θ, solid angle)
  for (int y = rows.begin; y < rows.end; ++y) {
    const double theta = y * pixel_theta, next_theta = theta + pixel_theta;
    const double half_turn = std::numbers::pi / 2;
    const double widest = theta < half_turn && next_theta > half_turn
                              ? 1
                              : std::max(std::abs(std::sin(theta)), std::abs(std::sin(next_theta)));
    const int parts_x = rows.parts(pixel_phi * widest);
    const auto columns = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(parts_x);
    if (around.size() != columns) {
      around.resize(columns);
      for (std::size_t i = 0; i < columns; ++i) {
        const double phi = (static_cast<double>(i) + 0.5) / parts_x * pixel_phi - std::numbers::pi;
        around[i] = {std::sin(phi), 0, -std::cos(phi)};
      }
    }
    for (std::size_t j = 0; j < rings.size(); ++j) {
      const double top = theta + pixel_theta * static_cast<double>(j) / parts_y;
      const double bottom = theta + pixel_theta * static_cast<double>(j + 1) / parts_y;
      const double middle = 0.5 * (top + bottom);
      rings[j] = {std::sin(middle), std::cos(middle),
                  pixel_phi / parts_x * (std::cos(top) - std::cos(bottom))};
    }
    for (int x = 0; x < image.width; ++x) {
      sink.begin_pixel(image.at(x, y));
      const Vec3d* const part = around.data() + static_cast<std::ptrdiff_t>(x) * parts_x;
      for (const Vec3d& ring : rings) {
        for (int i = 0; i < parts_x; ++i) {
          sink.add({part[i].x * ring.x, ring.y, part[i].z * ring.x}, ring.z);
        }
      }
    }
  }
}

template <typename Sink>
void sample_angular_map(const RgbImage& image, const SampledRows& rows, Sink& sink) {
  // A step in r turns by π times it; a step around by sin πr / r, which is never more.
  const double pixel = 2.0 / image.width;
  const int parts = rows.parts(pixel * std::numbers::pi);
  const double side = pixel / parts;
  for (int y = rows.begin; y < rows.end; ++y) {
    for (int x = 0; x < image.width; ++x) {
      sink.begin_pixel(image.at(x, y));
      for (int j = 0; j < parts; ++j) {
        const double t = 1 - (y * pixel + (j + 0.5) * side);
        for (int i = 0; i < parts; ++i) {
          const double s = x * pixel + (i + 0.5) * side - 1;
          const double r = std::sqrt(s * s + t * t);
          if (r > 1) continue;
          const double angle = std::numbers::pi * r;
          const double sine_by_r = r > 1e-8 ? std::sin(angle) / r : std::numbers::pi;
          // dω = sin πr d(πr) dψ and ds dt = r dr dψ
          sink.add({sine_by_r * s, sine_by_r * t, -std::cos(angle)},
                   std::numbers::pi * sine_by_r * side * side);
        }
      }
    }
  }
}

template <typename Sink>
void sample_cube(const RgbImage& image, const SampledRows& rows, Sink& sink) {
  const CubeLayout& layout = *find_cube_layout(image.width, image.height);
  const int size = image.width / layout.columns;
  const double pixel = 2.0 / size;  // at a face's middle; narrower elsewhere
  const int parts = rows.parts(pixel);
  const double side = pixel / parts;
  for (int y = rows.begin; y < rows.end; ++y) {
    for (const CubeLayoutFace& face : layout.faces) {
      if (face.row != y / size) continue;
      for (int x = 0; x < size; ++x) {
        sink.begin_pixel(image.at(face.column * size + x, y));
        for (int j = 0; j < parts; ++j) {
          const double t = 1 - (y % size * pixel + (j + 0.5) * side);
          for (int i = 0; i < parts; ++i) {
            const double s = x * pixel + (i + 0.5) * side - 1;
            const double q = 1 + s * s + t * t;
            sink.add(face.forward + face.right * s + face.up * t, side * side / (q * std::sqrt(q)));
          }
        }
      }
    }
  }
}

template <typename Sink>
void sample_rows(const Environment& environment, const SampledRows& rows, Sink& sink) {
  switch (environment.layout()) {
    case EnvironmentLayout::angular_map:
      return sample_angular_map(environment.image(), rows, sink);
    case EnvironmentLayout::cube:
      return sample_cube(environment.image(), rows, sink);
    case EnvironmentLayout::lat_long:
    case EnvironmentLayout::automatic:
      return sample_lat_long(environment.image(), rows, sink);
  }
}

}  // namespace rimlight

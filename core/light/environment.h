#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "core/light/cube_light.h"

namespace rimlight {

/// How an image covers the sphere of directions. World axes: y up; right-handed.
///   lat_long     width = 360°, height = 180°; the top row looks to +y; the middle of the image
///   looks to
///                −z, and +x lies to the right of it
///   angular_map  the light-probe ball image: the circle r ≤ 1 inscribed in a square image; for
///   image
///                right s, up t: r = |(s, t)|, direction (sin πr · s/r, sin πr · t/r, −cos πr).
///                Pixels outside the circle are ignored
///   cube         six faces in a cross (4×3 or 3×4) or a strip (6×1 or 1×6)
enum class EnvironmentLayout { automatic, lat_long, angular_map, cube };

/// Distant lighting, as an image over directions with everything needed to project it.
class Environment {
 public:
  /// `automatic` decides by the sides: 1:1 angular map; 4:3, 3:4, 6:1, 1:6 cube; else lat-long.
  /// Throws Error (naming `name`) when the layout does not fit the sides.
  Environment(std::string name, RgbImage image,
              EnvironmentLayout layout = EnvironmentLayout::automatic);

  const std::string& name() const { return name_; }
  EnvironmentLayout layout() const { return layout_; }
  const RgbImage& image() const { return image_; }

  /// Texel means on a size × size cube map, by solid angle. Conserves ∫ L dω of the image (a sun of
  /// one pixel included) and keeps a uniform image uniform, both to 0.1 %. Deterministic at any
  /// thread count.
  CubeLight project(int size) const;

 private:
  std::string name_;
  RgbImage image_;
  EnvironmentLayout layout_;
};

/// The environments that are made by code: "sunny", "studio", "cathedral".
const std::vector<std::string>& builtin_environment_names();
/// Throws Error for an unknown name.
Environment builtin_environment(const std::string& name);

/// Reads .hdr or .exr (core/image/image_file.h). The name is the file's stem.
Environment load_environment(const std::filesystem::path& path,
                             EnvironmentLayout layout = EnvironmentLayout::automatic);

}  // namespace rimlight

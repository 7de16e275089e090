#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "core/light/cube_light.h"

namespace rimlight {

/// How an image covers the sphere of directions. World axes: y up, right-handed; images as seen by
/// an observer in the middle, not mirrored.
///
///   lat_long     width = 360°, height = 180°, of any sides; the top row looks to +y; the middle of
///                the image looks to −z, and +x lies to the right of it
///   angular_map  the light-probe image, square: the circle r ≤ 1 inscribed; for right s, up t:
///                r = |(s, t)|, direction (sin πr · s/r, sin πr · t/r, −cos πr). What lies outside
///                the circle is ignored
///   cube         six square faces; each looks along its name's axis, with image up as given:
///
///                4×3 cross        +y           3×4 cross     +y        up of +y is +z, of −y is
///                              −x −z +x +z                −x −z +x     −z, of all others +y; but
///                              in
///                                 −y                         −y        the 3×4 cross +z stands on
///                                                            +z        its head: up is −y
///                6×1 and 1×6 strip: +x −x +y −y +z −z, left to right or top to bottom; ups as in
///                the 4×3 cross
enum class EnvironmentLayout { automatic, lat_long, angular_map, cube };

/// Distant lighting, as an image over directions with everything needed to project it. Immutable:
/// any thread may use it.
class Environment {
 public:
  /// `automatic` decides by the sides: 1:1 angular map; 4:3, 3:4, 6:1, 1:6 cube; else lat-long.
  /// Throws Error (naming `name`) when the layout does not fit the sides, or a radiance is
  /// negative, not finite or above 1e32 (naming its pixel).
  Environment(std::string name, RgbImage image,
              EnvironmentLayout layout = EnvironmentLayout::automatic);

  const std::string& name() const { return name_; }
  /// Never `automatic`.
  EnvironmentLayout layout() const { return layout_; }
  const RgbImage& image() const { return image_; }

  /// Texel means on a size × size cube map (2 … cube::kLargestSize), by solid angle. Conserves
  /// ∫ L dω of the image (a sun of one pixel included) and keeps a uniform image uniform, both to
  /// 0.1 %. Deterministic at any thread count. About a second for 8192×4096 on two cores.
  ///
  /// Every pixel is cut into parts of at most 1/8 of a texel (finer for small sizes), and each part
  /// belongs to the texel that its middle falls into. Radiance up to 16 times the mean is averaged
  /// over the parts that a texel got (so that a uniform image stays uniform, whatever they sum to);
  /// what exceeds it is energy, divided by the texel's true solid angle (so that a small bright
  /// source keeps it all).
  CubeLight project(int size) const;

 private:
  std::string name_;
  RgbImage image_;
  EnvironmentLayout layout_;
};

/// ∫ L dω over the sphere, from the pixels themselves, per channel.
Vec3d integral(const Environment& environment);

/// The environments that are made by code: "sunny", "studio", "cathedral".
///   sunny      a clear sky (Preetham 1999) with a sun of true size and radiance at 40°, hills and
///              ground; radiance in units of 10 kcd/m²
///   studio     a dark neutral room with soft boxes: key, fill, two rim strips and an overhead one
///   cathedral  small coloured windows, very bright, over dim warm stone
const std::vector<std::string>& builtin_environment_names();
/// Throws Error for an unknown name. Takes some tenths of a second.
Environment builtin_environment(const std::string& name);

/// Reads .hdr or .exr (core/image/image_file.h). The name is the file's stem. Throws Error.
Environment load_environment(const std::filesystem::path& path,
                             EnvironmentLayout layout = EnvironmentLayout::automatic);

}  // namespace rimlight

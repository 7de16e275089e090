#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/light/cube_light.h"
#include "core/math/vec.h"

namespace rimlight {

/// Texels as points of light, as a kernel reads them: each with the middles of its four quarters
/// and their solid angles (TexelQuadrature). Padded to a multiple of kVector by points of no solid
/// angle.
struct LightPoints {
  static constexpr std::size_t kVector = 16;
  static constexpr std::size_t kQuarters = 4;

  struct Quarter {
    AlignedVector<float> x, y, z, solid_angle;  // [point]
  };
  /// A cone about all quarters of kVector points.
  struct Cone {
    float x = 0, y = 0, z = 1;
    float sine = 1;  // of its half angle
  };

  std::array<Quarter, kQuarters> quarters;
  std::vector<Cone> cones;  // [point / kVector]

  std::size_t size() const { return quarters[0].x.size(); }
};

/// Where the light comes from, for one size of cube map. Points go by blocks of 8 × 8 texels, as
/// SkyVisibilityView stores them. Immutable; any thread.
class CurveSky {
 public:
  /// A multiple of 8, else CheckFailure.
  explicit CurveSky(int cube_size);

  int cube_size() const { return cube_size_; }
  const LightPoints& texels() const { return texels_; }
  /// Texels of a quarter of the size, four of a block.
  const LightPoints& coarse() const { return coarse_; }
  /// The texel of a point, [6 N²], and its point.
  std::span<const std::uint32_t> texel_of_point() const { return texel_of_point_; }
  std::span<const std::uint32_t> point_of_texel() const { return point_of_texel_; }
  /// ∫ dω over a point's texel, [6 N²].
  std::span<const float> solid_angles() const { return solid_angles_; }

 private:
  int cube_size_;
  LightPoints texels_, coarse_;
  std::vector<std::uint32_t> texel_of_point_, point_of_texel_;
  std::vector<float> solid_angles_;
};

/// Radiance at points: [3][point], and which points have any.
struct PointRadiance {
  std::array<AlignedVector<float>, 3> radiance;
  AlignedVector<float> is_lit;           // 1 or 0
  std::vector<std::uint8_t> lit_vector;  // [point / kVector]
};

/// A light as it is summed over the sky: all texels; and, for the quick image, the strongest ones
/// by radiance · solid angle, and the mean of the rest over 4 × 4 texels. Any thread may read it.
/// The sky must outlive it.
class CurveLight {
 public:
  /// `light`: texels of the sky's size, finite, else CheckFailure. `strongest` at most all.
  CurveLight(const CurveSky& sky, const CubeLight& light, std::size_t strongest);
  /// Another light of as many strongest texels; allocates nothing. CheckFailure as above.
  void set(const CubeLight& light);

  const CurveSky& sky() const { return *sky_; }
  const PointRadiance& texels() const { return texels_; }
  const PointRadiance& coarse() const { return coarse_; }
  /// The strongest texels as points of their own, and which points of the sky they are.
  const LightPoints& strongest_points() const { return strongest_points_; }
  const PointRadiance& strongest() const { return strongest_; }
  std::span<const std::uint32_t> strongest_indices() const { return strongest_indices_; }

 private:
  void find_strongest();
  void take_strongest();
  void find_means();

  const CurveSky* sky_;
  PointRadiance texels_, coarse_, strongest_;
  LightPoints strongest_points_;
  std::vector<std::uint32_t> strongest_indices_;
  // Where a light is worked out.
  struct Mean {
    Vec3d sum;
    double solid_angle = 0;
  };
  std::vector<std::uint32_t> order_;
  std::vector<Mean> means_;
};

}  // namespace rimlight

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/material/brdf.h"
#include "core/material/factorization.h"
#include "core/math/vec.h"

namespace rimlight {

/// A material whose BRDF sessions edit, as it was baked.
struct CurveMaterial {
  std::string name;
  Brdf brdf;
  /// A measured one in the place of `brdf`, in factors.
  std::optional<FactoredBrdf> measured = {};
  std::string measured_name = {};  // that one's, among the bake's
};

/// A hit that stands for a surface in one quarter of each texel: unit vectors in the world. The
/// frame of its BRDF is Frame(normal, tangent); the tangent may be zero.
struct SurfacePoint {
  Vec3f normal, tangent;
  Vec3f geometric_normal;
  Vec3f outgoing;  // towards the camera
};
inline constexpr std::size_t kSurfacePoints = 4;

/// Something of an editable material that a pixel shows: the hits of its primary rays that look
/// alike.
struct CurveSurface {
  std::uint32_t receiver = 0;  // of PixelLayout
  std::uint32_t material = 0;  // index among the bake's CurveMaterials
  float share = 0;             // of the pixel's primary rays, (0, 1]
  Vec3f tint;                  // of the texture: multiplies the material's albedo
  std::array<SurfacePoint, kSurfacePoints> points;
};

/// How much of each texel of the sky each surface sees, in fifths: what lets the direct light of
/// any environment be found again without a ray. A texel's solid angle faces a surface in part
/// where the horizon cuts it; that is not in it.
///
/// Blocks of 8 × 8 texels of a face are all 0, all 5, or mixed; only mixed ones are stored, four
/// bits a texel. A view of memory that its owner keeps.
class SkyVisibilityView {
 public:
  static constexpr int kBlockSide = 8;
  static constexpr std::size_t kMixedBytes = kBlockSide * kBlockSide / 2;
  static constexpr std::uint8_t kAll = 5;
  enum class Block : std::uint8_t { none, all, mixed };

  int cube_size = 0;                                             // N, a multiple of 8
  std::span<const Block> blocks;                                 // [surface][6 (N/8)²]
  std::span<const std::uint64_t> first_mixed;                    // [surface + 1]
  std::span<const std::array<std::uint8_t, kMixedBytes>> mixed;  // low bits first

  std::size_t blocks_per_surface() const;
  std::size_t surface_count() const { return first_mixed.empty() ? 0 : first_mixed.size() - 1; }
  /// A surface's fifths, [texel].
  void unpack(std::size_t surface, std::span<std::uint8_t> fifths) const;
};

/// Packs surfaces one after the other.
class SkyVisibilityPacker {
 public:
  explicit SkyVisibilityPacker(int cube_size);

  /// [texel], each 0 … 5, else CheckFailure.
  void add(std::span<const std::uint8_t> fifths);
  void append(const SkyVisibilityPacker& other);
  /// Of this object's memory.
  SkyVisibilityView view() const;

 private:
  int cube_size_;
  std::vector<SkyVisibilityView::Block> blocks_;
  std::vector<std::uint64_t> first_mixed_{0};
  std::vector<std::array<std::uint8_t, SkyVisibilityView::kMixedBytes>> mixed_;
};

/// What the direct light of editable materials is made of: surfaces, sorted by their receiver's
/// tile, then by material, then by receiver, and what they see of the sky. Views of memory that an
/// owner keeps.
struct CurveReceivers {
  std::span<const CurveMaterial> materials;
  std::span<const CurveMaterial> measured;  // that sessions may load, each with factors
  std::span<const CurveSurface> surfaces;
  SkyVisibilityView visibility;  // [surface]
};

}  // namespace rimlight

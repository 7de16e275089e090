#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "core/material/half_difference.h"
#include "core/math/vec.h"

namespace rimlight {

/// A measured isotropic BRDF, linear RGB without cosine. Immutable; any thread.
class MeasuredBrdf {
 public:
  virtual ~MeasuredBrdf() = default;

  /// The value for a pair of directions with these angles, finite and ≥ 0; nothing where there is
  /// no sample, or where a direction is not above the horizon.
  std::optional<Vec3d> at(const HalfDifference& angles) const;
  /// The same for two unit directions in the shading frame (normal = +z).
  std::optional<Vec3d> at(const Vec3d& in, const Vec3d& out) const;

 private:
  /// Both directions are above the horizon.
  virtual std::optional<Vec3d> value(const HalfDifference& angles,
                                     const DirectionPair& pair) const = 0;
};

/// Reads a file by the ending of its name: .binary (MERL), .brdf (Cornell) or .bsdf (RGL). Throws
/// Error when it is none of them, cannot be read, or is not what its format asks for.
std::unique_ptr<const MeasuredBrdf> load_measured_brdf(const std::filesystem::path& path);

}  // namespace rimlight

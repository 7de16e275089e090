#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/material/measured_brdf.h"

namespace rimlight {

/// The layout of the MERL files (Matusik, Pfister, Brand and McMillan 2003), little-endian: three
/// 32-bit integers 90 90 180, then for red, green and blue [θ_h][θ_d][φ_d] doubles. Bin i of θ_h
/// begins at (i / 90)² · π/2, of θ_d at (i / 90) · π/2, of φ_d at (i / 180) · π; φ_d and φ_d + π
/// are the same by reciprocity.
inline constexpr std::size_t kMerlHalf = 90, kMerlDifference = 90, kMerlAzimuth = 180;
inline constexpr std::size_t kMerlBins = kMerlHalf * kMerlDifference * kMerlAzimuth;
inline constexpr std::size_t kMerlHeaderBytes = 12;
inline constexpr std::size_t kMerlBytes = kMerlHeaderBytes + 3 * kMerlBins * 8;
static_assert(kMerlBytes == 34'992'012);
/// What a stored number of each channel is multiplied with.
inline constexpr double kMerlScale[3] = {1.0 / 1500, 1.15 / 1500, 1.66 / 1500};

/// A MERL `.binary`: constant in each bin; a bin with a negative number holds no sample. 17 MB.
class MerlBrdf : public MeasuredBrdf {
 public:
  /// Throws Error unless `bytes` are a whole file of finite numbers; `source` names it there.
  MerlBrdf(std::span<const std::byte> bytes, const std::string& source);

  /// The bin of angles, and of a bin's sample.
  static std::size_t bin_of(const HalfDifference& angles);

 private:
  std::optional<Vec3d> value(const HalfDifference& angles,
                             const DirectionPair& pair) const override;

  std::vector<float> values_;  // [channel][bin], scaled; −1: no sample
};

}  // namespace rimlight

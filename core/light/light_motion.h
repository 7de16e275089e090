#pragma once

#include <cstdint>
#include <vector>

#include "core/math/rotation.h"
#include "core/math/vec.h"

namespace rimlight {

// How things change in time. Time goes in frames from 0; a motion of n frames (2 or more) makes its
// last step to frame n − 1 and holds still from there on, bit for bit.

/// The share of an eased motion that is done: 0 at frame 0, 1 at the last; slow at both ends.
double eased_share(int frame, int frames);

/// A turn about an axis that speeds up, keeps its speed, and slows down (Overbeck 2006, figure
/// 6.4). The speed eases as 3x² − 2x³; angles are its integral in closed form.
struct EasedTurn {
  Vec3d axis{0, 1, 0};  // not zero
  double peak = 0;      // radians a frame
  int frames = 2;
  int ease_in = 0;   // steps of speeding up
  int ease_out = 0;  // and of slowing down; together at most frames − 1

  /// Radians turned by since frame 0.
  double angle(int frame) const;
  Quaternion rotation(int frame) const;
};

/// A way over the sphere along great circles, by angle.
class SpherePath {
 public:
  /// One or more unit directions, none opposite to the one before.
  explicit SpherePath(std::vector<Vec3d> points);

  /// The unit direction at a share (0 … 1) of the way; the first and last points exactly at 0 and
  /// 1.
  Vec3d at(double share) const;
  /// Radians.
  double length() const { return ends_.back(); }

 private:
  std::vector<Vec3d> points_;
  std::vector<double> ends_;  // of the way from the first point to each
};

/// A factor that varies at random within a band of frequencies, about 1:
///
///   factor(f) = 1 + amount · n(f),  n(f) = Σ over k of a_k cos(2π k f / T + p_k),  T = frames − 1
///
/// with k, in cycles over T, from the band, and seeded amplitudes and phases; the largest |n| is 1.
/// Its mean over a period is 1, and it ends as it began, without a jump.
struct FlickerSettings {
  double amount = 0;  // 0 … 1
  int frames = 0;
  int lowest_cycles = 1;   // at least 1
  int highest_cycles = 1;  // below (frames − 1) / 2
  std::uint64_t seed = 1;
};

class Flicker {
 public:
  explicit Flicker(const FlickerSettings& settings);

  int frames() const { return static_cast<int>(factors_.size()); }
  double factor(int frame) const;

 private:
  std::vector<double> factors_;  // [frames]
};

}  // namespace rimlight

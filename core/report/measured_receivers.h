#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/light/cube_light.h"
#include "core/relight/relighter.h"
#include "core/transport/bake_folder.h"
#include "core/transport/reference_rows.h"

namespace rimlight {

/// The receivers that a report measures on, of those that geometry covers: those of the bake's
/// reference rows; or, when it has none, of a seeded sample of 128 groups. One thread at a time;
/// computes on all cores.
class MeasuredReceivers {
 public:
  /// The bake outlives it.
  explicit MeasuredReceivers(const Bake& bake);

  std::size_t count() const { return receivers_.size(); }
  /// Numbers in the bake: [count()], ascending.
  std::span<const std::size_t> indices() const { return receivers_; }
  /// Whether reference() is the uncompressed transport's.
  bool has_rows() const { return rows_.has_value(); }

  /// What a relighter shows: [count()], linear radiance.
  void gather(const Relighter& relighter, std::vector<Vec3f>& image) const;
  /// The uncompressed rows times full lights (coefficients), in double: [light][count()]. Only with
  /// has_rows().
  std::vector<std::vector<Vec3f>> reference(std::span<const CubeLight> lights) const;
  /// Only with has_rows().
  const ReferenceRows& rows() const { return *rows_; }
  /// Of an image of all the rows [group · 64 + receiver in the group], the measured ones:
  /// [count()].
  std::vector<Vec3f> select(const std::vector<Vec3f>& of_rows) const;

 private:
  std::optional<ReferenceRows> rows_;
  std::vector<std::size_t> receivers_;  // ascending
  std::vector<std::size_t> row_;        // of each, in what the rows give
  std::vector<std::size_t> first_;      // of each tile with receivers, into receivers_; and the end
};

}  // namespace rimlight

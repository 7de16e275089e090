#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/light/cube_light.h"
#include "core/transport/bake_folder.h"
#include "core/transport/receivers.h"
#include "core/transport/tensor_file.h"

namespace rimlight {

/// The file of a bake's reference rows; a bake may be without.
inline constexpr const char* kReferenceFile = "reference.safetensors";

/// Groups of rows that the file holds.
struct ReferenceCounts {
  std::size_t rows = 0;
  std::size_t retraced = 0;
  std::size_t finer = 0;
};

/// Its tensors, to be written in this order; those of no group are left away:
///   "first_receiver" [groups], "rows" [groups][columns][3][64]     M before anything is left out
///   "retraced_receiver", "retraced_rows"                           of some of these groups, M as
///                                                                  another seed makes it
///   "finer_receiver", "finer_rows" [groups][3 · columns][3][64]    of these, M's finest band on a
///                                                                  cube map of twice the size
/// First receivers ascend.
std::vector<TensorShape> reference_tensors(const ReferenceCounts& groups, std::size_t column_count);

/// The rows of M of some groups of 8×8 pixels as they were before compression: what images are
/// measured against. A view of the bake's file. Any thread.
class ReferenceRows {
 public:
  /// Which of the file's rows.
  enum class Kind { rows, retraced, finer };

  /// Nothing when the bake was made without. Hashes and checks the tensors, which may be gigabytes.
  /// Throws Error naming file and tensor. The bake outlives it.
  static std::optional<ReferenceRows> open(const Bake& bake, Kind kind = Kind::rows);

  /// The groups' first receivers.
  std::span<const std::uint64_t> groups() const { return groups_; }
  /// A group's rows: [columns][3][64]; may be of numbers that are not finite.
  std::span<const float> group(std::size_t group) const {
    return rows_.subspan(group * columns_ * kGroupFloats, columns_ * kGroupFloats);
  }

  /// For each light the sum over columns of row · coefficient, in double: radiance [light][group ·
  /// 64 + receiver in the group]. Of a light on the finer cube map, for Kind::finer: its finest
  /// band alone counts. Reads the rows once for all lights; in parallel over groups. Throws Error
  /// when a row is not finite.
  std::vector<std::vector<Vec3f>> multiply(std::span<const CubeLight> lights) const;

 private:
  ReferenceRows() = default;
  void multiply_group(std::size_t group, std::span<const CubeLight> lights,
                      std::vector<std::vector<Vec3f>>& images) const;

  std::string rows_name_;  // file and tensor
  std::size_t columns_ = 0;
  std::size_t first_column_ = 0;  // of the light, that the first row stands for
  std::span<const std::uint64_t> groups_;
  std::span<const float> rows_;
};

}  // namespace rimlight

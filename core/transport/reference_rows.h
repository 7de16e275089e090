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

/// Its tensors, to be written in this order: "first_receiver" [groups], ascending, and "rows"
/// [groups][columns][3][64], M before anything is left out.
std::vector<TensorShape> reference_tensors(std::size_t group_count, std::size_t column_count);

/// The rows of M of some groups of 8×8 pixels as they were before compression: what images are
/// measured against. A view of the bake's file. Any thread.
class ReferenceRows {
 public:
  /// Nothing when the bake was made without. Hashes and checks the file, which may be gigabytes.
  /// Throws Error naming file and tensor. The bake outlives it.
  static std::optional<ReferenceRows> open(const Bake& bake);

  /// The groups' first receivers.
  std::span<const std::uint64_t> groups() const { return groups_; }
  /// A group's rows: [columns][3][64]; may be of numbers that are not finite.
  std::span<const float> group(std::size_t group) const {
    return rows_.subspan(group * columns_ * kGroupFloats, columns_ * kGroupFloats);
  }

  /// For each light the sum over columns of row · coefficient, in double: radiance [light][group ·
  /// 64 + receiver in the group]. Reads the rows once for all lights; in parallel over groups.
  /// Throws Error when a row is not finite.
  std::vector<std::vector<Vec3f>> multiply(std::span<const CubeLight> lights) const;

 private:
  ReferenceRows() = default;
  void multiply_group(std::size_t group, std::span<const CubeLight> lights,
                      std::vector<std::vector<Vec3f>>& images) const;

  std::string path_;
  std::size_t columns_ = 0;
  std::span<const std::uint64_t> groups_;
  std::span<const float> rows_;
};

}  // namespace rimlight

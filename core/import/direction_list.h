#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/math/vec.h"

namespace rimlight {

inline constexpr std::size_t kMostDirections = std::size_t{1} << 17;

/// The axes that a list's directions are given in; both right-handed.
///   y_up  the world's own
///   z_up  (x, y, z) is the world's (x, z, −y)
enum class DirectionAxes { y_up, z_up };
Vec3d to_world(const Vec3d& given, DirectionAxes axes);

/// The lights of transport that was made elsewhere: one a column of a matrix, or one a picture.
struct DirectionList {
  std::string source;                        // stands in errors
  DirectionAxes axes = DirectionAxes::y_up;  // that the list was written in
  std::vector<Vec3d> directions;    // unit, from the scene towards the light, in the world's axes
  std::vector<double> weights;      // solid angles in steradians, > 0; one a direction, or none
  std::vector<std::string> images;  // one a direction, or none

  std::size_t size() const { return directions.size(); }
};

/// Reads a list of light directions by its ending (docs/formats/import.md):
///   .json        an object that states its axes; `axes`, if given, must be the same
///   .npy         [n][3], or [n][4] with a weight last
///   .txt, .csv   a line a direction: x y z, or x y z weight; a picture's name may stand first;
///                numbers separated by blanks, commas or semicolons; '#' begins a comment
/// where `axes` are those of .npy and text (y_up when not given). Directions may have any length
/// from 1e-6 to 1e6. Throws Error naming the file and the line or field: no direction or more than
/// kMostDirections, numbers missing, left over or not finite, a length of 0, a weight that is not
/// in (0, 1e6], weights or names for some and not for others.
DirectionList read_directions(const std::filesystem::path& path,
                              std::optional<DirectionAxes> axes = std::nullopt);

/// The same for a text in memory; `source` stands in errors.
DirectionList parse_direction_text(std::string_view text, const std::string& source,
                                   DirectionAxes axes);
DirectionList parse_direction_json(std::string_view text, const std::string& source);

}  // namespace rimlight

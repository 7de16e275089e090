#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "core/transport/sketch.h"
#include "core/transport/tile_transport.h"

namespace rimlight {

// Parts of an unfinished bake, to resume from. A part is the tensor file `path`, and beside it
// `path`.json with its hashes and `fingerprint`, which says what the part was made from. Both are
// written beside and renamed: a killed writer leaves no part that loads. Saving throws Error.
// Loading gives nothing when the part is missing, damaged, or of another fingerprint or shape: then
// it is made again.

void save_part(const std::filesystem::path& path, const TileTransport& tile,
               std::uint64_t fingerprint);
std::optional<TileTransport> load_part(const std::filesystem::path& path, std::size_t column_count,
                                       std::uint64_t fingerprint);

void save_sketch_sums(const std::filesystem::path& path, const SketchSums& sums,
                      std::uint64_t fingerprint);
/// Fills sums; false, and sums untouched, when there is no such part.
bool load_sketch_sums(const std::filesystem::path& path, SketchSums& sums,
                      std::uint64_t fingerprint);

/// Removes a part, if it is there.
void remove_part(const std::filesystem::path& path);

}  // namespace rimlight

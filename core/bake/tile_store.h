#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "core/bake/tile_check.h"
#include "core/transport/sketch.h"
#include "core/transport/tile_transport.h"

namespace rimlight {

/// The finished tiles of an unfinished bake, on disk. Tiles of another fingerprint do not count.
/// Different tiles may be used at once from several threads.
class TileStore {
 public:
  struct Shape {
    std::size_t tiles = 0;
    std::size_t columns = 0;
    std::size_t lights = 0;
  };
  /// Creates the folder. Throws Error.
  TileStore(std::filesystem::path folder, const Shape& shape, std::uint64_t fingerprint);

  const Shape& shape() const { return shape_; }
  bool has(std::size_t tile) const;
  void save(std::size_t tile, const TileTransport& transport, const TileCheck& check) const;
  /// Throws Error when the tile is not there: has() was true, but the disk changed since.
  TileTransport transport(std::size_t tile) const;
  TileCheck check(std::size_t tile) const;

  /// Keeps the sketch sums of tiles 0 … next_tile − 1, in the place of those of fewer tiles.
  void save_sums(std::size_t next_tile, const SketchSums& sums) const;
  /// Loads the sums of the most tiles that are there; returns how many, 0 with sums of zero.
  std::size_t load_sums(SketchSums& sums) const;

 private:
  std::filesystem::path path(std::size_t tile, const char* ending) const;

  std::filesystem::path folder_;
  Shape shape_;
  std::uint64_t fingerprint_;
};

}  // namespace rimlight

#include "core/bake/tile_store.h"

#include <algorithm>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/transport/part_file.h"

namespace rimlight {

TileStore::TileStore(std::filesystem::path folder, const Shape& shape, std::uint64_t fingerprint)
    : folder_(std::move(folder)), shape_(shape), fingerprint_(fingerprint) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) throw Error(folder_.string(), error.message(), "a folder that can be written");
}

std::filesystem::path TileStore::path(std::size_t tile, const char* ending) const {
  return folder_ / ("tile-" + std::to_string(tile) + ending);
}

bool TileStore::has(std::size_t tile) const {
  return load_part(path(tile, ".part"), shape_.columns, fingerprint_).has_value() &&
         load_check(path(tile, ".check"), shape_.lights, fingerprint_).has_value();
}

void TileStore::save(std::size_t tile, const TileTransport& transport,
                     const TileCheck& check) const {
  save_check(path(tile, ".check"), check, fingerprint_);
  save_part(path(tile, ".part"), transport, fingerprint_);
}

TileTransport TileStore::transport(std::size_t tile) const {
  auto part = load_part(path(tile, ".part"), shape_.columns, fingerprint_);
  if (!part) throw Error(path(tile, ".part").string(), "no finished tile", "the tile just baked");
  return std::move(*part);
}

TileCheck TileStore::check(std::size_t tile) const {
  auto check = load_check(path(tile, ".check"), shape_.lights, fingerprint_);
  if (!check) throw Error(path(tile, ".check").string(), "no check images", "those just baked");
  return std::move(*check);
}

void TileStore::save_sums(std::size_t next_tile, const SketchSums& sums) const {
  // Under its own name: those of fewer tiles count until these are whole.
  save_sketch_sums(path(next_tile, ".sums"), sums, fingerprint_);
  for (std::size_t older = 1; older < next_tile; ++older) remove_part(path(older, ".sums"));
}

std::size_t TileStore::load_sums(SketchSums& sums) const {
  for (std::size_t tile = shape_.tiles; tile > 0; --tile) {
    if (load_sketch_sums(path(tile, ".sums"), sums, fingerprint_)) return tile;
  }
  std::ranges::fill(sums.sums(), 0);
  return 0;
}

}  // namespace rimlight

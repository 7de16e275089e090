#include "core/transport/tile_transport.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/files.h"
#include "core/transport/tensor_file.h"

namespace rimlight {
namespace {

/// A part's sidecar is small: one hash for each MiB.
constexpr std::size_t kMostSidecarBytes = std::size_t{1} << 20;

std::filesystem::path with_ending(const std::filesystem::path& path, const char* ending) {
  std::filesystem::path result = path;
  result += ending;
  return result;
}

float largest_magnitude(std::span<const Half> values) {
  Half largest = 0;  // magnitudes of finite halves order as their bits do
  for (const Half value : values) largest = std::max<Half>(largest, value & 0x7fff);
  return to_float(largest);
}

template <typename T, typename Allocator>
void read_tensor(const TensorFile& file, const char* name, ElementType type,
                 std::vector<T, Allocator>& values) {
  const auto tensor = file.tensor<T>(name, type);
  values.assign(tensor.begin(), tensor.end());
}

}  // namespace

TileTransport prune(const TileTransport& tile, std::span<const float> weights, float threshold) {
  RIMLIGHT_CHECK_EQ(weights.size(), tile.column_count());
  RIMLIGHT_CHECK(threshold >= 0);
  TileTransport kept;
  kept.column_offset.reserve(tile.column_offset.size());
  kept.column_scale.reserve(tile.column_scale.size());
  kept.block_index.reserve(tile.block_index.size());
  kept.value.reserve(tile.value.size());
  kept.column_offset.push_back(0);
  for (std::size_t column = 0; column < tile.column_count(); ++column) {
    for (auto b = tile.column_offset[column]; b < tile.column_offset[column + 1]; ++b) {
      const auto values = std::span(tile.value).subspan(b * kBlockFloats, kBlockFloats);
      const float largest = largest_magnitude(values) * tile.column_scale[column];
      if (!(largest * weights[column] > threshold)) continue;
      kept.block_index.push_back(tile.block_index[b]);
      kept.value.insert(kept.value.end(), values.begin(), values.end());
    }
    const auto end = static_cast<std::uint32_t>(kept.block_index.size());
    kept.column_scale.push_back(end == kept.column_offset.back() ? 0 : tile.column_scale[column]);
    kept.column_offset.push_back(end);
  }
  return kept;
}

Transport::Transport(std::span<const TileTransport> tiles) {
  RIMLIGHT_CHECK(!tiles.empty());
  tile_first_block_.push_back(0);
  for (const TileTransport& tile : tiles) {
    RIMLIGHT_CHECK_EQ(tile.column_count(), tiles.front().column_count());
    const auto append = [](auto& to, const auto& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(column_offset_, tile.column_offset);
    append(column_scale_, tile.column_scale);
    append(block_index_, tile.block_index);
    append(value_, tile.value);
    tile_first_block_.push_back(block_index_.size());
  }
  view_ = TransportView({.tile_count = tiles.size(),
                         .column_count = tiles.front().column_count(),
                         .tile_first_block = tile_first_block_,
                         .column_offset = column_offset_,
                         .column_scale = column_scale_,
                         .block_index = block_index_,
                         .values = value_},
                        "transport in memory");
}

void save_part(const std::filesystem::path& path, const TileTransport& tile,
               std::uint64_t fingerprint) {
  const auto partial = with_ending(path, ".partial");
  const std::size_t columns = tile.column_count(), blocks = tile.block_count();
  TensorFileWriter writer(partial, {{"column_offset", ElementType::u32, {columns + 1}},
                                    {"column_scale", ElementType::f32, {columns}},
                                    {"block_index", ElementType::u16, {blocks}},
                                    {"value", ElementType::f16, {blocks, 3, kBlockReceivers}}});
  writer.append(std::span<const std::uint32_t>(tile.column_offset));
  writer.append(std::span<const float>(tile.column_scale));
  writer.append(std::span<const std::uint16_t>(tile.block_index));
  writer.append(std::span<const Half>(tile.value));
  nlohmann::json sidecar = {{"file", writer.finish().to_json()},
                            {"fingerprint", hash_text(fingerprint)}};
  std::error_code error;
  std::filesystem::rename(partial, path, error);
  if (error) throw Error(path.string(), error.message(), "a name that can be replaced");
  // Last: the part counts from here on, since only now do hashes and file agree.
  write_file_atomically(with_ending(path, ".json"), sidecar.dump());
}

std::optional<TileTransport> load_part(const std::filesystem::path& path, std::size_t column_count,
                                       std::uint64_t fingerprint) {
  try {
    const auto sidecar_path = with_ending(path, ".json");
    const std::string source = sidecar_path.string();
    const nlohmann::json json = parse_json(read_file(sidecar_path, kMostSidecarBytes), source);
    const JsonReader sidecar(json, source);
    if (read_hash(sidecar.member("fingerprint")) != fingerprint) return std::nullopt;
    const TensorFile file(path, TensorFileSummary::from_json(sidecar.member("file")));
    TileTransport tile;
    read_tensor(file, "column_offset", ElementType::u32, tile.column_offset);
    read_tensor(file, "column_scale", ElementType::f32, tile.column_scale);
    read_tensor(file, "block_index", ElementType::u16, tile.block_index);
    read_tensor(file, "value", ElementType::f16, tile.value);
    if (tile.column_count() != column_count) return std::nullopt;
    const Transport check({&tile, 1});  // offsets, indices and values as promised
    return tile;
  } catch (const Error&) {
    return std::nullopt;  // an expected outcome: the tile is made again
  }
}

}  // namespace rimlight

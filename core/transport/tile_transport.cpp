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

template <typename T>
void read_tensor(const TensorFile& file, const char* name, ElementType type,
                 std::vector<T>& values) {
  const auto tensor = file.tensor<T>(name, type);
  values.assign(tensor.begin(), tensor.end());
}

}  // namespace

TileTransport prune(const TileTransport& tile, float least_energy) {
  RIMLIGHT_CHECK(least_energy >= 0);
  TileTransport kept;
  kept.column_step = tile.column_step;
  kept.run_offset.reserve(tile.run_offset.size());
  kept.runs.reserve(tile.runs.size());
  kept.run_offset.push_back(0);
  RunBuilder builder(least_energy);
  for (std::size_t column = 0; column < tile.column_count(); ++column) {
    for (RunCursor at(tile.run(column)); !at.at_end(); at.next()) builder.add(at.block());
    builder.finish(kept.runs);
    kept.run_offset.push_back(static_cast<std::uint32_t>(kept.runs.size()));
  }
  return kept;
}

Transport::Transport(std::span<const TileTransport> tiles) {
  RIMLIGHT_CHECK(!tiles.empty());
  column_step_ = tiles.front().column_step;
  tile_first_word_.push_back(0);
  for (const TileTransport& tile : tiles) {
    RIMLIGHT_CHECK(tile.column_step == column_step_);
    run_offset_.insert(run_offset_.end(), tile.run_offset.begin(), tile.run_offset.end());
    runs_.insert(runs_.end(), tile.runs.begin(), tile.runs.end());
    tile_first_word_.push_back(runs_.size());
  }
  view_ = TransportView({.tile_count = tiles.size(),
                         .column_count = column_step_.size(),
                         .column_step = column_step_,
                         .tile_first_word = tile_first_word_,
                         .run_offset = run_offset_,
                         .runs = runs_},
                        "transport in memory");
}

void save_part(const std::filesystem::path& path, const TileTransport& tile,
               std::uint64_t fingerprint) {
  const auto partial = with_ending(path, ".partial");
  const std::size_t columns = tile.column_count();
  TensorFileWriter writer(partial, {{"column_step", ElementType::f32, {columns}},
                                    {"run_offset", ElementType::u32, {columns + 1}},
                                    {"runs", ElementType::u64, {tile.runs.size()}}});
  writer.append(std::span<const float>(tile.column_step));
  writer.append(std::span<const std::uint32_t>(tile.run_offset));
  writer.append(std::span<const std::uint64_t>(tile.runs));
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
    read_tensor(file, "column_step", ElementType::f32, tile.column_step);
    read_tensor(file, "run_offset", ElementType::u32, tile.run_offset);
    read_tensor(file, "runs", ElementType::u64, tile.runs);
    if (tile.column_count() != column_count) return std::nullopt;
    const Transport check({&tile, 1});  // steps, offsets and runs as promised
    return tile;
  } catch (const Error&) {
    return std::nullopt;  // an expected outcome: the tile is made again
  }
}

}  // namespace rimlight

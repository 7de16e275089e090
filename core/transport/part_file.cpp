#include "core/transport/part_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/base/json_reader.h"
#include "core/transport/tensor_file.h"
#include "core/transport/transport.h"

namespace rimlight {
namespace {

/// A part's sidecar is small: one hash for each MiB.
constexpr std::size_t kMostSidecarBytes = std::size_t{1} << 20;

std::filesystem::path with_ending(const std::filesystem::path& path, const char* ending) {
  std::filesystem::path result = path;
  result += ending;
  return result;
}

/// `write` appends the tensors' values.
template <typename Write>
void write_part(const std::filesystem::path& path, const std::vector<TensorShape>& tensors,
                std::uint64_t fingerprint, const Write& write) {
  const auto partial = with_ending(path, ".partial");
  TensorFileWriter writer(partial, tensors);
  write(writer);
  const nlohmann::json sidecar = {{"file", writer.finish().to_json()},
                                  {"fingerprint", hash_text(fingerprint)}};
  std::error_code error;
  std::filesystem::rename(partial, path, error);
  if (error) throw Error(path.string(), error.message(), "a name that can be replaced");
  // Last: the part counts from here on, since only now do hashes and file agree.
  write_file_atomically(with_ending(path, ".json"), sidecar.dump());
}

/// Throws Error when there is no such part.
TensorFile open_part(const std::filesystem::path& path, std::uint64_t fingerprint) {
  const auto sidecar_path = with_ending(path, ".json");
  const std::string source = sidecar_path.string();
  const nlohmann::json json = parse_json(read_file(sidecar_path, kMostSidecarBytes), source);
  const JsonReader sidecar(json, source);
  if (read_hash(sidecar.member("fingerprint")) != fingerprint) {
    throw Error(source, "another fingerprint", hash_text(fingerprint));
  }
  return {path, TensorFileSummary::from_json(sidecar.member("file"))};
}

template <typename T>
void read_tensor(const TensorFile& file, const char* name, ElementType type,
                 std::vector<T>& values) {
  const auto tensor = file.tensor<T>(name, type);
  values.assign(tensor.begin(), tensor.end());
}

}  // namespace

void save_part(const std::filesystem::path& path, const TileTransport& tile,
               std::uint64_t fingerprint) {
  const std::size_t columns = tile.column_count();
  write_part(path,
             {{"column_step", ElementType::f32, {columns}},
              {"run_offset", ElementType::u32, {columns + 1}},
              {"runs", ElementType::u64, {tile.runs.size()}}},
             fingerprint, [&tile](TensorFileWriter& writer) {
               writer.append(std::span<const float>(tile.column_step));
               writer.append(std::span<const std::uint32_t>(tile.run_offset));
               writer.append(std::span<const std::uint64_t>(tile.runs));
             });
}

std::optional<TileTransport> load_part(const std::filesystem::path& path, std::size_t column_count,
                                       std::uint64_t fingerprint) {
  try {
    const TensorFile file = open_part(path, fingerprint);
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

void save_sketch_sums(const std::filesystem::path& path, const SketchSums& sums,
                      std::uint64_t fingerprint) {
  write_part(path, {{"sums", ElementType::u64, {sums.sums().size()}}}, fingerprint,
             [&sums](TensorFileWriter& writer) { writer.append(sums.sums()); });
}

bool load_sketch_sums(const std::filesystem::path& path, SketchSums& sums,
                      std::uint64_t fingerprint) {
  try {
    const TensorFile file = open_part(path, fingerprint);
    const auto found = file.tensor<std::int64_t>("sums", ElementType::u64);
    if (found.size() != sums.sums().size()) return false;
    std::ranges::copy(found, sums.sums().begin());
    return true;
  } catch (const Error&) {
    return false;
  }
}

void remove_part(const std::filesystem::path& path) {
  std::error_code ignored;
  std::filesystem::remove(with_ending(path, ".json"), ignored);
  std::filesystem::remove(path, ignored);
}

}  // namespace rimlight

#include "core/bake/tile_check.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/transport/receivers.h"
#include "core/transport/tensor_file.h"

namespace rimlight {
namespace {

/// The file: fingerprint, number of lights, coverage, reflectance, images; then the hash of all
/// before it.
constexpr std::size_t kHeaderBytes = 16;

std::size_t file_bytes(std::size_t lights) {
  return kHeaderBytes + kTileReceivers * (sizeof(float) + (1 + lights) * sizeof(Vec3f)) + 8;
}

void append(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}

std::uint64_t hash_of(std::string_view bytes) {
  return hash_bytes(std::as_bytes(std::span(bytes.data(), bytes.size())));
}

}  // namespace

void save_check(const std::filesystem::path& path, const TileCheck& check,
                std::uint64_t fingerprint) {
  const std::uint64_t lights = check.images.size();
  std::string bytes;
  bytes.reserve(file_bytes(lights));
  append(bytes, &fingerprint, sizeof fingerprint);
  append(bytes, &lights, sizeof lights);
  append(bytes, check.coverage.data(), check.coverage.size() * sizeof(float));
  append(bytes, check.reflectance.data(), check.reflectance.size() * sizeof(Vec3f));
  for (const auto& image : check.images) append(bytes, image.data(), image.size() * sizeof(Vec3f));
  const std::uint64_t hash = hash_of(bytes);
  append(bytes, &hash, sizeof hash);
  write_file_atomically(path, bytes);
}

std::optional<TileCheck> load_check(const std::filesystem::path& path, std::size_t lights,
                                    std::uint64_t fingerprint) {
  std::string bytes;
  try {
    bytes = read_file(path, file_bytes(lights));
  } catch (const Error&) {
    return std::nullopt;  // missing or too large: it is made again
  }
  if (bytes.size() != file_bytes(lights)) return std::nullopt;
  std::uint64_t hash = 0;
  const std::size_t hashed = bytes.size() - sizeof hash;
  std::memcpy(&hash, bytes.data() + hashed, sizeof hash);
  if (hash != hash_of(std::string_view(bytes).substr(0, hashed))) return std::nullopt;
  std::uint64_t header[2];
  std::memcpy(header, bytes.data(), sizeof header);
  if (header[0] != fingerprint || header[1] != lights) return std::nullopt;

  TileCheck check;
  const char* from = bytes.data() + kHeaderBytes;
  const auto take = [&from](auto& values) {
    values.resize(kTileReceivers);
    const std::size_t size = kTileReceivers * sizeof(values[0]);
    std::memcpy(static_cast<void*>(values.data()), from, size);
    from += size;
  };
  take(check.coverage);
  take(check.reflectance);
  check.images.resize(lights);
  for (auto& image : check.images) take(image);
  return check;
}

}  // namespace rimlight

#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/base/json_reader.h"

namespace rimlight {

enum class ElementType { u8, u16, u32, u64, f16, f32, f64 };
std::size_t element_size(ElementType type);
/// As safetensors names it: "U8" … "F64".
const std::string& type_name(ElementType type);

/// One named tensor to write. `write` streams may produce the bytes in pieces.
struct TensorShape {
  std::string name;
  ElementType type = ElementType::f32;
  std::vector<std::size_t> shape;
};

/// Blocks of 1 MiB of a file, each with an xxHash64 seeded by its index: a swapped block is found
/// too.
inline constexpr std::size_t kHashedBlock = std::size_t{1} << 20;

/// A header larger than this is refused, written or read.
inline constexpr std::size_t kMostHeaderBytes = std::size_t{16} << 20;

/// What tells a whole and unchanged file: kept outside it (in a manifest, or beside it).
struct TensorFileSummary {
  std::uint64_t bytes = 0;
  std::vector<std::uint64_t> block_hashes;  // of kHashedBlock bytes, the last of what remains

  /// {"bytes": …, "xxh64": ["16 hex digits", …]}: hashes as text, since JSON readers elsewhere lose
  /// digits of large numbers.
  nlohmann::json to_json() const;
  /// Throws Error at the field that is wrong.
  static TensorFileSummary from_json(const JsonReader& json);
};

/// 16 hexadecimal digits, as xxh64sum prints them, and back (throws Error at the field).
std::string hash_text(std::uint64_t hash);
std::uint64_t read_hash(const JsonReader& json);
/// xxHash64 of bytes.
std::uint64_t hash_bytes(std::span<const std::byte> bytes, std::uint64_t seed = 0);

/// Writes the safetensors layout: u64 header length, JSON header (padded with spaces so that data
/// starts on 64 bytes), raw little-endian arrays without holes. Every tensor starts on 64 bytes:
/// where one ends between, a u8 tensor "padding.N" of zeros follows it (the format has no holes).
/// Shapes first, then data in that order, streamed: append() any number of times, never past the
/// end of a tensor (CheckFailure); a tensor ends when it is full. finish() checks that all is
/// there, flushes to the disk and returns the summary. Without finish() the file is not whole and
/// opens nowhere. Throws Error when the disk refuses. One thread at a time.
class TensorFileWriter {
 public:
  using Summary = TensorFileSummary;

  TensorFileWriter(const std::filesystem::path& path, const std::vector<TensorShape>& tensors);
  ~TensorFileWriter();
  TensorFileWriter(const TensorFileWriter&) = delete;
  TensorFileWriter& operator=(const TensorFileWriter&) = delete;

  void append(std::span<const std::byte> bytes);
  template <typename T>
  void append(std::span<const T> values) {
    append(std::as_bytes(values));
  }
  Summary finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A memory-mapped safetensors file whose blocks are checked against `expected` when first touched
/// by tensor(), or all again by verify(). Opening checks the file's length, the header's blocks and
/// everything that the header says: length, JSON, keys, types, shapes, bounds, overlaps and holes,
/// alignment. "__metadata__" is allowed and ignored. Throws Error naming file, and tensor or block.
/// Any thread.
class TensorFile {
 public:
  TensorFile(const std::filesystem::path& path, TensorFileSummary expected);
  ~TensorFile();
  TensorFile(TensorFile&&) noexcept;

  std::uint64_t byte_count() const;
  bool has(const std::string& name) const;
  std::vector<std::string> names() const;
  const std::vector<std::size_t>& shape(const std::string& name) const;
  /// The tensor's values; its blocks have been hashed and found right (in parallel, once). They
  /// live as long as this file, moved or not. Throws Error when it is missing or of another type.
  template <typename T>
  std::span<const T> tensor(const std::string& name, ElementType type) const {
    const std::span<const std::byte> bytes = checked_bytes(name, type);
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  /// Hashes every block afresh; throws Error at the first that is wrong.
  void verify() const;

 private:
  std::span<const std::byte> checked_bytes(const std::string& name, ElementType type) const;
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rimlight

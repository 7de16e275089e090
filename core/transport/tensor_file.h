#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rimlight {

enum class ElementType { u8, u16, u32, u64, f16, f32, f64 };
std::size_t element_size(ElementType type);

/// One named tensor to write. `write` streams may produce the bytes in pieces.
struct TensorShape {
  std::string name;
  ElementType type = ElementType::f32;
  std::vector<std::size_t> shape;
};

/// Blocks of 1 MiB of a file, each with an xxHash64 seeded by its index: a swapped block is found
/// too.
inline constexpr std::size_t kHashedBlock = std::size_t{1} << 20;

/// Writes the safetensors layout: u64 header length, JSON header (padded with spaces so that data
/// starts on 64 bytes; every tensor starts on 64 bytes), raw little-endian arrays. Shapes first,
/// then data in that order, streamed: append() any number of times; a tensor ends when it is full.
/// finish() checks that all is there, flushes to the disk and returns the block hashes.
class TensorFileWriter {
 public:
  TensorFileWriter(const std::filesystem::path& path, std::vector<TensorShape> tensors);
  ~TensorFileWriter();
  TensorFileWriter(const TensorFileWriter&) = delete;
  TensorFileWriter& operator=(const TensorFileWriter&) = delete;

  void append(std::span<const std::byte> bytes);
  template <typename T>
  void append(std::span<const T> values) {
    append(std::as_bytes(values));
  }
  struct Summary {
    std::uint64_t bytes = 0;
    std::vector<std::uint64_t> block_hashes;
  };
  Summary finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A memory-mapped safetensors file whose blocks are checked against `expected` when first touched
/// by tensor(), or all at once by verify(). Everything of the header is checked on opening: sizes,
/// overlap, bounds, types, alignment. Throws Error naming file, and tensor or block. Any thread.
class TensorFile {
 public:
  TensorFile(const std::filesystem::path& path, std::uint64_t expected_bytes,
             std::vector<std::uint64_t> expected_hashes);
  ~TensorFile();
  TensorFile(TensorFile&&) noexcept;

  bool has(const std::string& name) const;
  std::vector<std::string> names() const;
  const std::vector<std::size_t>& shape(const std::string& name) const;
  /// The tensor's values; its blocks have been hashed and found right (in parallel, once).
  /// Throws Error when it is missing or of another type.
  template <typename T>
  std::span<const T> tensor(const std::string& name, ElementType type) const {
    const std::span<const std::byte> bytes = checked_bytes(name, type);
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  void verify() const;

 private:
  std::span<const std::byte> checked_bytes(const std::string& name, ElementType type) const;
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rimlight

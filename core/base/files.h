#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace rimlight {

/// A read-only memory map of a whole file. Movable; unmapped on destruction.
/// A file that another process truncates while mapped raises SIGBUS on access: bakes are never
/// changed in place, only renamed as a whole.
class MappedFile {
 public:
  /// Throws Error when the file cannot be opened, is not a regular file, or is larger than `most`.
  explicit MappedFile(const std::filesystem::path& path, std::size_t most = SIZE_MAX);
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();

  std::span<const std::byte> bytes() const noexcept { return {data_, size_}; }

 private:
  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

/// The whole file as bytes; throws Error when it cannot be read or is larger than `most` bytes.
std::string read_file(const std::filesystem::path& path, std::size_t most);

/// Writes beside the target, flushes to the disk, then renames: the file exists whole or not at
/// all, and a failure leaves nothing beside it. Throws Error.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Flushes a file or a folder to the disk; throws Error.
void flush_to_disk(const std::filesystem::path& path);

}  // namespace rimlight

#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/base/files.h"

namespace rimlight {

/// Values larger than this are refused: sums of them must stay finite in floats.
inline constexpr double kLargestTransport = 1e20;

/// An array as numpy.save writes it, in memory: format 1.0 to 3.0, little-endian floats of 2, 4 or
/// 8 bytes ('<f2', '<f4', '<f8'), C order (the last index runs fastest). The bytes must outlive it.
///
/// Everything that the header says is checked before it is used: magic, version, length, the three
/// fields 'descr', 'fortran_order' and 'shape' (each once, no other), and that the array's size is
/// what is left of the file, to the byte. Throws Error naming the file and the field. Immutable;
/// any thread.
class NpyArray {
 public:
  static constexpr std::size_t kMostDimensions = 8;

  /// `name` stands in errors.
  NpyArray(std::span<const std::byte> bytes, std::string name);

  const std::string& name() const { return name_; }
  const std::vector<std::size_t>& shape() const { return shape_; }
  /// "2 × 3", for errors.
  std::string shape_text() const;
  /// Numbers in all.
  std::size_t count() const { return data_.size() / element_size_; }

  /// Values first … first + values.size() − 1 in C order, as floats. Throws Error with the place of
  /// the first that is not finite or beyond kLargestTransport.
  void read(std::size_t first, std::span<float> values) const;

 private:
  [[noreturn]] void fail_value(std::size_t index, double value) const;

  std::string name_;
  std::vector<std::size_t> shape_;
  std::size_t element_size_ = 0;
  std::span<const std::byte> data_;
};

/// A memory-mapped .npy file.
class NpyFile {
 public:
  /// Throws Error.
  explicit NpyFile(const std::filesystem::path& path)
      : file_(path), array_(file_.bytes(), path.string()) {}

  const NpyArray& array() const { return array_; }

 private:
  MappedFile file_;
  NpyArray array_;
};

}  // namespace rimlight

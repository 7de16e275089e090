#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace rimlight {

/// One float tensor of an RGL tensor file, row-major, all finite.
struct RglTensor {
  std::vector<std::size_t> shape;
  std::vector<float> values;
};

/// The tensor files of the RGL material database (Dupuy and Jakob 2018), version 1.0,
/// little-endian: "tensor_file\0", two bytes of version (1, 0), the number of fields (u32), then
/// for each field its name's length (u16), name, number of dimensions (u16), type (u8), the data's
/// offset in the file (u64) and the shape (u64 each). The bytes must outlive this; nothing is
/// copied until asked for.
class RglTensorFile {
 public:
  /// Throws Error at whatever does not fit: every length and offset is checked against the bytes.
  RglTensorFile(std::span<const std::byte> bytes, std::string source);

  /// The float field of this name; Error when there is none, or its dimensions are not `dimensions`
  /// or a number is not finite.
  RglTensor tensor(const std::string& name, std::size_t dimensions) const;
  bool has(const std::string& name) const;
  const std::string& source() const { return source_; }

 private:
  struct Field {
    std::string name;
    unsigned type = 0;
    std::size_t offset = 0, bytes = 0;
    std::vector<std::size_t> shape;
  };
  const Field* find(const std::string& name) const;
  Field read_field(std::size_t& at) const;

  std::span<const std::byte> bytes_;
  std::string source_;
  std::vector<Field> fields_;
};

}  // namespace rimlight

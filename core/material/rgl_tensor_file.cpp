#include "core/material/rgl_tensor_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "core/base/checked.h"
#include "core/base/error.h"

namespace rimlight {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kMagic{"tensor_file\0", 12};
constexpr std::size_t kMostFields = 64, kMostDimensions = 8, kLongestName = 256;
/// Bytes of an element by type: u8, i8, u16, i16, u32, i32, u64, i64, f16, f32, f64 from 1 on.
constexpr std::size_t kElementBytes[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};
constexpr unsigned kFloat = 10;

/// Reads numbers from the front; Error at the end.
class FieldReader {
 public:
  FieldReader(std::span<const std::byte> bytes, std::size_t& at, const std::string& source)
      : bytes_(bytes), at_(at), source_(source) {}

  std::span<const std::byte> take(std::size_t count) {
    if (count > bytes_.size() - at_) {
      throw Error(source_ + ": byte " + std::to_string(at_), "the end of the file",
                  std::to_string(count) + " more bytes of its header");
    }
    const auto taken = bytes_.subspan(at_, count);
    at_ += count;
    return taken;
  }
  template <typename T>
  std::size_t number() {
    T value = 0;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return static_cast<std::size_t>(value);
  }
  std::string text(std::size_t length) {
    const auto bytes = take(length);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t& at_;
  const std::string& source_;
};

}  // namespace

RglTensorFile::RglTensorFile(std::span<const std::byte> bytes, std::string source)
    : bytes_(bytes), source_(std::move(source)) {
  std::size_t at = 0;
  FieldReader reader(bytes_, at, source_);
  if (reader.text(std::min(kMagic.size(), bytes_.size())) != kMagic) {
    throw Error(source_, "other first bytes", "\"tensor_file\"");
  }
  const std::size_t major = reader.number<std::uint8_t>(), minor = reader.number<std::uint8_t>();
  if (major != 1 || minor != 0) {
    throw Error(source_, "version " + std::to_string(major) + "." + std::to_string(minor),
                "version 1.0");
  }
  const std::size_t count = reader.number<std::uint32_t>();
  if (count > kMostFields) throw Error(source_, std::to_string(count) + " fields", "at most 64");
  for (std::size_t i = 0; i < count; ++i) fields_.push_back(read_field(at));
}

RglTensorFile::Field RglTensorFile::read_field(std::size_t& at) const {
  FieldReader reader(bytes_, at, source_);
  Field field;
  const std::size_t length = reader.number<std::uint16_t>();
  if (length > kLongestName) {
    throw Error(source_, "a field's name of " + std::to_string(length) + " bytes", "at most 256");
  }
  field.name = reader.text(length);
  const std::string where = source_ + ": field " + quote(field.name);
  const std::size_t dimensions = reader.number<std::uint16_t>();
  if (dimensions > kMostDimensions) {
    throw Error(where, std::to_string(dimensions) + " dimensions", "at most 8");
  }
  field.type = static_cast<unsigned>(reader.number<std::uint8_t>());
  if (field.type == 0 || field.type >= std::size(kElementBytes)) {
    throw Error(where, "type " + std::to_string(field.type), "1 to 11");
  }
  field.offset = reader.number<std::uint64_t>();
  std::optional<std::size_t> size = kElementBytes[field.type];
  for (std::size_t i = 0; i < dimensions; ++i) {
    field.shape.push_back(reader.number<std::uint64_t>());
    if (size) size = checked_product(*size, field.shape.back());
  }
  const auto end = size ? checked_sum(*size, field.offset) : std::nullopt;
  if (!end || *end > bytes_.size()) {
    throw Error(where, "data beyond the end", "data within the file's bytes");
  }
  field.bytes = *size;
  return field;
}

const RglTensorFile::Field* RglTensorFile::find(const std::string& name) const {
  for (const Field& field : fields_) {
    if (field.name == name) return &field;
  }
  return nullptr;
}

bool RglTensorFile::has(const std::string& name) const { return find(name) != nullptr; }

RglTensor RglTensorFile::tensor(const std::string& name, std::size_t dimensions) const {
  const Field* const field = find(name);
  const std::string where = source_ + ": field " + quote(name);
  if (field == nullptr) throw Error(where, "no such field", "one");
  if (field->type != kFloat || field->shape.size() != dimensions) {
    throw Error(where,
                "type " + std::to_string(field->type) + " with " +
                    std::to_string(field->shape.size()) + " dimensions",
                "32-bit floats (type 10) with " + std::to_string(dimensions));
  }
  RglTensor tensor{field->shape, std::vector<float>(field->bytes / sizeof(float))};
  if (field->bytes > 0) {
    std::memcpy(tensor.values.data(), bytes_.data() + field->offset, field->bytes);
  }
  for (std::size_t i = 0; i < tensor.values.size(); ++i) {
    if (std::isfinite(tensor.values[i])) continue;
    throw Error(where + ", number " + std::to_string(i), std::to_string(tensor.values[i]),
                "a finite number");
  }
  return tensor;
}

}  // namespace rimlight

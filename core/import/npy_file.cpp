#include "core/import/npy_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/check.h"
#include "core/base/checked.h"
#include "core/base/error.h"
#include "core/base/half.h"
#include "core/import/npy_header.h"

namespace rimlight {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kMostHeaderBytes = std::size_t{1} << 16;

template <typename T>
T load(const std::byte* from) {
  T value;  // arrays may start at any byte
  std::memcpy(&value, from, sizeof value);
  return value;
}

/// The header's text, and the bytes behind it.
std::pair<std::string_view, std::span<const std::byte>> split(std::span<const std::byte> bytes,
                                                              const std::string& name) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!text.starts_with(kMagic) || text.size() < 8) {
    throw Error(name, "another format", "an array that numpy.save wrote (.npy)");
  }
  const auto major = static_cast<unsigned char>(text[6]);
  const auto minor = static_cast<unsigned char>(text[7]);
  if (major < 1 || major > 3 || minor != 0) {
    throw Error(name + ": version", std::to_string(major) + "." + std::to_string(minor),
                "1.0, 2.0 or 3.0");
  }
  const std::size_t length_bytes = major == 1 ? 2 : 4;
  if (bytes.size() < 8 + length_bytes) throw Error(name, "a truncated header", "a whole header");
  const std::size_t length =
      major == 1 ? load<std::uint16_t>(bytes.data() + 8) : load<std::uint32_t>(bytes.data() + 8);
  const std::size_t begin = 8 + length_bytes;
  if (length > kMostHeaderBytes || length > bytes.size() - begin) {
    throw Error(name + ": header length", std::to_string(length),
                "at most " + std::to_string(std::min(kMostHeaderBytes, bytes.size() - begin)));
  }
  return {text.substr(begin, length), bytes.subspan(begin + length)};
}

std::size_t size_of(const std::string& descr, const std::string& name) {
  if (descr == "<f2") return 2;
  if (descr == "<f4") return 4;
  if (descr == "<f8") return 8;
  throw Error(name + ": \"descr\"", quote(descr),
              "\"<f2\", \"<f4\" or \"<f8\" (little-endian floats)");
}

}  // namespace

NpyArray::NpyArray(std::span<const std::byte> bytes, std::string name) : name_(std::move(name)) {
  const auto [text, data] = split(bytes, name_);
  NpyHeader header = parse_npy_header(text, name_);
  element_size_ = size_of(header.descr, name_);
  if (header.fortran_order) {
    throw Error(name_ + ": \"fortran_order\"", "True",
                "False: save numpy.ascontiguousarray(array)");
  }
  shape_ = std::move(header.shape);
  std::optional<std::size_t> size = element_size_;
  for (const std::size_t side : shape_) {
    if (size) size = checked_product(*size, side);
  }
  if (!size || *size != data.size()) {
    throw Error(name_ + ": \"shape\"",
                shape_text() + " of " + std::to_string(element_size_) + " bytes in " +
                    std::to_string(data.size()),
                "a size that is the rest of the file");
  }
  data_ = data;
}

std::string NpyArray::shape_text() const {
  std::string text;
  for (const std::size_t side : shape_) text += (text.empty() ? "" : " × ") + std::to_string(side);
  return text.empty() ? "one number" : text;
}

void NpyArray::read(std::size_t first, std::span<float> values) const {
  RIMLIGHT_CHECK(first <= count() && values.size() <= count() - first);
  const std::byte* from = data_.data() + first * element_size_;
  for (std::size_t i = 0; i < values.size(); ++i, from += element_size_) {
    const double value = element_size_ == 2   ? static_cast<double>(to_float(load<Half>(from)))
                         : element_size_ == 4 ? static_cast<double>(load<float>(from))
                                              : load<double>(from);
    if (!(std::abs(value) <= kLargestTransport)) fail_value(first + i, value);
    values[i] = static_cast<float>(value);
  }
}

void NpyArray::fail_value(std::size_t index, double value) const {
  std::string place;  // [row][column]…, last index first
  for (std::size_t i = shape_.size(); i-- > 0; index /= shape_[i]) {
    place.insert(0, "[" + std::to_string(index % shape_[i]) + "]");
  }
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  throw Error(name_ + ": " + place, text, "a finite number of at most 1e20");
}

}  // namespace rimlight

#include "core/scene/ply_check.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/scene/mesh_file.h"

namespace rimlight {
namespace {

constexpr std::size_t kLongestHeader = 64 << 10;

enum class Encoding { ascii, little_endian, big_endian };

struct Property {
  std::size_t value_size = 0;
  std::size_t count_size = 0;  // of a list; 0: a single value
  bool count_is_real = false;
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::string_view data;
};

struct Type {
  std::size_t size;
  bool is_real;
};

std::optional<Type> type_named(std::string_view name) {
  constexpr std::pair<std::string_view, Type> kTypes[] = {
      {"char", {1, false}},  {"uchar", {1, false}},  {"int8", {1, false}},  {"uint8", {1, false}},
      {"short", {2, false}}, {"ushort", {2, false}}, {"int16", {2, false}}, {"uint16", {2, false}},
      {"int", {4, false}},   {"uint", {4, false}},   {"int32", {4, false}}, {"uint32", {4, false}},
      {"float", {4, true}},  {"float32", {4, true}}, {"double", {8, true}}, {"float64", {8, true}}};
  for (const auto& [known, type] : kTypes) {
    if (known == name) return type;
  }
  return std::nullopt;
}

template <typename Number>
std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

class HeaderReader {
 public:
  HeaderReader(std::string file, std::string_view bytes) : file_(std::move(file)), bytes_(bytes) {}

  Header read() {
    if (next_line() != "ply") fail("\"ply\"");
    Header header;
    while (next_line() != "end_header") read_line(header);
    header.data = bytes_.substr(position_);
    return header;
  }

 private:
  [[noreturn]] void fail(const std::string& expected) const {
    throw Error(file_ + ": line " + std::to_string(line_number_), quote(line_), expected);
  }

  std::string_view next_line() {
    const std::string_view searched = bytes_.substr(0, std::min(bytes_.size(), kLongestHeader));
    const std::size_t end = searched.find_first_of("\r\n", position_);
    if (end == std::string_view::npos) {
      throw Error(file_,
                  "no end of the PLY header in " + std::to_string(searched.size()) + " bytes",
                  "\"end_header\"");
    }
    line_ = bytes_.substr(position_, end - position_);
    position_ = end + (bytes_.substr(end, 2) == "\r\n" ? 2 : 1);
    ++line_number_;
    return line_;
  }

  void read_line(Header& header) {
    std::istringstream words{std::string(line_)};
    std::string keyword, first, second, third;
    words >> keyword >> first >> second >> third;
    if (keyword == "format") {
      if (first == "ascii") {
        header.encoding = Encoding::ascii;
      } else if (first == "binary_little_endian") {
        header.encoding = Encoding::little_endian;
      } else if (first == "binary_big_endian") {
        header.encoding = Encoding::big_endian;
      } else {
        fail("ascii, binary_little_endian or binary_big_endian");
      }
    } else if (keyword == "element") {
      const auto count = parse_number<std::uint64_t>(second);
      if (!count) fail("an element's name and count");
      header.elements.push_back({first, *count, {}});
    } else if (keyword == "property") {
      if (header.elements.empty()) fail("a property after its element");
      const bool list = first == "list";
      const auto value = type_named(list ? third : first);
      const auto count = list ? type_named(second) : Type{};
      if (!value || !count) fail("a property of a PLY type");
      header.elements.back().properties.push_back({value->size, count->size, count->is_real});
    }  // comments and whatever else: as assimp, no business of ours
  }

  std::string file_;
  std::string_view bytes_;
  std::size_t position_ = 0;
  std::string_view line_;
  std::size_t line_number_ = 0;
};

/// Walks the data without keeping any of it; each step says whether it was there.
class DataWalker {
 public:
  DataWalker(std::string_view data, Encoding encoding) : data_(data), encoding_(encoding) {}

  bool skip(const Property& property) {
    if (property.count_size == 0) return skip_values(1, property.value_size);
    const auto count =
        encoding_ == Encoding::ascii ? parse_number<std::uint64_t>(word()) : binary_count(property);
    return count && skip_values(*count, property.value_size);
  }

 private:
  std::string_view word() {
    constexpr std::string_view kSpace = " \t\r\n\v\f";
    const std::size_t begin = data_.find_first_not_of(kSpace);
    if (begin == std::string_view::npos) return data_ = {};
    const std::size_t end = std::min(data_.find_first_of(kSpace, begin), data_.size());
    const std::string_view result = data_.substr(begin, end - begin);
    data_.remove_prefix(end);
    return result;
  }

  bool skip_values(std::uint64_t count, std::size_t size) {
    if (count > data_.size() / (encoding_ == Encoding::ascii ? 1 : size)) return false;
    if (encoding_ == Encoding::ascii) {
      for (std::uint64_t i = 0; i < count; ++i) {
        if (word().empty()) return false;
      }
    } else {
      data_.remove_prefix(count * size);
    }
    return true;
  }

  /// Unsigned: a negative count is too large for any file.
  std::optional<std::uint64_t> binary_count(const Property& property) {
    if (property.count_is_real || data_.size() < property.count_size) return std::nullopt;
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < property.count_size; ++i) {
      const std::size_t at = encoding_ == Encoding::big_endian ? i : property.count_size - 1 - i;
      count = count << 8 | static_cast<unsigned char>(data_[at]);
    }
    data_.remove_prefix(property.count_size);
    return count;
  }

  std::string_view data_;
  Encoding encoding_;
};

}  // namespace

void check_ply(const std::filesystem::path& path) {
  const MappedFile file(path, kLargestMeshFile);
  const std::string_view bytes(reinterpret_cast<const char*>(file.bytes().data()),
                               file.bytes().size());
  const Header header = HeaderReader(path.string(), bytes).read();
  DataWalker data(header.data, header.encoding);
  for (const Element& element : header.elements) {
    // Without properties it would take no bytes, however many there are.
    if (element.properties.empty() && element.count > 0) {
      throw Error(path.string() + ": element " + quote(element.name), "no properties", "some");
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (const Property& property : element.properties) {
        if (data.skip(property)) continue;
        throw Error(path.string(),
                    "the end of the file in element " + quote(element.name) + " number " +
                        std::to_string(i),
                    std::to_string(element.count) + " of them, as its header claims");
      }
    }
  }
}

}  // namespace rimlight

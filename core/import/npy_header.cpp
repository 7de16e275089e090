#include "core/import/npy_header.h"

#include <charconv>

#include "core/base/error.h"
#include "core/import/npy_file.h"

namespace rimlight {
namespace {

/// Walks the literal; what it meets is never more than compared and copied.
class HeaderParser {
 public:
  HeaderParser(std::string_view text, const std::string& name) : rest_(text), name_(name) {}

  NpyHeader parse() {
    expect('{', "header");
    bool has_descr = false, has_order = false, has_shape = false;
    while (!take('}')) {
      const std::string key = quoted("header");
      expect(':', key);
      bool& has = key == "descr"           ? has_descr
                  : key == "fortran_order" ? has_order
                  : key == "shape"         ? has_shape
                                           : unknown(key);
      if (has) fail("header", "the field " + quote(key) + " twice", "each field once");
      has = true;
      read_value(key);
      if (!take(',') && !at('}')) fail_here(key, "',' or '}'");
    }
    if (skip_space(); !rest_.empty()) fail_here("header", "nothing after '}'");
    if (!has_descr) missing("descr");
    if (!has_order) missing("fortran_order");
    if (!has_shape) missing("shape");
    return header_;
  }

 private:
  void read_value(const std::string& key) {
    if (key == "descr") {
      if (!at('\'') && !at('"')) fail_here(key, "'<f2', '<f4' or '<f8'");
      header_.descr = quoted(key);
    } else if (key == "fortran_order") {
      header_.fortran_order = boolean(key);
    } else {
      header_.shape = tuple(key);
    }
  }

  bool boolean(const std::string& key) {
    skip_space();
    for (const bool value : {false, true}) {
      const std::string_view word = value ? "True" : "False";
      if (!rest_.starts_with(word)) continue;
      rest_.remove_prefix(word.size());
      return value;
    }
    fail_here(key, "True or False");
  }

  std::vector<std::size_t> tuple(const std::string& key) {
    expect('(', key);
    std::vector<std::size_t> numbers;
    while (!take(')')) {
      if (numbers.size() == NpyArray::kMostDimensions) {
        fail(key, "more numbers", "at most " + std::to_string(NpyArray::kMostDimensions));
      }
      numbers.push_back(number(key));
      if (!take(',') && !at(')')) fail_here(key, "',' or ')'");
    }
    return numbers;
  }

  std::size_t number(const std::string& key) {
    skip_space();
    std::size_t value = 0;
    const char* const begin = rest_.data();
    const auto [end, error] = std::from_chars(begin, begin + rest_.size(), value);
    if (error != std::errc()) fail_here(key, "a whole number below 2^64");
    rest_.remove_prefix(static_cast<std::size_t>(end - begin));
    if (rest_.starts_with('L')) rest_.remove_prefix(1);  // as Python 2 wrote it
    return value;
  }

  /// A string without escapes: field names and types have none.
  std::string quoted(const std::string& field) {
    skip_space();
    if (!rest_.starts_with('\'') && !rest_.starts_with('"')) fail_here(field, "a quoted word");
    const std::size_t end = rest_.find(rest_.front(), 1);
    if (end == std::string_view::npos) fail_here(field, "a closing quote");
    std::string word(rest_.substr(1, end - 1));
    rest_.remove_prefix(end + 1);
    return word;
  }

  void skip_space() {
    const std::size_t count = rest_.find_first_not_of(" \t\r\n");
    rest_.remove_prefix(count == std::string_view::npos ? rest_.size() : count);
  }
  bool at(char c) {
    skip_space();
    return rest_.starts_with(c);
  }
  bool take(char c) {
    if (!at(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void expect(char c, const std::string& field) {
    if (!take(c)) fail_here(field, "'" + std::string(1, c) + "'");
  }

  [[noreturn]] void fail(const std::string& field, const std::string& found,
                         const std::string& expected) const {
    throw Error(name_ + ": " + (field == "header" ? field : quote(field)), found, expected);
  }
  [[noreturn]] void fail_here(const std::string& field, const std::string& expected) const {
    fail(field, rest_.empty() ? "the end of the header" : quote(rest_.substr(0, 20)), expected);
  }
  [[noreturn]] void missing(const char* field) const {
    fail("header", "no " + quote(field), "\"descr\", \"fortran_order\" and \"shape\"");
  }
  [[noreturn]] bool& unknown(const std::string& key) const {
    fail("header", "the unknown field " + quote(key), "\"descr\", \"fortran_order\" and \"shape\"");
  }

  std::string_view rest_;
  const std::string& name_;
  NpyHeader header_;
};

}  // namespace

NpyHeader parse_npy_header(std::string_view text, const std::string& name) {
  return HeaderParser(text, name).parse();
}

}  // namespace rimlight

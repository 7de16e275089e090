#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.h"

namespace rimlight {

/// Parses JSON text, comments allowed. `source` names it in errors: a file, or "message".
/// Throws Error with line and column when the text is malformed or a key is given twice.
nlohmann::json parse_json(std::string_view text, const std::string& source);

/// One value of a JSON document that knows its pointer, so that each error says where it is:
/// "scene.json: /objects/2/material: found "brass", expected …". The document must outlive it.
/// Every accessor throws Error when the value is not what it asks for. Any thread.
class JsonReader {
 public:
  JsonReader(const nlohmann::json& value, std::string source, std::string pointer = "");

  const nlohmann::json& value() const { return *value_; }
  const std::string& source() const { return source_; }
  const std::string& pointer() const { return pointer_; }
  bool is_string() const { return value_->is_string(); }
  bool is_array() const { return value_->is_array(); }

  /// Members of an object.
  bool has(std::string_view name) const;
  JsonReader member(std::string_view name) const;
  std::optional<JsonReader> optional_member(std::string_view name) const;
  /// All members in the document's (sorted) order, with their names.
  std::vector<std::pair<std::string, JsonReader>> members() const;
  /// Fails on the first member that is not in `known`: a misspelt field is never ignored.
  void allow_only(std::initializer_list<std::string_view> known) const;
  void allow_only(const std::vector<std::string_view>& known) const;

  /// Elements of an array with `least` to `most` elements.
  std::vector<JsonReader> elements(std::size_t least = 0, std::size_t most = SIZE_MAX) const;

  bool boolean() const;
  std::string string() const;
  /// A finite number in [low, high].
  double number(double low = -1e300, double high = 1e300) const;
  /// A whole number in [low, high].
  std::int64_t integer(std::int64_t low, std::int64_t high) const;
  /// Exactly `count` finite numbers, each in [low, high].
  std::vector<double> numbers(std::size_t count, double low = -1e300, double high = 1e300) const;
  /// The position of this string in `names`; the error lists them.
  std::size_t one_of(const std::vector<std::string>& names) const;

  /// "file: /pointer" as it stands in errors.
  std::string where() const;
  /// Throws Error here, with the value found shortened.
  [[noreturn]] void fail(const std::string& expected) const;

 private:
  const nlohmann::json* value_;
  std::string source_;
  std::string pointer_;
};

}  // namespace rimlight

#include "core/base/json_reader.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace rimlight {
namespace {

using nlohmann::json;

/// "line 3, column 7" of a byte offset.
std::string line_and_column(std::string_view text, std::size_t byte) {
  byte = std::min(byte, text.size());
  const std::string_view before = text.substr(0, byte);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t line_start = before.rfind('\n');
  const std::size_t column = line_start == std::string_view::npos ? byte : byte - line_start - 1;
  return "line " + std::to_string(line) + ", column " +
         std::to_string(std::max<std::size_t>(column, 1));
}

/// ~ and / are escaped in JSON pointers (RFC 6901).
std::string escaped(std::string_view name) {
  std::string result;
  for (const char c : name) {
    if (c == '~') {
      result += "~0";
    } else if (c == '/') {
      result += "~1";
    } else {
      result += c;
    }
  }
  return result;
}

/// The number when it is whole and fits, however it is written (2, 2.0, 2e0); exact: 2⁵³ + 1 is not
/// rounded.
std::optional<std::int64_t> whole_number(const json& value) {
  if (value.is_number_unsigned()) {
    const auto number = value.get<std::uint64_t>();
    if (number > static_cast<std::uint64_t>(INT64_MAX)) return std::nullopt;
    return static_cast<std::int64_t>(number);
  }
  if (value.is_number_integer()) return value.get<std::int64_t>();
  if (!value.is_number_float()) return std::nullopt;
  const auto number = value.get<double>();
  if (!(number >= -0x1p63 && number < 0x1p63) || number != std::floor(number)) return std::nullopt;
  return static_cast<std::int64_t>(number);
}

}  // namespace

json parse_json(std::string_view text, const std::string& source) {
  // A later duplicate would silently win: refused while parsing, level by level.
  std::vector<std::set<std::string>> keys;
  const json::parser_callback_t refuse_duplicates = [&](int, json::parse_event_t event,
                                                        json& parsed) {
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    if (event == json::parse_event_t::object_end) keys.pop_back();
    if (event == json::parse_event_t::key &&
        !keys.back().insert(parsed.get<std::string>()).second) {
      throw Error(source, "the key " + quote(parsed.get<std::string>()) + " twice",
                  "each key once in an object");
    }
    return true;
  };
  try {
    return json::parse(text, refuse_duplicates, /*allow_exceptions=*/true,
                       /*ignore_comments=*/true);
  } catch (const json::parse_error& error) {
    throw Error(source + ": " + line_and_column(text, error.byte), "malformed JSON", "valid JSON");
  } catch (const json::exception& error) {
    throw Error(source, error.what(), "valid JSON");
  }
}

JsonReader::JsonReader(const json& value, std::string source, std::string pointer)
    : value_(&value), source_(std::move(source)), pointer_(std::move(pointer)) {}

bool JsonReader::has(std::string_view name) const {
  if (!value_->is_object()) fail("an object");
  return value_->contains(name);
}

JsonReader JsonReader::member(std::string_view name) const {
  if (auto found = optional_member(name)) return *found;
  throw Error(where(), "no " + quote(name), "the field " + quote(name));
}

std::optional<JsonReader> JsonReader::optional_member(std::string_view name) const {
  if (!value_->is_object()) fail("an object");
  const auto found = value_->find(name);
  if (found == value_->end()) return std::nullopt;
  return JsonReader(*found, source_, pointer_ + "/" + escaped(name));
}

std::vector<std::pair<std::string, JsonReader>> JsonReader::members() const {
  if (!value_->is_object()) fail("an object");
  std::vector<std::pair<std::string, JsonReader>> result;
  for (const auto& [name, member] : value_->items()) {
    result.emplace_back(name, JsonReader(member, source_, pointer_ + "/" + escaped(name)));
  }
  return result;
}

void JsonReader::allow_only(std::initializer_list<std::string_view> known) const {
  allow_only(std::vector<std::string_view>(known));
}

void JsonReader::allow_only(const std::vector<std::string_view>& known) const {
  if (!value_->is_object()) fail("an object");
  for (const auto& [name, member] : value_->items()) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    std::string expected = "one of";
    for (const std::string_view one : known) expected += " " + quote(one);
    throw Error(where(), "the unknown field " + quote(name), expected);
  }
}

std::vector<JsonReader> JsonReader::elements(std::size_t least, std::size_t most) const {
  if (!value_->is_array()) fail("an array");
  const std::size_t count = value_->size();
  if (count < least || count > most) {
    const std::string expected = least == most   ? std::to_string(least)
                                 : count < least ? "at least " + std::to_string(least)
                                                 : "at most " + std::to_string(most);
    throw Error(where(), std::to_string(count) + " elements", expected);
  }
  std::vector<JsonReader> result;
  result.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    result.emplace_back((*value_)[i], source_, pointer_ + "/" + std::to_string(i));
  }
  return result;
}

bool JsonReader::boolean() const {
  if (!value_->is_boolean()) fail("true or false");
  return value_->get<bool>();
}

std::string JsonReader::string() const {
  if (!value_->is_string()) fail("a string");
  return value_->get<std::string>();
}

double JsonReader::number(double low, double high) const {
  if (!value_->is_number()) fail("a number");
  const auto number = value_->get<double>();
  if (!(number >= low && number <= high)) {
    fail("a number from " + json(low).dump() + " to " + json(high).dump());
  }
  return number;
}

std::int64_t JsonReader::integer(std::int64_t low, std::int64_t high) const {
  const std::optional<std::int64_t> whole = whole_number(*value_);
  if (!whole || *whole < low || *whole > high) {
    fail("a whole number from " + std::to_string(low) + " to " + std::to_string(high));
  }
  return *whole;
}

std::vector<double> JsonReader::numbers(std::size_t count, double low, double high) const {
  std::vector<double> result;
  for (const JsonReader& element : elements(count, count)) {
    result.push_back(element.number(low, high));
  }
  return result;
}

std::size_t JsonReader::one_of(const std::vector<std::string>& names) const {
  if (value_->is_string()) {
    const auto found = std::find(names.begin(), names.end(), value_->get<std::string>());
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  }
  std::string expected = "one of";
  for (const std::string& name : names) expected += " " + quote(name);
  fail(expected);
}

std::string JsonReader::where() const {
  return pointer_.empty() ? source_ : source_ + ": " + pointer_;
}

void JsonReader::fail(const std::string& expected) const {
  std::string found;
  if (value_->is_object()) {
    found = "an object";
  } else if (value_->is_array()) {
    found = "an array";
  } else if (value_->is_string()) {
    found = quote(value_->get<std::string>());
  } else {
    found = value_->dump();
  }
  throw Error(where(), found, expected);
}

}  // namespace rimlight

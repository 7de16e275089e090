#include "core/import/direction_list.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/base/json_reader.h"
#include "core/import/npy_file.h"

namespace rimlight {
namespace {

constexpr std::size_t kMostListBytes = std::size_t{64} << 20;
constexpr double kMostWeight = 1e6;
constexpr double kShortest = 1e-6, kLongest = 1e6;

const std::vector<std::string> kAxesNames = {"y_up", "z_up"};

/// One light as it stands in a list.
struct Entry {
  Vec3d direction;
  std::optional<double> weight;
  std::string image;
};

/// Checks entries one by one and gathers them; `where` names an entry in errors.
class ListBuilder {
 public:
  ListBuilder(const std::string& source, DirectionAxes axes) {
    list_.source = source;
    list_.axes = axes;
  }

  void add(const Entry& entry, const std::string& where) {
    if (list_.size() == kMostDirections) {
      throw Error(where, "one direction more", "at most " + std::to_string(kMostDirections));
    }
    same_for_all("a weight", entry.weight.has_value(), !list_.weights.empty(), where);
    same_for_all("an image", !entry.image.empty(), !list_.images.empty(), where);
    add_direction(entry.direction, where);
    if (entry.weight) add_weight(*entry.weight, where);
    if (!entry.image.empty()) list_.images.push_back(entry.image);
  }

  DirectionList finish() {
    if (list_.directions.empty()) throw Error(list_.source, "no direction", "at least one");
    return std::move(list_);
  }

 private:
  void same_for_all(const std::string& what, bool has, bool others_have,
                    const std::string& where) const {
    if (list_.directions.empty() || has == others_have) return;
    throw Error(where, has ? what : "a direction without " + what,
                what + (has ? " for no direction, as before" : " for each direction, as before"));
  }

  void add_weight(double weight, const std::string& where) {
    if (!(weight > 0 && weight <= kMostWeight)) {
      throw Error(where, "the weight " + std::to_string(weight),
                  "a solid angle above 0 and up to 1e6");
    }
    list_.weights.push_back(weight);
  }

  void add_direction(const Vec3d& given, const std::string& where) {
    const double size = std::hypot(given.x, given.y, given.z);
    if (!(size >= kShortest && size <= kLongest)) {
      throw Error(where, "a direction of length " + std::to_string(size),
                  "a finite direction that is not zero (length 1e-6 to 1e6)");
    }
    list_.directions.push_back(to_world(given / size, list_.axes));
  }

  DirectionList list_;
};

bool is_separator(char c) { return c == ' ' || c == '\t' || c == ',' || c == ';' || c == '\r'; }

std::vector<std::string_view> words_of(std::string_view line) {
  line = line.substr(0, line.find('#'));
  std::vector<std::string_view> words;
  while (!line.empty()) {
    const auto end = std::find_if(line.begin(), line.end(), is_separator);
    const auto length = static_cast<std::size_t>(end - line.begin());
    if (length > 0) words.push_back(line.substr(0, length));
    line.remove_prefix(std::min(length + 1, line.size()));
  }
  return words;
}

/// A name, not a number, stands first on a line.
bool is_image_name(std::string_view word) {
  const auto ends_with = [&](std::string_view ending) {
    return word.size() > ending.size() &&
           std::equal(ending.begin(), ending.end(), word.end() - ending.size(),
                      [](char a, char b) { return a == (b >= 'A' && b <= 'Z' ? b + 32 : b); });
  };
  return ends_with(".exr") || ends_with(".png");
}

double parse_number(std::string_view word, const std::string& where) {
  if (word.starts_with('+')) word.remove_prefix(1);  // from_chars takes none
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
    throw Error(where, quote(word), "a finite number");
  }
  return value;
}

Entry parse_line(std::vector<std::string_view> words, const std::string& where) {
  Entry entry;
  if (is_image_name(words.front())) {
    entry.image = words.front();
    words.erase(words.begin());
  }
  if (words.size() != 3 && words.size() != 4) {
    throw Error(where, std::to_string(words.size()) + " numbers",
                "3 or 4: x y z, or x y z weight, after an image's name (.exr or .png) if any");
  }
  std::array<double, 4> numbers{};
  for (std::size_t i = 0; i < words.size(); ++i) numbers[i] = parse_number(words[i], where);
  entry.direction = {numbers[0], numbers[1], numbers[2]};
  if (words.size() == 4) entry.weight = numbers[3];
  return entry;
}

DirectionList read_npy(const std::filesystem::path& path, DirectionAxes axes) {
  const NpyFile file(path);
  const NpyArray& array = file.array();
  const auto& shape = array.shape();
  if (shape.size() != 2 || (shape[1] != 3 && shape[1] != 4) || shape[0] == 0 ||
      shape[0] > kMostDirections) {
    throw Error(array.name() + ": \"shape\"", array.shape_text(),
                "n × 3, or n × 4 with weights, n from 1 to " + std::to_string(kMostDirections));
  }
  ListBuilder builder(array.name(), axes);
  std::array<float, 4> row{};
  for (std::size_t i = 0; i < shape[0]; ++i) {
    array.read(i * shape[1], std::span(row).first(shape[1]));
    Entry entry{Vec3d(Vec3f(row[0], row[1], row[2])), std::nullopt, ""};
    if (shape[1] == 4) entry.weight = static_cast<double>(row[3]);
    builder.add(entry, array.name() + ": [" + std::to_string(i) + "]");
  }
  return builder.finish();
}

DirectionAxes axes_of(const JsonReader& reader) {
  return static_cast<DirectionAxes>(reader.member("axes").one_of(kAxesNames));
}

DirectionList read_json(const JsonReader& reader) {
  reader.allow_only({"$schema", "axes", "directions"});
  ListBuilder builder(reader.source(), axes_of(reader));
  for (const JsonReader& element : reader.member("directions").elements(1, kMostDirections)) {
    element.allow_only({"direction", "weight", "image"});
    const auto numbers = element.member("direction").numbers(3, -kLongest, kLongest);
    Entry entry{{numbers[0], numbers[1], numbers[2]}, std::nullopt, ""};
    if (const auto weight = element.optional_member("weight")) {
      entry.weight = weight->number(0, kMostWeight);
    }
    if (const auto image = element.optional_member("image")) {
      entry.image = image->string();
      if (entry.image.empty()) image->fail("a file's name");
    }
    builder.add(entry, element.where());
  }
  return builder.finish();
}

DirectionList read_json_file(const std::filesystem::path& path, std::optional<DirectionAxes> axes) {
  const nlohmann::json document = parse_json(read_file(path, kMostListBytes), path.string());
  const JsonReader reader(document, path.string());
  if (axes && *axes != axes_of(reader)) {
    reader.member("axes").fail("what was asked for, " +
                               quote(kAxesNames[static_cast<std::size_t>(*axes)]));
  }
  return read_json(reader);
}

}  // namespace

Vec3d to_world(const Vec3d& given, DirectionAxes axes) {
  return axes == DirectionAxes::y_up ? given : Vec3d(given.x, given.z, -given.y);
}

DirectionList parse_direction_text(std::string_view text, const std::string& source,
                                   DirectionAxes axes) {
  ListBuilder builder(source, axes);
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    const auto words = words_of(text.substr(0, length));
    const std::string where = source + ": line " + std::to_string(line);
    if (!words.empty()) builder.add(parse_line(words, where), where);
    text.remove_prefix(std::min(length + 1, text.size()));
  }
  return builder.finish();
}

DirectionList parse_direction_json(std::string_view text, const std::string& source) {
  const nlohmann::json document = parse_json(text, source);
  return read_json(JsonReader(document, source));
}

DirectionList read_directions(const std::filesystem::path& path,
                              std::optional<DirectionAxes> axes) {
  const std::string ending = path.extension().string();
  if (ending == ".json") return read_json_file(path, axes);
  const DirectionAxes given = axes.value_or(DirectionAxes::y_up);
  if (ending == ".npy") return read_npy(path, given);
  if (ending == ".txt" || ending == ".csv") {
    return parse_direction_text(read_file(path, kMostListBytes), path.string(), given);
  }
  throw Error(path.string(), "the ending " + quote(ending),
              "\".json\", \".npy\", \".txt\" or \".csv\"");
}

}  // namespace rimlight

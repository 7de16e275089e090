#include "core/curves/curve_session_source.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/base/json_reader.h"
#include "core/curves/builtin_curve_session_texts.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestSource = std::size_t{1} << 20;
constexpr std::size_t kLongestName = 200;
constexpr std::size_t kMostStrokes = 256;
constexpr int kMostFrames = 1000;       // of one stroke
constexpr int kMostRest = 1000;         // after it
constexpr int kMostAllFrames = 10'000;  // of a session

/// The curves as they stand, by what they are of.
using Drawn = std::map<std::pair<std::string, CurveAxis>, CurveEdit>;

std::string read_name(const JsonReader& json) {
  std::string name = json.string();
  if (name.empty() || name.size() > kLongestName) {
    json.fail("a name of 1 to " + std::to_string(kLongestName) + " bytes");
  }
  return name;
}

/// One number for all channels, or three.
Vec3d read_value(const JsonReader& json) {
  if (!json.is_array()) return Vec3d::filled(json.number(0, kLargestCurveValue));
  const std::vector<double> v = json.numbers(3, 0, kLargestCurveValue);
  return {v[0], v[1], v[2]};
}

CurveEdit read_points(const JsonReader& json) {
  CurveEdit curve;
  if (const auto scale = json.optional_member("scale")) {
    curve.scale = scale->one_of({"linear", "logarithmic"}) == 0 ? CurveScale::linear
                                                                : CurveScale::logarithmic;
  }
  const JsonReader points = json.member("points");
  for (const JsonReader& point : points.elements(1, kMostCurvePoints)) {
    const std::vector<JsonReader> parts = point.elements(2, 2);
    curve.points.push_back({parts[0].number(0, 1), read_value(parts[1])});
  }
  check_curve_points(curve.points, points.where());
  return curve;
}

/// Where the points of `from` are dragged to.
CurveEdit read_drag(const JsonReader& json, const CurveEdit& from) {
  CurveEdit curve = from;
  const JsonReader drag = json.member("drag");
  for (const JsonReader& point : drag.elements(1, kMostCurvePoints)) {
    const std::vector<JsonReader> parts = point.elements(3, 3);
    const auto last = static_cast<std::int64_t>(curve.points.size()) - 1;
    const auto index = static_cast<std::size_t>(parts[0].integer(0, last));
    curve.points[index] = {parts[1].number(0, 1), read_value(parts[2])};
  }
  const auto is_behind = [](const CurvePoint& a, const CurvePoint& b) {
    return !(a.position < b.position);
  };
  // Between two curves whose points rise, those of all others do.
  if (std::ranges::adjacent_find(curve.points, is_behind) != curve.points.end()) {
    drag.fail("points that still rise");
  }
  return curve;
}

int read_frames(const JsonReader& json, const char* name, int least, int most, int otherwise) {
  const auto frames = json.optional_member(name);
  return frames ? static_cast<int>(frames->integer(least, most)) : otherwise;
}

CurveStroke read_stroke(const JsonReader& json, Drawn& drawn) {
  json.allow_only({"title", "material", "axis", "scale", "points", "drag", "frames", "rest"});
  CurveStroke stroke;
  stroke.material = read_name(json.member("material"));
  stroke.axis = json.member("axis").one_of({"half_angle", "difference_angle"}) == 0
                    ? CurveAxis::half_angle
                    : CurveAxis::difference_angle;
  if (json.has("points") == json.has("drag")) json.fail("either \"points\" or \"drag\"");
  const auto place = std::pair(stroke.material, stroke.axis);
  if (json.has("points")) {
    if (json.has("frames")) json.member("frames").fail("nothing: points are set at once");
    stroke.to = stroke.from = read_points(json);
  } else {
    if (json.has("scale")) json.member("scale").fail("nothing: the scale stays that of the points");
    const auto before = drawn.find(place);
    if (before == drawn.end()) json.member("drag").fail("\"points\" of this curve before");
    stroke.from = before->second;
    stroke.to = read_drag(json, stroke.from);
    stroke.frames = read_frames(json, "frames", 1, kMostFrames, 1);
  }
  drawn[place] = stroke.to;
  stroke.rest = read_frames(json, "rest", 0, kMostRest, 0);
  const auto title = json.optional_member("title");
  stroke.title = title ? read_name(*title) : stroke.material;
  return stroke;
}

}  // namespace

CurveSession parse_curve_session(std::string_view text, const std::string& source) {
  const nlohmann::json document = parse_json(text, source);
  const JsonReader json(document, source);
  json.allow_only({"$schema", "name", "edits"});
  CurveSession session;
  const auto name = json.optional_member("name");
  session.name = name ? read_name(*name) : fs::path(source).stem().string();
  Drawn drawn;
  const JsonReader edits = json.member("edits");
  for (const JsonReader& edit : edits.elements(1, kMostStrokes)) {
    session.strokes.push_back(read_stroke(edit, drawn));
    if (session.frame_count() > kMostAllFrames) {
      throw Error(edits.where(), "more frames",
                  "at most " + std::to_string(kMostAllFrames) + " frames in all");
    }
  }
  return session;
}

CurveSession read_curve_session(const fs::path& path) {
  return parse_curve_session(read_file(path, kLargestSource), path.string());
}

const std::vector<std::string>& builtin_curve_session_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    for (const auto& [name, text] : builtin_curve_session_texts()) result.emplace_back(name);
    return result;
  }();
  return names;
}

CurveSession find_curve_session(const std::string& name_or_file, const std::string& from) {
  for (const auto& [name, text] : builtin_curve_session_texts()) {
    if (name == name_or_file) return parse_curve_session(text, std::string(name));
  }
  if (fs::path(name_or_file).extension() == ".json") return read_curve_session(name_or_file);
  std::string expected = "a .json file or one of";
  for (const std::string& name : builtin_curve_session_names()) expected += " " + quote(name);
  throw Error(from, quote(name_or_file), expected);
}

}  // namespace rimlight

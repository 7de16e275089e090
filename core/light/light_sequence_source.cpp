#include "core/light/light_sequence_source.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/base/json_reader.h"
#include "core/light/builtin_light_sequence_texts.h"
#include "core/light/soft_disc.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestSource = std::size_t{1} << 20;
constexpr std::size_t kLongestName = 200;
constexpr std::size_t kMostTracks = 16;
constexpr std::size_t kMostLights = 16;
constexpr std::size_t kMostPoints = 64;
constexpr int kMostFrames = 10'000;  // of one motion
constexpr int kMostSpots = 1000;
constexpr double kFarthest = 1e6;   // coordinates of directions
constexpr double kNearest = 1e-6;   // and their length
constexpr double kBrightest = 1e6;  // radiance
constexpr double kMostScale = 1e3;
constexpr double kSmallestDegrees = 0.1;  // angular radius
constexpr double kWidestDegrees = 60;
constexpr double kDegree = std::numbers::pi / 180;

int read_frames(const JsonReader& json) {
  return static_cast<int>(json.member("frames").integer(2, kMostFrames));
}

Vec3d read_direction(const JsonReader& json) {
  const std::vector<double> v = json.numbers(3, -kFarthest, kFarthest);
  const Vec3d direction{v[0], v[1], v[2]};
  if (!(length(direction) >= kNearest)) json.fail("a direction that is not zero");
  return normalized(direction);
}

SpherePath read_path(const JsonReader& json) {
  constexpr double kMostDegrees = 179;
  std::vector<Vec3d> points;
  for (const JsonReader& element : json.elements(1, kMostPoints)) {
    const Vec3d point = read_direction(element);
    if (!points.empty() && dot(points.back(), point) < std::cos(kMostDegrees * kDegree)) {
      element.fail("a direction within 179 degrees of the one before");
    }
    points.push_back(point);
  }
  return SpherePath(std::move(points));
}

/// One number for all channels, or three.
Vec3d read_radiance(const JsonReader& json) {
  if (!json.is_array()) return Vec3d::filled(json.number(0, kBrightest));
  const std::vector<double> v = json.numbers(3, 0, kBrightest);
  return {v[0], v[1], v[2]};
}

double read_radius(const JsonReader& json) {
  return json.number(kSmallestDegrees, kWidestDegrees) * kDegree;
}

double read_edge(const JsonReader& json) {
  const auto edge = json.optional_member("edge");
  return edge ? edge->number(0, 1) : 0;
}

/// Tells "given", built-in environments and the sequence's own lights from mistakes.
std::string read_light_name(const JsonReader& json, const LightSequence& sequence) {
  std::vector<std::string> names{std::string(kGivenLight)};
  const auto& builtins = builtin_environment_names();
  names.insert(names.end(), builtins.begin(), builtins.end());
  for (const auto& [name, file] : sequence.lights) names.push_back(name);
  return names[json.one_of(names)];
}

BlendSource read_blend(const JsonReader& json, const LightSequence& sequence) {
  json.allow_only({"from", "to", "frames"});
  BlendSource blend{read_light_name(json.member("from"), sequence),
                    read_light_name(json.member("to"), sequence), read_frames(json)};
  if (blend.from == blend.to) json.member("to").fail("another light than \"from\"");
  return blend;
}

AreaLightSource read_area_light(const JsonReader& json) {
  json.allow_only({"radiance", "path", "angular_radius", "edge", "frames"});
  const JsonReader radius = json.member("angular_radius");
  const std::vector<JsonReader> ends =
      radius.is_array() ? radius.elements(2, 2) : std::vector{radius, radius};
  return {read_radiance(json.member("radiance")),
          read_path(json.member("path")),
          read_radius(ends[0]),
          read_radius(ends[1]),
          read_edge(json),
          read_frames(json)};
}

PaintSource read_paint(const JsonReader& json) {
  json.allow_only({"radiance", "stroke", "spots", "angular_radius", "edge", "frames"});
  return {read_radiance(json.member("radiance")),
          read_path(json.member("stroke")),
          static_cast<int>(json.member("spots").integer(1, kMostSpots)),
          read_radius(json.member("angular_radius")),
          read_edge(json),
          read_frames(json)};
}

LightSource read_source(const JsonReader& json, const LightSequence& sequence) {
  const int kinds = int{json.has("light")} + int{json.has("blend")} + int{json.has("area_light")} +
                    int{json.has("paint")};
  if (kinds != 1) json.fail("one of \"light\", \"blend\", \"area_light\" and \"paint\"");
  if (json.has("blend")) return read_blend(json.member("blend"), sequence);
  if (json.has("area_light")) return read_area_light(json.member("area_light"));
  if (json.has("paint")) return read_paint(json.member("paint"));
  return EnvironmentSource{read_light_name(json.member("light"), sequence)};
}

EasedTurn read_turn(const JsonReader& json) {
  json.allow_only({"axis", "degrees_per_frame", "frames", "ease_in", "ease_out"});
  EasedTurn turn;
  turn.axis = read_direction(json.member("axis"));
  turn.peak = json.member("degrees_per_frame").number(0, 90) * kDegree;
  turn.frames = read_frames(json);
  const int steps = turn.frames - 1;
  if (const auto ease = json.optional_member("ease_in")) {
    turn.ease_in = static_cast<int>(ease->integer(0, steps));
  }
  if (const auto ease = json.optional_member("ease_out")) {
    turn.ease_out = static_cast<int>(ease->integer(0, steps - turn.ease_in));
  }
  return turn;
}

/// The band is given in hertz; a flicker's waves go round a whole number of times.
Flicker read_flicker(const JsonReader& json, const LightSequence& sequence) {
  json.allow_only({"amount", "band", "seed", "frames"});
  FlickerSettings settings;
  settings.amount = json.member("amount").number(0, 1);
  settings.frames = read_frames(json);
  const auto seed = json.optional_member("seed");
  // Above 2^53 JSON numbers are not exact everywhere.
  if (seed) settings.seed = static_cast<std::uint64_t>(seed->integer(0, std::int64_t{1} << 53));
  const JsonReader band = json.member("band");
  const std::vector<double> hertz = band.numbers(2, 0, sequence.frames_per_second / 2);
  const int steps = settings.frames - 1;
  const double seconds = steps / sequence.frames_per_second;
  // To a rounding: 3 Hz in 2 seconds are 6 cycles whatever the frame rate.
  constexpr double kRounding = 1e-9;
  settings.lowest_cycles = std::max(1, static_cast<int>(std::ceil(hertz[0] * seconds - kRounding)));
  settings.highest_cycles =
      std::min((steps - 1) / 2, static_cast<int>(std::floor(hertz[1] * seconds + kRounding)));
  if (settings.lowest_cycles > settings.highest_cycles) {
    band.fail("a band [low, high] with a multiple of " + std::to_string(1 / seconds) +
              " Hz in it that is below half the frame rate");
  }
  return Flicker(settings);
}

LightTrack read_track(const JsonReader& json, const LightSequence& sequence) {
  json.allow_only({"light", "blend", "area_light", "paint", "scale", "rotate", "flicker"});
  LightTrack track{read_source(json, sequence), 1, std::nullopt, std::nullopt};
  if (const auto scale = json.optional_member("scale")) track.scale = scale->number(0, kMostScale);
  if (const auto turn = json.optional_member("rotate")) track.rotate = read_turn(*turn);
  if (const auto flicker = json.optional_member("flicker")) {
    track.flicker = read_flicker(*flicker, sequence);
  }
  return track;
}

std::string read_name(const JsonReader& json) {
  std::string name = json.string();
  if (name.empty() || name.size() > kLongestName) {
    json.fail("a name of 1 to " + std::to_string(kLongestName) + " bytes");
  }
  return name;
}

std::map<std::string, fs::path> read_lights(const JsonReader& json, const fs::path& folder) {
  std::map<std::string, fs::path> lights;
  const auto& builtins = builtin_environment_names();
  for (const auto& [name, file] : json.members()) {
    if (lights.size() == kMostLights) json.fail("at most " + std::to_string(kMostLights));
    if (name.empty() || name.size() > kLongestName || name == kGivenLight ||
        std::find(builtins.begin(), builtins.end(), name) != builtins.end()) {
      throw Error(json.where(), "the name " + quote(name),
                  "a name of 1 to 200 bytes that is not taken");
    }
    if (file.string().empty()) file.fail("the name of a .hdr or .exr file");
    lights[name] = folder / file.string();
  }
  return lights;
}

}  // namespace

LightSequence parse_light_sequence(std::string_view text, const std::string& source,
                                   const fs::path& folder) {
  const nlohmann::json document = parse_json(text, source);
  const JsonReader json(document, source);
  json.allow_only({"$schema", "name", "frames_per_second", "still_frames", "lights", "tracks"});
  LightSequence sequence;
  const auto name = json.optional_member("name");
  sequence.name = name ? read_name(*name) : fs::path(source).stem().string();
  if (const auto rate = json.optional_member("frames_per_second")) {
    sequence.frames_per_second = rate->number(1, 240);
  }
  if (const auto still = json.optional_member("still_frames")) {
    sequence.still_frames = static_cast<int>(still->integer(0, kMostFrames));
  }
  if (const auto lights = json.optional_member("lights")) {
    sequence.lights = read_lights(*lights, folder);
  }
  for (const JsonReader& track : json.member("tracks").elements(1, kMostTracks)) {
    sequence.tracks.push_back(read_track(track, sequence));
  }
  return sequence;
}

LightSequence read_light_sequence(const fs::path& path) {
  return parse_light_sequence(read_file(path, kLargestSource), path.string(), path.parent_path());
}

const std::vector<std::string>& builtin_light_sequence_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    for (const auto& [name, text] : builtin_light_sequence_texts()) result.emplace_back(name);
    return result;
  }();
  return names;
}

LightSequence find_light_sequence(const std::string& name_or_file, const std::string& from) {
  for (const auto& [name, text] : builtin_light_sequence_texts()) {
    if (name == name_or_file) return parse_light_sequence(text, std::string(name), {});
  }
  if (fs::path(name_or_file).extension() == ".json") return read_light_sequence(name_or_file);
  std::string expected = "a .json file or one of";
  for (const std::string& name : builtin_light_sequence_names()) expected += " " + quote(name);
  throw Error(from, quote(name_or_file), expected);
}

}  // namespace rimlight

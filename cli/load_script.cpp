#include "cli/load_script.h"

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/base/json_reader.h"

namespace rimlight {
namespace {

constexpr double kEditsPerSecond = 60;
constexpr double kFirstSpeed = 0.4;     // radians a second
constexpr double kAcceleration = 0.05;  // radians a second, each second
constexpr std::size_t kLargestScript = std::size_t{16} << 20;
constexpr std::size_t kMostEdits = 1'000'000;
constexpr double kLongestMs = 3.6e6;

/// An object of the message, or null.
nlohmann::json read_object(const JsonReader& reader, std::string_view name) {
  const auto member = reader.optional_member(name);
  if (!member) return {};
  if (!member->value().is_object()) member->fail("an object, as edits have it");
  return member->value();
}

ScriptedEdit read_edit(const JsonReader& reader) {
  reader.allow_only({"at_ms", "rotation", "environment", "exposure", "view", "material"});
  ScriptedEdit edit;
  edit.at_ms = reader.member("at_ms").number(0, kLongestMs);
  if (const auto member = reader.optional_member("rotation")) {
    const std::vector<double> v = member->numbers(4, -1e6, 1e6);
    const Quaternion rotation{v[0], v[1], v[2], v[3]};
    if (!(norm(rotation) >= 1e-6)) member->fail("a quaternion [x, y, z, w] that is not zero");
    edit.rotation = normalized(rotation);
  }
  if (const auto member = reader.optional_member("environment")) {
    edit.environment = member->string();
  }
  if (const auto member = reader.optional_member("exposure")) {
    edit.exposure_stops = member->number(-20, 20);
  }
  edit.view = read_object(reader, "view");
  edit.material = read_object(reader, "material");
  if (!edit.rotation && !edit.environment && !edit.exposure_stops && edit.view.is_null() &&
      edit.material.is_null()) {
    reader.fail("one or more of rotation, environment, exposure, view, material");
  }
  return edit;
}

}  // namespace

LoadScript default_script(double seconds) {
  LoadScript script;
  const auto count = static_cast<std::size_t>(seconds * kEditsPerSecond);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / kEditsPerSecond;
    // Starts away from the identity, which the session shows already.
    const double angle = 0.05 + (kFirstSpeed + kAcceleration * t / 2) * t;
    ScriptedEdit edit;
    edit.at_ms = t * 1e3;
    edit.rotation = axis_angle({0, 1, 0}, angle);
    script.edits.push_back(edit);
  }
  return script;
}

LoadScript read_script(const std::filesystem::path& file, double seconds) {
  const nlohmann::json document = parse_json(read_file(file, kLargestScript), file.string());
  const JsonReader reader(document, file.string());
  reader.allow_only({"repeat_ms", "edits"});
  std::vector<ScriptedEdit> once;
  for (const JsonReader& element : reader.member("edits").elements(1, 100'000)) {
    once.push_back(read_edit(element));
    if (once.size() > 1 && once.back().at_ms < once[once.size() - 2].at_ms) {
      element.member("at_ms").fail("no less than the edit before");
    }
  }
  double repeat_ms = 0;
  if (const auto member = reader.optional_member("repeat_ms")) {
    repeat_ms = member->number(1, kLongestMs);
    if (repeat_ms < once.back().at_ms) member->fail("no less than the last edit's at_ms");
  }
  LoadScript script;
  for (double start = 0; start < seconds * 1e3; start += repeat_ms) {
    for (ScriptedEdit edit : once) {
      edit.at_ms += start;
      if (edit.at_ms >= seconds * 1e3 || script.edits.size() >= kMostEdits) return script;
      script.edits.push_back(std::move(edit));
    }
    if (repeat_ms == 0) break;
  }
  return script;
}

LoadScript sequence_script(const LightSequence& sequence) {
  const std::optional<std::string> light = sequence.rotated_light();
  if (!light) {
    throw Error("sequence " + quote(sequence.name), "light that edits of a session cannot show",
                "one track of one light, which may rotate");
  }
  LoadScript script;
  for (int frame = 0; frame < sequence.frame_count(); ++frame) {
    if (frame > 0 && !sequence.is_moving(frame)) continue;
    ScriptedEdit edit;
    edit.at_ms = sequence.seconds(frame) * 1e3;
    edit.rotation = sequence.rotation_at(frame);
    if (frame == 0 && *light != kGivenLight) edit.environment = *light;
    script.edits.push_back(std::move(edit));
  }
  return script;
}

std::string edit_message(const ScriptedEdit& edit, const std::string& id) {
  nlohmann::json message{{"type", "edit"}, {"id", id}};
  if (edit.rotation) {
    const Quaternion& q = *edit.rotation;
    message["rotation"] = {q.x, q.y, q.z, q.w};
  }
  if (edit.environment) message["environment"] = *edit.environment;
  if (edit.exposure_stops) message["exposure"] = *edit.exposure_stops;
  if (!edit.view.is_null()) message["view"] = edit.view;
  if (!edit.material.is_null()) message["material"] = edit.material;
  return message.dump();
}

}  // namespace rimlight

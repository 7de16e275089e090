#include "server/protocol/messages.h"

#include <algorithm>
#include <cmath>

#include "core/base/json_reader.h"
#include "server/protocol/editable_material.h"

namespace rimlight::server {
namespace {

using nlohmann::json;

/// A rotation shorter than this says nothing about its direction.
constexpr double kShortestRotation = 1e-6;
/// Components beyond this could overflow the norm.
constexpr double kLargestComponent = 1e6;

/// Text from outside may hold bytes that are not UTF-8 (a shortened quote): replaced, not refused.
std::string dump(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string read_id(const JsonReader& message, const char* name = "id") {
  const auto member = message.optional_member(name);
  if (!member) return {};
  std::string id = member->string();
  if (id.size() > kLongestId) member->fail("at most " + std::to_string(kLongestId) + " bytes");
  return id;
}

Quaternion read_rotation(const JsonReader& reader) {
  const std::vector<double> v = reader.numbers(4, -kLargestComponent, kLargestComponent);
  const Quaternion rotation{v[0], v[1], v[2], v[3]};
  if (!(norm(rotation) >= kShortestRotation)) {
    reader.fail("a quaternion [x, y, z, w] that is not zero");
  }
  return normalized(rotation);
}

Edit read_edit(const JsonReader& message, const std::vector<std::string>& environments,
               const KnownMaterials& materials) {
  message.allow_only(
      {"type", "id", "gesture", "rotation", "environment", "exposure", "view", "material"});
  Edit edit;
  edit.id = read_id(message);
  edit.gesture = read_id(message, "gesture");
  if (const auto member = message.optional_member("rotation")) {
    edit.rotation = read_rotation(*member);
  }
  if (const auto member = message.optional_member("environment")) {
    edit.environment = environments[member->one_of(environments)];
  }
  if (const auto member = message.optional_member("exposure")) {
    edit.exposure_stops = member->number(-kExposureRange, kExposureRange);
  }
  if (const auto member = message.optional_member("view")) edit.view = read_view(*member);
  if (const auto member = message.optional_member("material")) {
    edit.materials = read_material(*member, materials);
  }
  if (!edit.rotation && !edit.environment && !edit.exposure_stops && !edit.view &&
      edit.materials.empty()) {
    throw Error(message.where(), "an edit that sets nothing",
                "one or more of rotation, environment, exposure, view, material");
  }
  return edit;
}

Travel read_travel(const JsonReader& message, Travel::Direction direction) {
  message.allow_only({"type", "id"});
  return {read_id(message), direction};
}

SnapshotCommand read_snapshot(const JsonReader& message) {
  message.allow_only({"type", "id", "action", "name"});
  static const std::vector<std::string> kActions{"make", "restore", "delete"};
  constexpr SnapshotCommand::Action kMeaning[]{SnapshotCommand::Action::make,
                                               SnapshotCommand::Action::restore,
                                               SnapshotCommand::Action::remove};
  const JsonReader name = message.member("name");
  SnapshotCommand command{read_id(message), kMeaning[message.member("action").one_of(kActions)],
                          name.string()};
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 0x7f; };
  if (command.name.empty() || command.name.size() > kLongestSnapshotName ||
      std::ranges::any_of(command.name, is_control)) {
    name.fail("1 to " + std::to_string(kLongestSnapshotName) + " bytes on one line");
  }
  return command;
}

/// What a state in JSON has of materials, on top of none.
void read_materials(const JsonReader& material, const KnownMaterials& known, DesignState& state) {
  const auto is_empty = [&](const char* part) {
    const auto member = material.optional_member(part);
    return !member || member->members().empty();
  };
  if (is_empty("parameter") && is_empty("curve") && is_empty("load")) return;
  apply_material(read_material(material, known), state.materials);
}

/// A whole state, held to the rules of edits.
DesignState read_given_state(const JsonReader& state, const std::vector<std::string>& environments,
                             const KnownMaterials& materials) {
  constexpr double kUnit = 1e-9;  // a rotation as near as this to unit length keeps its bits
  state.allow_only({"rotation", "environment", "exposure", "view", "material"});
  DesignState read;
  const std::vector<double> q =
      state.member("rotation").numbers(4, -kLargestComponent, kLargestComponent);
  read.rotation = {q[0], q[1], q[2], q[3]};
  if (!(std::abs(norm(read.rotation) - 1) <= kUnit)) {
    read.rotation = read_rotation(state.member("rotation"));
  }
  read.environment = environments[state.member("environment").one_of(environments)];
  read.exposure_stops = state.member("exposure").number(-kExposureRange, kExposureRange);
  read.view = read_view(state.member("view"));
  read_materials(state.member("material"), materials, read);
  return read;
}

Import read_import(const JsonReader& message, const std::vector<std::string>& environments,
                   const KnownMaterials& materials) {
  message.allow_only({"type", "id", "state"});
  const JsonReader state = message.member("state");
  return {read_id(message), read_given_state(state, environments, materials)};
}

json with_revision(const char* type, const Revision& revision) {
  return {{"type", type}, {"epoch", revision.epoch}, {"revision", revision.number}};
}

json material_of_welcome(const VertexMaterial& material) {
  json text = parameters_to_json({material.albedo, material.highlight, material.exponent});
  text["name"] = material.name;
  return text;
}

}  // namespace

ClientMessage parse_client_message(std::string_view text,
                                   const std::vector<std::string>& environments,
                                   const KnownMaterials& materials) {
  const json document = parse_json(text, "message");
  const JsonReader message(document, "message");
  static const std::vector<std::string> kTypes{"edit",   "frame_ack", "ping",
                                               "undo",   "redo",      "snapshot",
                                               "import", "display",   "delete_session"};
  switch (message.member("type").one_of(kTypes)) {
    case 0:
      return read_edit(message, environments, materials);
    case 1:
      message.allow_only({"type", "frame"});
      return FrameAck{message.member("frame").integer(0, kLargestWhole)};
    case 2:
      message.allow_only({"type", "id"});
      return Ping{read_id(message)};
    case 3:
      return read_travel(message, Travel::Direction::undo);
    case 4:
      return read_travel(message, Travel::Direction::redo);
    case 5:
      return read_snapshot(message);
    case 6:
      return read_import(message, environments, materials);
    case 7:
      return read_display(message);
    default:
      message.allow_only({"type", "id"});
      return DeleteSession{read_id(message)};
  }
}

Import read_export(std::string_view text, const std::vector<std::string>& environments,
                   const KnownMaterials& materials) {
  const json document = parse_json(text, "file");
  const JsonReader file(document, "file");
  (void)file.member("format").one_of({"rimlight session 1"});
  return {{}, read_given_state(file.member("state"), environments, materials)};
}

std::optional<std::string> find_message_id(std::string_view text) {
  const json message = json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!message.is_object()) return std::nullopt;
  const auto id = message.find("id");
  if (id == message.end() || !id->is_string()) return std::nullopt;
  auto value = id->get<std::string>();
  if (value.size() > kLongestId) return std::nullopt;
  return value;
}

json state_to_json(const DesignState& state) {
  const Quaternion& q = state.rotation;
  return {{"rotation", {q.x, q.y, q.z, q.w}},
          {"environment", state.environment},
          {"exposure", state.exposure_stops},
          {"view", view_to_json(state.view)},
          {"material", material_to_json(state.materials)}};
}

DesignState read_state(const JsonReader& reader) {
  DesignState state;
  // As it stands: dividing by its length again could change its last bits, and those of pixels.
  const std::vector<double> q = reader.member("rotation").numbers(4, -2, 2);
  state.rotation = {q[0], q[1], q[2], q[3]};
  state.environment = reader.member("environment").string();
  state.exposure_stops = reader.member("exposure").number(-kExposureRange, kExposureRange);
  state.view = read_view(reader.member("view"));
  read_materials(reader.member("material"), {}, state);
  return state;
}

void apply_edit(const Edit& edit, DesignState& state) {
  apply_material(edit.materials, state.materials);
  if (edit.rotation) state.rotation = *edit.rotation;
  if (edit.environment) state.environment = *edit.environment;
  if (edit.exposure_stops) state.exposure_stops = *edit.exposure_stops;
  if (edit.view) state.view = *edit.view;
}

std::string write_welcome(const Welcome& welcome) {
  json message = with_revision("welcome", welcome.revision);
  message["session"] = welcome.session;
  message["scene"] = welcome.scene;
  message["environments"] = welcome.environments;
  message["size"] = {{"width", welcome.width}, {"height", welcome.height}};
  message["camera"] = camera_to_json(welcome.camera);
  message["any_view"] = welcome.any_view;
  message["materials"] = json::array();
  for (const VertexMaterial& material : welcome.materials) {
    message["materials"].push_back(material_of_welcome(material));
  }
  message["editable"] = json::array();
  for (const CurveMaterial& material : welcome.editable) {
    message["editable"].push_back(editable_to_json(material));
  }
  message["measured"] = welcome.measured;
  message["state"] = state_to_json(welcome.state);
  message["by"] = author_to_json(welcome.author);
  message["you"] = present_to_json(welcome.you);
  message["resume"] = welcome.resume;
  message["resumed"] = welcome.resumed;
  message["missed"] = welcome.missed ? json(*welcome.missed) : json();
  message["history"] = depth_to_json(welcome.history);
  message["snapshots"] = labels_to_json(welcome.snapshots);
  add_presence(welcome.present, message);
  return dump(message);
}

std::string write_ack(std::string_view id, const Revision& revision, const DesignState& state,
                      const Author& author, const HistoryDepth& history) {
  json message = with_revision("ack", revision);
  message["id"] = id;
  message["by"] = author_to_json(author);
  message["history"] = depth_to_json(history);
  message["state"] = state_to_json(state);
  return dump(message);
}

std::string write_state(const Revision& revision, const DesignState& state, const Author& author) {
  json message = with_revision("state", revision);
  message["by"] = author_to_json(author);
  message["state"] = state_to_json(state);
  return dump(message);
}

std::string write_export(const std::string& scene, const std::string& session,
                         const Revision& revision, const DesignState& state) {
  return dump({{"format", "rimlight session 1"},
               {"scene", scene},
               {"session", session},
               {"epoch", revision.epoch},
               {"revision", revision.number},
               {"state", state_to_json(state)}}) +
         "\n";
}

std::string write_environments(const std::vector<std::string>& names) {
  return dump({{"type", "environments"}, {"environments", names}});
}

std::string write_deleted(const Author& by) {
  return dump({{"type", "deleted"}, {"by", author_to_json(by)}});
}

std::string write_pong(std::string_view id) { return dump({{"type", "pong"}, {"id", id}}); }

std::string write_error(const Error& error, const std::optional<std::string>& id) {
  json message{{"type", "error"}, {"reason", error.what()}, {"where", error.where()}};
  if (id) message["id"] = *id;
  return dump(message);
}

std::string write_error(std::string_view reason) {
  return dump({{"type", "error"}, {"reason", reason}});
}

}  // namespace rimlight::server

#include "server/protocol/messages.h"

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

std::string read_id(const JsonReader& message) {
  const auto member = message.optional_member("id");
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
  message.allow_only({"type", "id", "rotation", "environment", "exposure", "view", "material"});
  Edit edit;
  edit.id = read_id(message);
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
  static const std::vector<std::string> kTypes{"edit", "frame_ack", "ping"};
  switch (message.member("type").one_of(kTypes)) {
    case 0:
      return read_edit(message, environments, materials);
    case 1:
      message.allow_only({"type", "frame"});
      return FrameAck{message.member("frame").integer(0, kLargestWhole)};
    default:
      message.allow_only({"type", "id"});
      return Ping{read_id(message)};
  }
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
  const JsonReader material = reader.member("material");
  const auto is_empty = [&](const char* part) {
    const auto member = material.optional_member(part);
    return !member || member->members().empty();
  };
  if (is_empty("parameter") && is_empty("curve") && is_empty("load")) return state;
  apply_material(read_material(material, {}), state.materials);
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
  return dump(message);
}

std::string write_ack(std::string_view id, const Revision& revision, const DesignState& state) {
  json message = with_revision("ack", revision);
  message["id"] = id;
  message["state"] = state_to_json(state);
  return dump(message);
}

std::string write_state(const Revision& revision, const DesignState& state) {
  json message = with_revision("state", revision);
  message["state"] = state_to_json(state);
  return dump(message);
}

std::string write_environments(const std::vector<std::string>& names) {
  return dump({{"type", "environments"}, {"environments", names}});
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

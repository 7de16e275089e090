#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/json_reader.h"
#include "core/relight/design_state.h"

namespace rimlight::server {

// The parts of edits and states that scenes of vertices show, as they stand in messages:
//   view      {"camera": {"position", "target", "up", "fov"}}, or null for the scene's own
//   material  {"parameter": {NAME: {"albedo", "highlight", "exponent", "lobe"}}}, or null for a
//             name to take back what was edited; a lobe of null gives way to the exponent

/// Exponents of highlights on the wire.
inline constexpr double kLargestExponent = 10'000;
/// An edit may name so many materials, and a session may have edits of so many.
inline constexpr std::size_t kMostMaterials = 256;
/// Longest name of a material, in bytes.
inline constexpr std::size_t kLongestMaterial = 200;

/// What an edit does to each material: sets what its edit has, of lobe and exponent the last that
/// came (the lobe, where they come together); a lobe of no values is taken back; nothing takes all
/// back.
using MaterialEdits = std::map<std::string, std::optional<MaterialEdit>>;

/// Throws Error, naming the field: numbers that are not finite or out of range, a camera without
/// rays (check_camera).
std::optional<Camera> read_view(const JsonReader& reader);
/// Throws Error, naming the field, for values out of range and for a name that is not among
/// `materials`. A scene that has none takes any: it shows no edit of them, but keeps them.
MaterialEdits read_material(const JsonReader& reader, const std::vector<std::string>& materials);

nlohmann::json camera_to_json(const Camera& camera);
nlohmann::json view_to_json(const std::optional<Camera>& view);
nlohmann::json material_to_json(const std::map<std::string, MaterialEdit>& materials);
/// One material's part of it.
nlohmann::json parameters_to_json(const MaterialEdit& edit);

/// Sets, on top of what was edited before. Throws Error, and changes nothing, when a state would
/// have edits of too many materials.
void apply_material(const MaterialEdits& edits, std::map<std::string, MaterialEdit>& materials);

}  // namespace rimlight::server

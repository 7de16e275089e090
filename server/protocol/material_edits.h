#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/json_reader.h"
#include "core/relight/design_state.h"
#include "server/protocol/curve_edits.h"

namespace rimlight::server {

// What edits and states say of materials, each member by the material's name:
//   parameter  {"albedo", "highlight", "exponent", "lobe", "specular", "roughness", "eta", "k",
//              "exponent_across", "roughness_across"}, or null to take back all that was edited of
//              it; a lobe of null gives way to the exponent
//   curve      {"half_angle", "difference_angle"}: see curve_edits.h
//   load       the name of a measured BRDF, or null for the material's own
// An edit has one or more of them; a parameter of null comes first.

/// Exponents of highlights and of editable BRDFs on the wire.
inline constexpr double kLargestExponent = 10'000;
inline constexpr double kLargestBrdfExponent = 100'000;
/// An edit may name so many materials, and a session may have edits of so many.
inline constexpr std::size_t kMostMaterials = 256;
/// A session may have so many drawn curves: each reply tells them all.
inline constexpr std::size_t kMostDrawnCurves = 64;
/// Longest name of a material or a measured BRDF, in bytes.
inline constexpr std::size_t kLongestMaterial = 200;

/// What a scene lets edits name.
struct KnownMaterials {
  /// All of them. Where there are none, an edit may name any: no frame shows it, but it is kept.
  std::vector<std::string> names = {};
  /// Those whose BRDFs are edited, and the factors that can be drawn. Where there are none, curves
  /// and measured BRDFs are kept as above.
  std::map<std::string, std::vector<CurveAxis>> editable = {};
  std::vector<std::string> measured = {};
};

/// What an edit does to one material: takes all back, then sets what `set` has. Of lobe and
/// exponent the last that came counts (the lobe, where they come together). A lobe of no values, a
/// curve of neither points nor values and an empty name of a measured BRDF are taken back.
struct MaterialChange {
  bool takes_back = false;
  MaterialEdit set = {};

  friend bool operator==(const MaterialChange&, const MaterialChange&) = default;
};
using MaterialEdits = std::map<std::string, MaterialChange>;

/// Throws Error, naming the field, for values out of range and for names that are not known.
MaterialEdits read_material(const JsonReader& reader, const KnownMaterials& known);

nlohmann::json material_to_json(const std::map<std::string, MaterialEdit>& materials);
/// One material's parameters.
nlohmann::json parameters_to_json(const MaterialEdit& edit);

/// Sets, on top of what was edited before. Throws Error, and changes nothing, when a state would
/// have edits of too many materials, or too many curves.
void apply_material(const MaterialEdits& edits, std::map<std::string, MaterialEdit>& materials);

}  // namespace rimlight::server

#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/light/light_sequence.h"
#include "core/math/rotation.h"

namespace rimlight {

/// What one scripted client sends, and when: times from the start, ascending.
struct ScriptedEdit {
  double at_ms = 0;
  std::optional<Quaternion> rotation;
  std::optional<std::string> environment;
  std::optional<double> exposure_stops;
  // As they stand in messages (docs/protocol/edit.md): the server checks them. Null: none.
  nlohmann::json view = {}, material = {};
};

struct LoadScript {
  std::vector<ScriptedEdit> edits;
};

/// Rotation about y at 60 edits a second with growing speed, so that no two edits show the same
/// light.
LoadScript default_script(double seconds);

/// Reads a script (docs/protocol/load-script.md); `seconds` repeats or cuts it. Throws Error naming
/// file and field.
LoadScript read_script(const std::filesystem::path& file, double seconds);

/// The edits that show a light sequence, one for each frame that moves, and one to begin with.
/// Throws Error for a sequence that edits cannot show (docs/formats/light_sequence.md).
LoadScript sequence_script(const LightSequence& sequence);

/// The edit as a message of the protocol.
std::string edit_message(const ScriptedEdit& edit, const std::string& id);

}  // namespace rimlight

#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/base/error.h"
#include "core/math/camera.h"
#include "core/relight/design_state.h"
#include "core/transport/curve_receivers.h"
#include "core/transport/vertex_transport.h"
#include "server/protocol/commands.h"
#include "server/protocol/display_message.h"
#include "server/protocol/material_edits.h"
#include "server/protocol/people.h"
#include "server/protocol/view_edits.h"

namespace rimlight::server {

/// The text messages of docs/protocol, as plain values.

/// Clients may send text messages of at most this size; larger ones end the connection.
inline constexpr std::size_t kLargestMessage = 64 * 1024;
/// Longest "id" of a message, and "gesture" of an edit, in bytes.
inline constexpr std::size_t kLongestId = 64;
/// Exposure stays within ± this many stops.
inline constexpr double kExposureRange = 20;
/// Whole numbers in JSON are exact up to here (2⁵³).
inline constexpr std::int64_t kLargestWhole = std::int64_t{1} << 53;

/// Where a session stands: `revision` counts its edits, `epoch` names the life of the session, so
/// that no pair is used twice, not even over a restart of the server. Later pairs compare greater.
struct Revision {
  std::int64_t epoch = 0;
  std::int64_t number = 0;

  friend auto operator<=>(const Revision&, const Revision&) = default;
};

/// Sets some of a session's state, absolutely.
struct Edit {
  std::string id;  // the client's own name for it, given back in the ack
  std::optional<Quaternion> rotation;
  std::optional<std::string> environment;
  std::optional<double> exposure_stops;
  std::optional<std::optional<Camera>> view = {};  // no camera inside: the scene's own again
  MaterialEdits materials = {};
  /// The client's name for a drag, or anything else that is undone at once: edits of one that
  /// follow each other are one step. Empty: a step of its own.
  std::string gesture = {};

  friend bool operator==(const Edit&, const Edit&) = default;
};

/// The client has shown the frame and takes the next.
struct FrameAck {
  std::int64_t frame = 0;

  friend bool operator==(const FrameAck&, const FrameAck&) = default;
};

/// Asks for a pong with the same id: a page cannot see the WebSocket's own pings.
struct Ping {
  std::string id;

  friend bool operator==(const Ping&, const Ping&) = default;
};

using ClientMessage =
    std::variant<Edit, FrameAck, Ping, Travel, SnapshotCommand, Import, Display, DeleteSession>;
/// What makes a revision.
using Command = std::variant<Edit, Travel, SnapshotCommand, Import>;

/// The command in a message, if it is one.
std::optional<Command> command_of(const ClientMessage& message);
const std::string& id_of(const Command& command);
/// Throws Error for one that only a greater role may ask for: editors edit, undo and make
/// snapshots; owners import, and restore and delete snapshots.
void check_role(const Command& command, Role role);
/// Only owners may.
void check_role(const DeleteSession& command, Role role);

/// Reads one text message of a client. Throws Error, where() naming the field: malformed JSON, an
/// unknown type or field, a rotation that is not finite or cannot be normalised, an environment
/// that is not among `environments`, an exposure out of range, a view or a material that cannot be
/// (view_edits.h, material_edits.h), an edit that sets nothing. Rotations come back as unit
/// quaternions.
ClientMessage parse_client_message(std::string_view text,
                                   const std::vector<std::string>& environments,
                                   const KnownMaterials& materials = {});

/// Sets what the edit has. Throws Error, and changes nothing, for a state that grows too large.
void apply_edit(const Edit& edit, DesignState& state);

/// The id of a message that may be otherwise wrong, so that its error reply can name it.
std::optional<std::string> find_message_id(std::string_view text);

/// What a client is told when it opens a session.
struct Welcome {
  std::string session;
  std::string scene;
  std::vector<std::string> environments;
  int width = 0;
  int height = 0;
  Camera camera;
  bool any_view = false;                  // whether frames follow an edited view
  std::vector<VertexMaterial> materials;  // whose edits frames follow, as they were baked
  std::vector<CurveMaterial> editable;    // whose BRDFs are edited, as they were baked
  std::vector<std::string> measured;      // what they may load
  DesignState state;
  Revision revision;
  Author author = {};  // of the revision
  Present you = {};
  std::string resume = {};                  // resume token
  bool resumed = false;                     // by the one that the client came with
  std::optional<std::int64_t> missed = {};  // revisions since the one that the client had seen
  HistoryDepth history = {};                // of the client's user
  std::vector<SnapshotLabel> snapshots = {};
  std::vector<Present> present = {};
};

std::string write_welcome(const Welcome& welcome);
/// To the client whose edit became `revision`; the state is the session's after it.
std::string write_ack(std::string_view id, const Revision& revision, const DesignState& state,
                      const Author& author = {}, const HistoryDepth& history = {});
/// To the other clients of the session.
std::string write_state(const Revision& revision, const DesignState& state,
                        const Author& author = {});
/// What a file gets: {"format", "scene", "session", "revision", "state"}.
std::string write_export(const std::string& scene, const std::string& session,
                         const Revision& revision, const DesignState& state);
/// To all clients of the session, when one was uploaded: all that edits may name.
std::string write_environments(const std::vector<std::string>& names);
/// To all clients of the session, the last: it was deleted, and by whom.
std::string write_deleted(const Author& by);
/// What write_export() wrote, or any file with a state as it has it: held to the rules of edits.
/// Throws Error naming the field.
Import read_export(std::string_view text, const std::vector<std::string>& environments,
                   const KnownMaterials& materials);
std::string write_pong(std::string_view id);
/// An edge's answer to an Error; the connection goes on.
std::string write_error(const Error& error, const std::optional<std::string>& id);
/// A failure with no field of a message to blame.
std::string write_error(std::string_view reason);

/// The state as it stands in messages: {"rotation", "environment", "exposure", "view", "material"}.
nlohmann::json state_to_json(const DesignState& state);
/// Reads what state_to_json() wrote. Throws Error, naming the field.
DesignState read_state(const JsonReader& reader);

}  // namespace rimlight::server

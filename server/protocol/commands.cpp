#include "server/protocol/commands.h"

#include <type_traits>

#include "core/base/error.h"
#include "server/protocol/messages.h"

namespace rimlight::server {

std::optional<Command> command_of(const ClientMessage& message) {
  return std::visit(
      [](const auto& one) -> std::optional<Command> {
        if constexpr (std::is_constructible_v<Command, decltype(one)>) {
          return one;
        } else {
          return std::nullopt;
        }
      },
      message);
}

const std::string& id_of(const Command& command) {
  return std::visit([](const auto& one) -> const std::string& { return one.id; }, command);
}

void check_role(const DeleteSession&, Role role) {
  if (role < Role::owner) {
    throw Error("message: /type", "what only owners may do", "a token of an owner");
  }
}

void check_role(const Command& command, Role role) {
  const auto* const snapshot = std::get_if<SnapshotCommand>(&command);
  const bool replaces_all =
      std::holds_alternative<Import>(command) ||
      (snapshot != nullptr && snapshot->action != SnapshotCommand::Action::make);
  if (role < Role::editor) {
    throw Error("message: /type", "an edit", "none: this access token only lets you watch");
  }
  if (replaces_all && role < Role::owner) {
    throw Error("message: /type", "what only owners may do", "an edit, or a token of an owner");
  }
}

}  // namespace rimlight::server

#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "core/base/error.h"
#include "server/store/stored_session.h"

namespace rimlight::server {

/// What went wrong in a store: not the client's fault, and it may try again.
class StoreError : public Error {
 public:
  using Error::Error;
};

/// Keeps design sessions beyond the life of the server. Any thread.
class SessionStore {
 public:
  /// Told once whether the edit is durable: nothing when it is, else why it is surely not kept. On
  /// the store's own thread, which it must not hold up. Edits are answered in the order of
  /// append(). Where the store ends before it knows, it is not called.
  using Answer = std::function<void(const std::optional<StoreError>& refusal)>;

  virtual ~SessionStore() = default;

  /// Nothing when the session was never stored. Throws StoreError.
  virtual std::optional<StoredSession> load(const std::string& scene,
                                            const std::string& session) = 0;
  /// Takes the edit, to be stored after all that were taken before. Refused later (by `answer`)
  /// when the session is not at `before`: the edit that it was made on was refused itself. Throws
  /// StoreError, and takes nothing, when too many wait or the disk does not answer.
  virtual void append(StoredEdit edit, Answer answer) = 0;
  /// Deletes a session with all that belongs to it, after all edits that were taken before; one
  /// that is not there too. Answered as they are.
  virtual void remove(const std::string& scene, const std::string& session, Answer answer) = 0;
  /// Waits until all that were taken have been answered; false after `most`.
  [[nodiscard]] virtual bool drain(std::chrono::milliseconds most) = 0;
  /// Why new edits are not likely to be kept now, in words that tell a stranger nothing; nothing
  /// when they are. Does not wait for the disk.
  virtual std::optional<std::string> trouble() const { return std::nullopt; }
};

}  // namespace rimlight::server

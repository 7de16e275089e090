#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include "server/protocol/messages.h"
#include "server/session/client.h"
#include "server/store/session_store.h"

namespace rimlight::server {

/// An edit that is on its way to the disk, and what the session will be after it.
struct WaitingEdit {
  std::weak_ptr<Client> client;  // who is told
  std::string id;
  Revision revision;
  DesignState state;
};

/// The edits of one session that are not durable yet, in order: each is made on the state that the
/// one before leads to. When one is refused, those after it fall with it, and until they have,
/// none is taken: what they were made on never was. One thread at a time: the session's mutex.
class WaitingEdits {
 public:
  /// `store` must outlive it; `stored` is the session's revision there, number 0 for none.
  WaitingEdits(SessionStore& store, std::string scene, std::string session, Revision stored);

  bool empty() const { return edits_.empty(); }
  /// Applies the edit to the last that waits, or to `state` at `revision` when none does, and hands
  /// it to the store. Throws Error, and changes nothing, where apply_edit() and append() do.
  void add(const Edit& edit, const std::shared_ptr<Client>& client, const std::string& author,
           const DesignState& state, const Revision& revision, SessionStore::Answer answer);
  /// The oldest, which the store has answered: durable or refused.
  enum class Outcome { durable, refused };
  WaitingEdit take(Outcome outcome);

 private:
  SessionStore& store_;
  const std::string scene_, session_;
  Revision stored_;       // what the last that waits leads to in the store
  Revision durable_;      // what is there
  bool falling_ = false;  // one was refused, and those after it have not been yet
  std::deque<WaitingEdit> edits_;
};

}  // namespace rimlight::server

#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "server/protocol/messages.h"
#include "server/session/client.h"
#include "server/session/session_version.h"
#include "server/store/session_store.h"

namespace rimlight::server {

/// An edit that is on its way to the disk, and what the session will be after it.
struct WaitingEdit {
  std::weak_ptr<Client> client;  // who is told
  std::string id;
  SessionVersion version;
};

/// The edits of one session that are not durable yet, in order: each is made on the version that
/// the one before leads to. When one is refused, those after it fall with it, and until they have,
/// none is taken: what they were made on never was. One thread at a time: the session's mutex.
class WaitingEdits {
 public:
  /// `store` must outlive it; `stored` is the session's revision there, number 0 for none.
  WaitingEdits(SessionStore& store, std::string scene, std::string session, Revision stored);

  bool empty() const { return edits_.empty(); }
  /// What the next edit is made on: the last that waits, or `durable` when none does.
  const SessionVersion& newest(const SessionVersion& durable) const {
    return edits_.empty() ? durable : edits_.back().version;
  }
  /// Hands an edit to the store that leads from `base`, the newest, to its version. Throws Error,
  /// and changes nothing, where append() does, and while refused ones fall.
  void add(WaitingEdit edit, const SessionVersion& base, std::int64_t at_ms,
           SessionStore::Answer answer);
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

#include "server/session/waiting_edits.h"

#include <utility>

namespace rimlight::server {

WaitingEdits::WaitingEdits(SessionStore& store, std::string scene, std::string session,
                           Revision stored)
    : store_(store),
      scene_(std::move(scene)),
      session_(std::move(session)),
      stored_(stored),
      durable_(stored) {}

void WaitingEdits::add(WaitingEdit edit, const SessionVersion& base, std::int64_t at_ms,
                       SessionStore::Answer answer) {
  if (falling_) {
    throw StoreError("session " + quote(session_), "an edit before it that could not be stored",
                     "none: send it again");
  }
  StoredEdit row = stored_edit(base, edit.version, at_ms);
  row.scene = scene_;
  row.session = session_;
  row.before = stored_;
  // First, since it may find no memory: what the store has taken must have its place here.
  edits_.push_back(std::move(edit));
  try {
    store_.append(std::move(row), std::move(answer));
  } catch (...) {
    edits_.pop_back();
    throw;
  }
  stored_ = edits_.back().version.revision;
}

WaitingEdit WaitingEdits::take(Outcome outcome) {
  WaitingEdit edit = std::move(edits_.front());
  edits_.pop_front();
  if (outcome == Outcome::durable) {
    durable_ = edit.version.revision;
  } else {
    falling_ = true;
  }
  if (edits_.empty()) {
    falling_ = false;
    stored_ = durable_;
  }
  return edit;
}

}  // namespace rimlight::server

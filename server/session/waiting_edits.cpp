#include "server/session/waiting_edits.h"

#include <chrono>
#include <utility>

namespace rimlight::server {
namespace {

std::int64_t milliseconds_since_1970() {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(since_1970).count();
}

}  // namespace

WaitingEdits::WaitingEdits(SessionStore& store, std::string scene, std::string session,
                           Revision stored)
    : store_(store),
      scene_(std::move(scene)),
      session_(std::move(session)),
      stored_(stored),
      durable_(stored) {}

void WaitingEdits::add(const Edit& edit, const std::shared_ptr<Client>& client,
                       const std::string& author, const DesignState& state,
                       const Revision& revision, SessionStore::Answer answer) {
  if (falling_) {
    throw StoreError("session " + quote(session_), "an edit before it that could not be stored",
                     "none: send it again");
  }
  const DesignState& base = edits_.empty() ? state : edits_.back().state;
  WaitingEdit next{client, edit.id, edits_.empty() ? revision : edits_.back().revision, base};
  apply_edit(edit, next.state);
  ++next.revision.number;
  const nlohmann::json json = state_to_json(next.state);
  store_.append(
      {scene_, session_, stored_, next.revision, json.dump(),
       nlohmann::json::diff(state_to_json(base), json).dump(), author, milliseconds_since_1970()},
      std::move(answer));
  stored_ = next.revision;
  edits_.push_back(std::move(next));
}

WaitingEdit WaitingEdits::take(Outcome outcome) {
  WaitingEdit edit = std::move(edits_.front());
  edits_.pop_front();
  if (outcome == Outcome::durable) {
    durable_ = edit.revision;
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

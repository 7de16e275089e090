#include "server/session/edit_history.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"
#include "core/base/json_reader.h"

namespace rimlight::server {
namespace {

using nlohmann::json;

/// The step after more edits of its gesture. Where somebody else set a field in between, it goes
/// back to what that one set.
FieldChanges merged(FieldChanges step, const FieldChanges& more) {
  for (const auto& [field, change] : more) {
    const auto [found, is_new] = step.try_emplace(field, change);
    if (is_new) continue;
    if (found->second.after != change.before) found->second.before = change.before;
    found->second.after = change.after;
    if (found->second.before == found->second.after) step.erase(found);
  }
  return step;
}

/// Those that stand in the state as `from` has them.
FieldChanges standing(const EditStep& step, json FieldChange::*from, const json& state) {
  FieldChanges fields;
  for (const auto& [field, change] : step.fields) {
    if (field_of(state, field) == change.*from) fields.emplace(field, change);
  }
  return fields;
}

/// From which side of its changes a step goes to which.
struct Way {
  json FieldChange::*left;
  json FieldChange::*wanted;
};

/// Moves the newest step that can be moved, and sets its fields. False when there is none.
bool move(std::vector<EditStepPtr>& from, std::vector<EditStepPtr>& to, std::int64_t ordinal,
          const Way& way, const EditHistory::Possible& possible, json& state) {
  for (auto step = from.rbegin(); step != from.rend(); ++step) {
    FieldChanges fields = standing(**step, way.left, state);
    std::erase_if(fields, [&](const auto& entry) {
      return possible && !possible(entry.first, entry.second.*way.wanted);
    });
    if (fields.empty()) continue;
    for (const auto& [field, change] : fields) set_field(state, field, change.*way.wanted);
    to.push_back(make_step(ordinal, "", std::move(fields)));
    from.erase(std::next(step).base());
    return true;
  }
  return false;
}

}  // namespace

EditStepPtr make_step(std::int64_t ordinal, std::string gesture, FieldChanges fields) {
  auto step =
      std::make_shared<EditStep>(EditStep{ordinal, std::move(gesture), std::move(fields), 0});
  step->bytes = write_step(*step).size();
  return step;
}

std::string write_step(const EditStep& step) {
  json fields = json::object();
  for (const auto& [field, change] : step.fields) fields[field] = {change.before, change.after};
  return json{{"gesture", step.gesture}, {"fields", fields}}.dump(-1, ' ', false,
                                                                  json::error_handler_t::replace);
}

EditStepPtr read_step(std::string_view text, std::int64_t ordinal, const std::string& where) {
  const json document = parse_json(text, where);
  const JsonReader reader(document, where);
  FieldChanges fields;
  for (const auto& [field, change] : reader.member("fields").members()) {
    const auto values = change.elements(2, 2);
    if (!is_field(field)) change.fail("a change of a state's field");
    fields[field] = {values[0].value(), values[1].value()};
  }
  if (fields.empty()) reader.fail("a step of one or more fields");
  return make_step(ordinal, reader.member("gesture").string(), std::move(fields));
}

EditHistory::EditHistory(std::vector<EditStepPtr> done, std::vector<EditStepPtr> undone)
    : done_(std::move(done)), undone_(std::move(undone)) {}

void EditHistory::record(const FieldChanges& changes, const std::string& gesture) {
  if (changes.empty()) return;
  const bool goes_on =
      !gesture.empty() && undone_.empty() && !done_.empty() && done_.back()->gesture == gesture;
  undone_.clear();
  if (goes_on) {
    const EditStepPtr last = done_.back();
    done_.pop_back();
    FieldChanges both = merged(last->fields, changes);
    if (both.empty()) return;  // back where it began
    done_.push_back(make_step(last->ordinal, gesture, std::move(both)));
  } else {
    done_.push_back(make_step(next_ordinal(), gesture, changes));
  }
  drop_old();
}

bool EditHistory::undo(json& state, const Possible& possible) {
  const Way back{&FieldChange::after, &FieldChange::before};
  return move(done_, undone_, next_ordinal(), back, possible, state);
}

bool EditHistory::redo(json& state, const Possible& possible) {
  const Way forth{&FieldChange::before, &FieldChange::after};
  return move(undone_, done_, next_ordinal(), forth, possible, state);
}

std::int64_t EditHistory::next_ordinal() const {
  std::int64_t last = 0;
  if (!done_.empty()) last = done_.back()->ordinal;
  if (!undone_.empty()) last = std::max(last, undone_.back()->ordinal);
  return last + 1;
}

void EditHistory::drop_old() {
  std::size_t kept = 0, bytes = 0;
  for (auto step = done_.rbegin(); step != done_.rend() && kept < kMostSteps; ++step, ++kept) {
    bytes += (*step)->bytes;
    if (kept > 0 && bytes > kMostBytes) break;
  }
  done_.erase(done_.begin(), done_.end() - static_cast<std::ptrdiff_t>(kept));
}

}  // namespace rimlight::server

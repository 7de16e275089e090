#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "server/session/field_changes.h"

namespace rimlight::server {

/// One user's step: what is undone at once.
struct EditStep {
  std::int64_t ordinal = 0;  // of the user's, ascending in each of the history's two lists
  std::string gesture;       // edits of the same one go on with this step; empty: it has ended
  FieldChanges fields;       // not empty
  std::size_t bytes = 0;     // as it is written

  friend bool operator==(const EditStep&, const EditStep&) = default;
};
using EditStepPtr = std::shared_ptr<const EditStep>;

EditStepPtr make_step(std::int64_t ordinal, std::string gesture, FieldChanges fields);
/// {"gesture", "fields": {POINTER: [before, after]}}, without the ordinal.
std::string write_step(const EditStep& step);
/// Reads what write_step() wrote. Throws Error naming `where`.
EditStepPtr read_step(std::string_view text, std::int64_t ordinal, const std::string& where);

/// What one user has done to a session, to be undone and redone while others edit it too. A step
/// knows the fields that it set. Undoing sets back those that still are as it left them; the
/// others are somebody else's now, and no part of the step any more. So whatever came between,
/// what others set last stays. A value: copies share the steps.
class EditHistory {
 public:
  /// The oldest steps go first when there are more, or when they take more bytes; the last stays.
  static constexpr std::size_t kMostSteps = 100;
  static constexpr std::size_t kMostBytes = std::size_t{256} << 10;

  EditHistory() = default;
  /// As it was stored; both ascending by ordinal.
  EditHistory(std::vector<EditStepPtr> done, std::vector<EditStepPtr> undone);

  /// An edit of the user's own. One of the gesture of the last step goes on with that step, unless
  /// something was undone since. What was undone is forgotten. Changes of nothing are no step.
  void record(const FieldChanges& changes, const std::string& gesture);
  /// Whether a field can have a value: an environment may be gone. What cannot come back stays as
  /// it is, and is no part of a step any more.
  using Possible = std::function<bool(const std::string& field, const nlohmann::json& value)>;
  /// Takes back the newest step of which something still stands; steps of which nothing does stay
  /// where they are. False, and nothing changes, where there is none.
  [[nodiscard]] bool undo(nlohmann::json& state, const Possible& possible = {});
  /// The same for what was undone last.
  [[nodiscard]] bool redo(nlohmann::json& state, const Possible& possible = {});

  const std::vector<EditStepPtr>& done() const { return done_; }
  const std::vector<EditStepPtr>& undone() const { return undone_; }

 private:
  std::int64_t next_ordinal() const;
  void drop_old();

  std::vector<EditStepPtr> done_, undone_;
};

}  // namespace rimlight::server

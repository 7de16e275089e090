#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/basis/cube_haar.h"
#include "core/light/cube_light.h"
#include "core/relight/cost_model.h"
#include "core/relight/policy.h"
#include "core/relight/policy_settings.h"
#include "core/relight/recent_times.h"
#include "core/relight/relighter.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

/// How much one frame's update may cost. Budgets of coefficients or bytes promise the same bits for
/// the same frames; a deadline does not.
struct FrameBudget {
  enum class Unit : std::uint8_t { coefficients, bytes, milliseconds };
  Unit unit = Unit::coefficients;
  double amount = 30;
};

/// "30", "2MB" (10⁶ bytes), "16ms"; and back. Throws Error naming `where`.
FrameBudget parse_budget(const std::string& text, const std::string& where);
std::string budget_name(const FrameBudget& budget);

/// What a deadline leaves when other parts of the frame take so long; other budgets as they are.
FrameBudget reduce_deadline(const FrameBudget& budget, double taken_ms);

/// How one update came about.
struct UpdateReport {
  std::size_t columns = 0;        // added, by batch: two batches may add layers of one
  std::size_t bytes = 0;          // of M, read for them
  std::size_t bands_reset = 0;    // bands that started from zero, in all batches
  std::uint32_t reset_bands = 0;  // the same, a bit a band
  std::size_t tiles_rebuilt = 0;  // against drift
  double plan_ms = 0;
  double apply_ms = 0;
};

/// Moves a relighter's image towards a target, frame by frame, within a budget.
///
/// A deadline is kept by a cost model that learns from each frame what work takes, and by a look at
/// the clock between batches of columns: the first batch is planned for most of the time, what is
/// left is planned again, unless the policy starts from zero each time. Planning, and the tiles
/// that are rebuilt against drift, count by what they took lately. However short the time, at least
/// one column is applied while the light is not the target.
///
/// Allocates nothing after the first frames. One thread at a time; computes on all cores.
class FrameUpdater {
 public:
  /// Bake and relighter outlive it; the relighter is of the bake's transport.
  FrameUpdater(const Bake& bake, const CubeHaar& basis, const PolicySettings& policy,
               Relighter& relighter);

  UpdateReport update(const CubeLight& target, const FrameBudget& budget);

 private:
  /// What columns cost, and their layers by themselves.
  struct Costs {
    std::vector<std::uint32_t> column;  // [columns]
    std::vector<std::uint32_t> part;    // [parts]

    std::uint64_t of(const ColumnDelta& delta) const;
  };

  static Costs count_bytes(const Bake& bake);
  static Costs count_work(const Bake& bake);
  void plan(const CubeLight& target, const Budget& budget, const Costs& costs);
  /// Plans and applies one batch; whether it added anything. `costs`: what a budget of bytes
  /// counts.
  bool apply_batch(const CubeLight& target, const Budget& budget, const Costs& costs,
                   UpdateReport& report);
  void update_until(const CubeLight& target, double deadline_ms, UpdateReport& report);
  std::size_t band_image_bytes() const;
  /// What the cost model counts of the plan, and of the tiles that were rebuilt beside it.
  std::size_t work_done() const;

  const Bake& bake_;
  CubeHaar basis_;
  std::unique_ptr<const UpdatePolicy> policy_;
  bool keeps_nothing_;  // the policy starts from zero each time
  Relighter& relighter_;
  Costs bytes_;
  Costs work_;  // what the cost model counts
  std::size_t most_work_of_a_column_;
  double work_of_a_tile_ = 0;  // that is rebuilt
  double rebuilding_ = 0;      // work a batch, lately
  RecentTimes planning_;
  CostModel cost_;
  PlanWorkspace workspace_;
  UpdatePlan plan_;
};

}  // namespace rimlight

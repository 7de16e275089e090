#include "core/relight/plan_writer.h"

#include <bit>

namespace rimlight {
namespace {

ColumnDelta delta_of(const PlanRequest& request, BandAction action, std::size_t column) {
  const Vec3f target = request.target.at(column);
  return {static_cast<std::uint32_t>(column),
          action == BandAction::reset ? target : target - request.held.at(column)};
}

}  // namespace

std::size_t ColumnSet::size() const {
  std::size_t size = 0;
  for (const std::uint64_t word : words_) size += static_cast<std::size_t>(std::popcount(word));
  return size;
}

void write_plan(const PlanRequest& request, const std::vector<BandAction>& actions,
                const ColumnSet& columns, UpdatePlan& plan) {
  plan.bands.assign(actions.size(), {});
  plan.columns.clear();
  plan.columns.reserve(columns.size());
  std::size_t band = 0;
  std::size_t band_end = request.basis.band_begin(1);
  for (std::size_t word = 0; word < columns.words().size(); ++word) {
    for (std::uint64_t bits = columns.words()[word]; bits != 0; bits &= bits - 1) {
      const std::size_t column = 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
      for (; column >= band_end; ++band) {
        band_end = request.basis.band_begin(static_cast<int>(band) + 2);
      }
      plan.columns.push_back(delta_of(request, actions[band], column));
      ++plan.bands[band].count;
    }
  }
  std::size_t first = 0;
  for (band = 0; band < actions.size(); ++band) {
    BandUpdate& update = plan.bands[band];
    update.first = first;
    first += update.count;
    const bool nothing = actions[band] == BandAction::increment && update.count == 0;
    update.action = nothing ? BandAction::hold : actions[band];
  }
}

}  // namespace rimlight

#include "core/relight/band_dealer.h"

#include <algorithm>

namespace rimlight {

void BandDealer::Hand::clear(const CubeHaar& basis, int band) {
  const std::size_t most = basis.band_begin(band + 1) - basis.band_begin(band);
  columns.reserve(most);
  cost.reserve(most + 1);
  error.reserve(most + 1);
  columns.clear();
}

Alternative BandDealer::Band::best(std::size_t n) const {
  const Hand& increment = hands[static_cast<std::size_t>(Alternative::increment)];
  const Hand& reset = hands[static_cast<std::size_t>(Alternative::reset)];
  const double kept = increment.error_with(n), fresh = reset.error_with(n);
  if (kept != fresh) return kept < fresh ? Alternative::increment : Alternative::reset;
  return holds_nothing ? Alternative::reset : Alternative::increment;
}

double BandDealer::Band::error_with(std::size_t n) const {
  return std::min(hands[0].error_with(n), hands[1].error_with(n));
}

std::uint64_t BandDealer::Band::cost_with(std::size_t n) const {
  return hands[static_cast<std::size_t>(best(n))].cost_with(n);
}

bool BandDealer::Band::has_next() const {
  return dealt < hands[static_cast<std::size_t>(best(dealt))].size();
}

void BandDealer::pick_up(const PlanRequest& request, const RankedColumns& ranked,
                         const std::array<ColumnGains, 2>& gains) {
  bands_.resize(static_cast<std::size_t>(request.basis.band_count()));
  for (std::size_t b = 0; b < bands_.size(); ++b) {
    bands_[b].dealt = 0;
    bands_[b].open = true;
    bands_[b].holds_nothing = holds_nothing(request, static_cast<int>(b));
    for (Hand& hand : bands_[b].hands) hand.clear(request.basis, static_cast<int>(b));
  }
  for (const RankedColumns::Entry& entry : ranked.entries()) {
    const auto list = static_cast<std::size_t>(entry.list());
    bands_[list / 2].hands[list % 2].columns.push_back(entry.column());
  }
  const auto candidates = Candidates::columns(request.basis);
  const ColumnCosts costs(request, candidates);
  for (std::size_t list = 0; list < 2 * bands_.size(); ++list) {
    Hand& hand = bands_[list / 2].hands[list % 2];
    hand.cost.assign(hand.size() + 1, 0);
    hand.error.assign(hand.size() + 1, 0);
    hand.error.back() = ranked.gains_left_out(candidates, static_cast<int>(list / 2),
                                              static_cast<Alternative>(list % 2), gains[list % 2]);
    for (std::size_t n = 0; n < hand.size(); ++n) {
      hand.cost[n + 1] = hand.cost[n] + costs.of(hand.columns[n]);
    }
    for (std::size_t n = hand.size(); n-- > 0;) {
      hand.error[n] = hand.error[n + 1] + double{gains[list % 2].gain[hand.columns[n]]};
    }
  }
}

BandDealer::Band* BandDealer::next() {
  Band* best = nullptr;
  double most = 0;
  for (Band& band : bands_) {
    if (!band.open || !band.has_next()) continue;
    const double fall = band.error_with(band.dealt) - band.error_with(band.dealt + 1);
    if (best != nullptr && !(fall > most)) continue;
    best = &band;
    most = fall;
  }
  return best;
}

void BandDealer::run(const PlanRequest& request, const RankedColumns& ranked,
                     const std::array<ColumnGains, 2>& gains, std::vector<BandAction>& actions,
                     ColumnSet& columns) {
  pick_up(request, ranked, gains);
  const std::uint64_t budget = request.budget.amount;
  std::uint64_t spent = 0;
  while (Band* const band = next()) {
    const std::uint64_t others = spent - band->cost_with(band->dealt);
    const std::uint64_t whole = others + band->cost_with(band->dealt + 1);
    band->open = whole <= budget;
    if (!band->open) continue;
    ++band->dealt;
    spent = whole;
  }
  actions.clear();
  for (const Band& band : bands_) {
    const Alternative alternative = band.best(band.dealt);
    actions.push_back(alternative == Alternative::reset ? BandAction::reset
                                                        : BandAction::increment);
    const Hand& hand = band.hands[static_cast<std::size_t>(alternative)];
    for (std::size_t n = 0; n < std::min(band.dealt, hand.size()); ++n) {
      columns.insert(hand.columns[n]);
    }
  }
}

}  // namespace rimlight

#include "core/relight/reset_search.h"

#include <algorithm>
#include <limits>

namespace rimlight {
namespace {

/// What a column adds to the costs that combinations are compared by: nothing when it mends nothing
/// that is measured, since it comes last anyway and no band is reset to avoid it.
std::uint64_t cost_of(const RankedColumns::Entry& entry, const ColumnCosts& costs) {
  return entry.rank() > ColumnGains::kLastRank ? costs.of(entry.column()) : 0;
}

}  // namespace

const ResetAnswer& ResetSearch::run(const ResetQuestion& question) {
  sum_blocks(question);
  is_one_choice_ = question.request.one_image;
  if (is_one_choice_) {
    list_common_options(question);
  } else {
    list_options(question);
  }
  const auto bands = options_.size();
  answer_.actions.assign(bands, BandAction::increment);
  chosen_.assign(bands, 0);
  Outcome best{std::numeric_limits<double>::infinity(), 0};  // the first is affordable, and better
  do {
    const Combination combination = combine();
    if (combination.cost > question.request.budget.amount) continue;
    if (combination.error > best.error) continue;  // cleared too much already
    const Outcome outcome = this->outcome(question, combination);
    const bool better =
        outcome.error < best.error || (outcome.error == best.error && outcome.cost < best.cost);
    if (!better) continue;
    best = outcome;
    answer_.lists = combination.set;
    answer_.columns_budget = question.request.budget.amount - combination.cost;
    for (std::size_t b = 0; b < bands; ++b) {
      answer_.actions[b] = options_[b][static_cast<std::size_t>(chosen_[b])].action;
    }
  } while (next_combination());
  return answer_;
}

/// Forwards for the costs before each block, backwards for the gains behind it.
void ResetSearch::sum_blocks(const ResetQuestion& question) {
  const auto entries = question.ranked.entries();
  const ColumnCosts costs(question.request, question.candidates);
  const int bands = question.request.basis.band_count();
  lists_ = 2 * static_cast<std::size_t>(bands);
  blocks_ = (entries.size() + kBlock - 1) / kBlock;
  sums_.assign((blocks_ + 1) * lists_, {});
  for (std::size_t block = 0; block < blocks_; ++block) {
    Sums* const here = sums_.data() + block * lists_;
    for (std::size_t list = 0; list < lists_; ++list) {
      here[lists_ + list].cost_before = here[list].cost_before;
    }
    for (std::size_t i = block * kBlock; i < std::min((block + 1) * kBlock, entries.size()); ++i) {
      here[lists_ + static_cast<std::size_t>(entries[i].list())].cost_before +=
          cost_of(entries[i], costs);
    }
  }
  for (int band = 0; band < bands; ++band) {
    for (const auto alternative : {Alternative::increment, Alternative::reset}) {
      const auto list = static_cast<std::size_t>(RankedColumns::list_of(band, alternative));
      sums_[blocks_ * lists_ + list].gain_behind = question.ranked.gains_left_out(
          question.candidates, band, alternative, question.gains[list % 2]);
    }
  }
  for (std::size_t block = blocks_; block-- > 0;) {
    Sums* const here = sums_.data() + block * lists_;
    for (std::size_t list = 0; list < lists_; ++list) {
      here[list].gain_behind = here[lists_ + list].gain_behind;
    }
    for (std::size_t i = std::min((block + 1) * kBlock, entries.size()); i-- > block * kBlock;) {
      const auto list = static_cast<std::size_t>(entries[i].list());
      here[list].gain_behind += double{question.gains[list % 2].gain[entries[i].column()]};
    }
  }
}

void ResetSearch::list_options(const ResetQuestion& question) {
  const auto bands = static_cast<std::size_t>(question.request.basis.band_count());
  options_.resize(bands);
  option_count_.assign(bands, 0);
  for (std::size_t b = 0; b < bands; ++b) {
    const int band = static_cast<int>(b);
    const auto add = [&](const Option& option) {
      options_[b][static_cast<std::size_t>(option_count_[b]++)] = option;
    };
    const int increments = RankedColumns::list_of(band, Alternative::increment);
    const int resets = RankedColumns::list_of(band, Alternative::reset);
    const bool nothing = holds_nothing(question.request, band);
    if (!nothing) add({increments, BandAction::increment, 0, 0});
    add({resets, BandAction::reset, nothing ? 0 : question.reset_cost, 0});
    if (!nothing && question.reset_cost > 0) {
      const double all = sums_[static_cast<std::size_t>(resets)].gain_behind;
      add({kNoList, BandAction::reset, 0, all});
    }
  }
}

/// All bands incremented, or all reset, at the cost of one image; only the latter, for nothing,
/// when the image is black.
void ResetSearch::list_common_options(const ResetQuestion& question) {
  const int bands = question.request.basis.band_count();
  bool nothing = true;
  for (int band = 0; band < bands; ++band)
    nothing = nothing && holds_nothing(question.request, band);
  options_.resize(static_cast<std::size_t>(bands));
  option_count_.assign(options_.size(), nothing ? 1 : 2);
  for (int band = 0; band < bands; ++band) {
    const Option increment{RankedColumns::list_of(band, Alternative::increment),
                           BandAction::increment, 0, 0};
    const Option reset{RankedColumns::list_of(band, Alternative::reset), BandAction::reset,
                       nothing || band > 0 ? 0 : question.reset_cost, 0};
    auto& options = options_[static_cast<std::size_t>(band)];
    options[0] = nothing ? reset : increment;
    options[1] = reset;
  }
}

ResetSearch::Combination ResetSearch::combine() const {
  Combination result;
  for (std::size_t b = 0; b < options_.size(); ++b) {
    const Option& option = options_[b][static_cast<std::size_t>(chosen_[b])];
    result.cost += option.cost;
    result.error += option.error;
    if (option.list == kNoList) continue;
    result.lists[static_cast<std::size_t>(result.list_count++)] = option.list;
    result.set |= ListSet{1} << option.list;
  }
  return result;
}

/// Counts in digits of as many values as each band has options, the first band's slowest.
bool ResetSearch::next_combination() {
  if (is_one_choice_) {
    for (int& choice : chosen_) ++choice;
    return chosen_[0] < option_count_[0];
  }
  for (std::size_t b = options_.size(); b-- > 0;) {
    if (++chosen_[b] < option_count_[b]) return true;
    chosen_[b] = 0;
  }
  return false;
}

std::uint64_t ResetSearch::cost_before(const Combination& combination, std::size_t block) const {
  std::uint64_t cost = 0;
  for (int k = 0; k < combination.list_count; ++k) {
    const auto list = static_cast<std::size_t>(combination.lists[static_cast<std::size_t>(k)]);
    cost += sums_[block * lists_ + list].cost_before;
  }
  return cost;
}

ResetSearch::Outcome ResetSearch::outcome(const ResetQuestion& question,
                                          const Combination& combination) const {
  const auto entries = question.ranked.entries();
  const ColumnCosts costs(question.request, question.candidates);
  const std::uint64_t budget = question.request.budget.amount - combination.cost;
  // The last block that the budget reaches with all before it: everything there was applied.
  std::size_t block = 0, beyond = blocks_ + 1;
  while (block + 1 < beyond) {
    const std::size_t middle = (block + beyond) / 2;
    (cost_before(combination, middle) <= budget ? block : beyond) = middle;
  }
  BudgetWalk walk(budget - cost_before(combination, block));
  double error = combination.error;
  std::size_t i = block * kBlock;
  for (; i < entries.size() && !(walk.done() && i % kBlock == 0); ++i) {
    const auto list = static_cast<std::size_t>(entries[i].list());
    if ((combination.set >> list & 1) == 0) continue;
    const std::size_t column = entries[i].column();
    if (!walk.done() && walk.takes(cost_of(entries[i], costs))) continue;
    error += double{question.gains[list % 2].gain[column]};
  }
  const std::size_t behind = (i + kBlock - 1) / kBlock;
  for (int k = 0; k < combination.list_count; ++k) {
    const auto list = static_cast<std::size_t>(combination.lists[static_cast<std::size_t>(k)]);
    error += sums_[behind * lists_ + list].gain_behind;
  }
  return {error, question.request.budget.amount - walk.left()};
}

}  // namespace rimlight

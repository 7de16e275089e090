#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/relight/ranked_columns.h"

namespace rimlight {

/// What a search for the bands to reset is given.
struct ResetQuestion {
  const PlanRequest& request;
  const Candidates& candidates;
  const RankedColumns& ranked;              // both lists of each band, sorted
  const std::array<ColumnGains, 2>& gains;  // [Alternative]
  std::uint64_t reset_cost;                 // of a band that holds something
};

/// What it answers.
struct ResetAnswer {
  std::vector<BandAction> actions;   // [bands], increment or reset
  ListSet lists = 0;                 // to take columns from; a band without a list is cleared
  std::uint64_t columns_budget = 0;  // what the resets leave of the budget
};

/// Finds, by trying all combinations, which bands to reset so that the least error is left once the
/// best columns have spent the budget. A band is incremented; reset; or, where a reset costs
/// something, cleared: reset without columns, which costs nothing. A band that holds nothing is
/// reset for nothing. Of equal errors the cheaper combination is taken, of equal costs the one that
/// keeps the first band where they differ.
///
/// The columns of all lists are in one order already. Sums of costs and gains for each list, before
/// and behind every 64th column, find by bisection where a combination's budget ends, and a walk of
/// some columns from there gives its error: it is the plan's own, passed-over columns included.
/// 2^bands or 3^bands combinations take some tenths of a microsecond each, and those that clear too
/// much nearly nothing.
class ResetSearch {
 public:
  const ResetAnswer& run(const ResetQuestion& question);

 private:
  /// One way to treat a band; those that keep more come first.
  struct Option {
    int list;  // kNoList when cleared
    BandAction action;
    std::uint64_t cost;
    double error;  // when cleared
  };
  /// Sums over one list at the beginning of a block of columns.
  struct Sums {
    std::uint64_t cost_before = 0;
    double gain_behind = 0;  // of what has not been applied yet
  };
  /// What comes of a combination.
  struct Outcome {
    double error;
    std::uint64_t cost;
  };
  /// A combination: the lists that it takes, and what its resets cost.
  struct Combination {
    std::array<int, RankedColumns::kMostLists> lists;
    int list_count = 0;
    ListSet set = 0;
    std::uint64_t cost = 0;
    double error = 0;
  };
  static constexpr std::size_t kBlock = 64;
  static constexpr int kNoList = -1;

  void sum_blocks(const ResetQuestion& question);
  void list_options(const ResetQuestion& question);
  void list_common_options(const ResetQuestion& question);
  Combination combine() const;
  bool next_combination();
  std::uint64_t cost_before(const Combination& combination, std::size_t block) const;
  Outcome outcome(const ResetQuestion& question, const Combination& combination) const;

  std::vector<std::array<Option, 3>> options_;  // [band], the first option_count_
  std::vector<int> option_count_;
  std::vector<int> chosen_;     // [band] of its options
  bool is_one_choice_ = false;  // the same for all bands
  std::vector<Sums> sums_;      // [block][list]
  std::size_t blocks_ = 0;
  std::size_t lists_ = 0;
  ResetAnswer answer_;
};

}  // namespace rimlight

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/relight/column_gains.h"
#include "core/relight/plan_writer.h"

namespace rimlight {

/// The columns that a budget could reach, of several lists, in one order: best first.
///
/// A list is a band under one alternative; an update takes at most one list of each band. What a
/// list keeps are its best columns, until they alone cost the budget or more: no update reaches
/// further down in it. So a budget of 30 out of 24,576 sorts some hundreds.
class RankedColumns {
 public:
  /// A column in a list: sorts by rank.
  class Entry {
   public:
    Entry() = default;
    Entry(std::uint32_t rank, std::size_t column, int list)
        : key_(std::uint64_t{rank} << 32 | column << kListBits | static_cast<unsigned>(list)) {}
    std::uint32_t rank() const { return static_cast<std::uint32_t>(key_ >> 32); }
    std::size_t column() const { return static_cast<std::uint32_t>(key_) >> kListBits; }
    int list() const { return static_cast<int>(key_ & (kMostLists - 1)); }

   private:
    std::uint64_t key_ = 0;
  };

  static constexpr unsigned kListBits = 5;
  static constexpr int kMostLists = 1 << kListBits;
  static constexpr std::size_t kMostColumns = std::size_t{1} << (32 - kListBits);

  static int list_of(int band, Alternative alternative) {
    return 2 * band + static_cast<int>(alternative);
  }

  /// No lists.
  void clear();
  /// Adds a list; lists ascend.
  void add(const Candidates& candidates, int band, Alternative alternative,
           const ColumnGains& gains, const ColumnCosts& costs);
  /// Best first; of equals those of lower lists, and in a list of lower index, first.
  void sort();

  std::span<const Entry> entries() const { return {entries_.data(), count_}; }
  /// Σ of gains of a list's columns that are not among the entries; 0 exactly when all are.
  double gains_left_out(const Candidates& candidates, int band, Alternative alternative,
                        const ColumnGains& gains) const;

 private:
  std::vector<Entry> entries_;  // the first count_
  std::vector<Entry> scratch_;
  std::vector<std::uint64_t> bucket_costs_;
  std::vector<std::uint32_t> first_of_digit_;
  std::array<std::uint32_t, kMostLists> lowest_rank_ = {};  // that a list keeps
  std::size_t count_ = 0;
};

/// A set of lists: bit `list`.
using ListSet = std::uint32_t;

/// Spends a budget on columns that come best first.
class BudgetWalk {
 public:
  /// A column that does not fit is passed over, so that a large one does not waste what is left;
  /// but only so many times, which bounds the time.
  static constexpr int kMostPassedOver = 16;

  explicit BudgetWalk(std::uint64_t budget) : left_(budget) {}
  bool done() const { return left_ == 0 || passed_over_ == kMostPassedOver; }
  /// Whether a column of that cost is applied.
  bool takes(std::uint64_t cost) {
    if (cost > left_) {
      ++passed_over_;
      return false;
    }
    left_ -= cost;
    return true;
  }
  std::uint64_t left() const { return left_; }

 private:
  std::uint64_t left_;
  int passed_over_ = 0;
};

/// The best columns of the lists, each taken as long as it fits.
void take_best(const RankedColumns& ranked, ListSet lists, const ColumnCosts& costs,
               BudgetWalk walk, ColumnSet& columns);

}  // namespace rimlight

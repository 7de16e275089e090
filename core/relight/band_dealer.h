#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/relight/ranked_columns.h"

namespace rimlight {

/// Deals columns to bands one by one, and finds on the way how each band is best treated (Overbeck
/// 2006, §6.2.3; see PbiPolicy in policies.h).
class BandDealer {
 public:
  /// Fills the actions [bands] and the columns dealt. A band whose next column no longer fits the
  /// budget is dealt no more.
  void run(const PlanRequest& request, const RankedColumns& ranked,
           const std::array<ColumnGains, 2>& gains, std::vector<BandAction>& actions,
           ColumnSet& columns);

 private:
  /// One list, best first, with what the first n columns cost and leave.
  struct Hand {
    std::vector<std::size_t> columns;
    std::vector<std::uint64_t> cost;  // [columns + 1]
    std::vector<double> error;        // [columns + 1]

    void clear(const CubeHaar& basis, int band);
    std::size_t size() const { return columns.size(); }
    double error_with(std::size_t n) const { return error[std::min(n, size())]; }
    std::uint64_t cost_with(std::size_t n) const { return cost[std::min(n, size())]; }
  };
  /// One band: its two hands, and how many columns it has been dealt.
  struct Band {
    std::array<Hand, 2> hands;  // [Alternative]
    std::size_t dealt = 0;
    bool open = true;
    bool holds_nothing = false;

    Alternative best(std::size_t n) const;
    double error_with(std::size_t n) const;
    std::uint64_t cost_with(std::size_t n) const;
    /// Whether there is a column to come.
    bool has_next() const;
  };

  void pick_up(const PlanRequest& request, const RankedColumns& ranked,
               const std::array<ColumnGains, 2>& gains);
  /// The open band whose error falls most with one column more; null when all are closed.
  Band* next();

  std::vector<Band> bands_;
};

}  // namespace rimlight

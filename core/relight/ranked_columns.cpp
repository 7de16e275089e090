#include "core/relight/ranked_columns.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/base/check.h"

namespace rimlight {
namespace {

// Ranks in buckets by their highest bits: sign (always 0), exponent, three bits of the fraction.
constexpr unsigned kBucketShift = 20;
constexpr std::size_t kBuckets = std::size_t{1} << (31 - kBucketShift);

/// The lowest rank that a list of these columns keeps.
std::uint32_t lowest_rank(std::span<const std::uint32_t> ranks, std::size_t first,
                          const ColumnCosts& costs, std::vector<std::uint64_t>& bucket_costs) {
  bucket_costs.assign(kBuckets, 0);
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    bucket_costs[ranks[i] >> kBucketShift] += costs.of(first + i);
  }
  std::uint64_t cost = 0;
  for (std::size_t bucket = kBuckets; bucket-- > 1;) {
    cost += bucket_costs[bucket];
    if (cost >= costs.budget()) return static_cast<std::uint32_t>(bucket << kBucketShift);
  }
  return 1;
}

// Ranks in three digits, for sorting from large to small.
constexpr unsigned kDigitBits = 11;
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
constexpr std::array<unsigned, 3> kShifts = {0, kDigitBits, 2 * kDigitBits};

std::size_t digit_of(const RankedColumns::Entry& entry, unsigned shift) {
  return kDigits - 1 - ((entry.rank() >> shift) & (kDigits - 1));
}

}  // namespace

void RankedColumns::clear() { count_ = 0; }

void RankedColumns::add(const Candidates& candidates, int band, Alternative alternative,
                        const ColumnGains& gains, const ColumnCosts& costs) {
  RIMLIGHT_CHECK(candidates.count() <= kMostColumns);
  const int list = list_of(band, alternative);
  RIMLIGHT_CHECK(list < kMostLists);
  const std::size_t begin = candidates.band_begin(band);
  const std::size_t size = candidates.band_begin(band + 1) - begin;
  const auto ranks = std::span(gains.rank).subspan(begin, size);
  const std::uint32_t lowest = lowest_rank(ranks, begin, costs, bucket_costs_);
  lowest_rank_[static_cast<std::size_t>(list)] = lowest;
  entries_.resize(2 * candidates.count() + 1);  // all there can be, and one to write beyond
  for (std::size_t i = 0; i < size; ++i) {
    entries_[count_] = Entry(ranks[i], begin + i, list);
    count_ += ranks[i] >= lowest;
  }
}

/// A stable radix sort, from the lowest digit to the highest.
void RankedColumns::sort() {
  scratch_.resize(entries_.size());
  first_of_digit_.assign(kShifts.size() * kDigits, 0);
  for (const Entry& entry : entries()) {
    for (std::size_t k = 0; k < kShifts.size(); ++k) {
      ++first_of_digit_[k * kDigits + digit_of(entry, kShifts[k])];
    }
  }
  for (std::size_t k = 0; k < kShifts.size(); ++k) {
    std::uint32_t* const next = first_of_digit_.data() + k * kDigits;
    std::exclusive_scan(next, next + kDigits, next, 0u);
    for (const Entry& entry : entries()) scratch_[next[digit_of(entry, kShifts[k])]++] = entry;
    std::swap(entries_, scratch_);
  }
}

double RankedColumns::gains_left_out(const Candidates& candidates, int band,
                                     Alternative alternative, const ColumnGains& gains) const {
  const std::uint32_t lowest = lowest_rank_[static_cast<std::size_t>(list_of(band, alternative))];
  const auto gain = [&](std::size_t i) {
    return gains.rank[i] < lowest ? double{gains.gain[i]} : 0.0;
  };
  const std::size_t end = candidates.band_begin(band + 1);
  double sums[4] = {};  // side by side, which the compiler may put into one vector
  std::size_t i = candidates.band_begin(band);
  for (; i + 4 <= end; i += 4) {
    for (std::size_t k = 0; k < 4; ++k) sums[k] += gain(i + k);
  }
  for (; i < end; ++i) sums[0] += gain(i);
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

void take_best(const RankedColumns& ranked, ListSet lists, const ColumnCosts& costs,
               BudgetWalk walk, ColumnSet& columns) {
  for (const RankedColumns::Entry& entry : ranked.entries()) {
    if (walk.done()) return;
    if ((lists >> entry.list() & 1) == 0) continue;
    if (walk.takes(costs.of(entry.column()))) columns.insert(entry.column());
  }
}

}  // namespace rimlight

#include "tests/support/reference/policies.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace rimlight::reference {
namespace {

Vec3d delta_of(const PlanRequest& request, std::size_t column, bool reset) {
  const Vec3d target(request.target.at(column));
  return reset ? target : target - Vec3d(request.held.layer(0).at(column));
}

std::size_t band_count(const PlanRequest& request) {
  return static_cast<std::size_t>(request.basis.band_count());
}

bool resets(const PlanRequest& request, const std::vector<bool>& reset, std::size_t column) {
  return reset[static_cast<std::size_t>(request.basis.band_of(column))];
}

bool in_bytes(const PlanRequest& request) { return request.budget.unit == Budget::Unit::bytes; }

bool holds_something(const PlanRequest& request, std::size_t band) {
  for (std::size_t i = 0; i < request.held.count(); ++i) {
    if (request.basis.band_of(i) == static_cast<int>(band) &&
        request.held.layer(0).at(i) != Vec3f{}) {
      return true;
    }
  }
  return false;
}

/// The `count` best columns of one band, best first.
std::vector<std::size_t> best_of_band(const PlanRequest& request, std::size_t band, bool reset,
                                      std::size_t count, const Measure& measure) {
  std::vector<std::tuple<double, std::size_t>> order;
  for (std::size_t i = 0; i < request.target.count(); ++i) {
    if (request.basis.band_of(i) != static_cast<int>(band)) continue;
    const Vec3d delta = delta_of(request, i, reset);
    if (delta != Vec3d{}) order.emplace_back(-measure(i, delta), i);
  }
  std::ranges::sort(order);
  std::vector<std::size_t> columns;
  for (const auto& [size, column] : order) {
    if (columns.size() < count) columns.push_back(column);
  }
  return columns;
}

double error_of_band(const PlanRequest& request, std::size_t band, bool reset,
                     const std::vector<std::size_t>& applied, const Measure& measure) {
  double error = 0;
  for (std::size_t i = 0; i < request.target.count(); ++i) {
    if (request.basis.band_of(i) != static_cast<int>(band)) continue;
    if (std::ranges::count(applied, i) == 0) error += measure(i, delta_of(request, i, reset));
  }
  return error;
}

/// How many of its columns mend something that is measured.
std::ptrdiff_t mending_columns(const PlanRequest& request, const Choice& choice,
                               const Measure& measure) {
  return std::ranges::count_if(choice.columns, [&](std::size_t i) {
    return measure(i, delta_of(request, i, resets(request, choice.reset, i))) > 0;
  });
}

/// One band's better alternative with `count` columns.
struct Hand {
  double error = 0;
  bool reset = false;
  std::vector<std::size_t> columns;
  bool ends = false;  // no further column is left in it
};

Hand best_hand(const PlanRequest& request, std::size_t band, std::size_t count,
               const Measure& measure) {
  const auto hand = [&](bool reset) {
    Hand result;
    result.reset = reset;
    result.columns = best_of_band(request, band, reset, count, measure);
    result.error = error_of_band(request, band, reset, result.columns, measure);
    result.ends = best_of_band(request, band, reset, SIZE_MAX, measure).size() <= count;
    return result;
  };
  const Hand kept = hand(false), fresh = hand(true);
  if (kept.error != fresh.error) return kept.error < fresh.error ? kept : fresh;
  return holds_something(request, band) ? kept : fresh;
}

}  // namespace

Measure size_measure(const PlanRequest& request, Selection selection) {
  return [&request, selection](std::size_t column, const Vec3d& delta) {
    double size = 0;
    for (int c = 0; c < 3; ++c) {
      double weight = 1;
      if (selection == Selection::area) {
        weight = std::sqrt(request.basis.band_area(request.basis.band_of(column)));
      } else if (selection == Selection::transport) {
        weight = std::sqrt(double{
            request.column_norm_squared[static_cast<std::size_t>(c) * request.target.count() +
                                        column]});
      }
      size += weight * std::abs(delta[c]);
    }
    return size;
  };
}

Measure energy_measure(const PlanRequest& request) {
  return [&request](std::size_t column, const Vec3d& delta) {
    double energy = 0;
    for (int c = 0; c < 3; ++c) {
      const std::size_t at = static_cast<std::size_t>(c) * request.target.count() + column;
      energy += double{request.column_norm_squared[at]} * delta[c] * delta[c];
    }
    return energy;
  };
}

Choice choice_of(const PlanRequest& request, const UpdatePlan& plan, const Measure& measure) {
  Choice choice;
  for (const BandUpdate& band : plan.bands)
    choice.reset.push_back(band.action == BandAction::reset);
  for (const ColumnDelta& column : plan.columns) choice.columns.push_back(column.column);
  choice.error = error_of(request, choice, measure);
  return choice;
}

double error_of(const PlanRequest& request, const Choice& choice, const Measure& measure) {
  double error = 0;
  for (std::size_t i = 0; i < request.target.count(); ++i) {
    if (std::ranges::binary_search(choice.columns, i)) continue;
    error += measure(i, delta_of(request, i, resets(request, choice.reset, i)));
  }
  return error;
}

std::size_t cost_of(const PlanRequest& request, const Choice& choice) {
  if (!in_bytes(request)) return choice.columns.size();
  std::size_t cost = 0;
  std::vector<bool> gets_columns(band_count(request));
  for (const std::size_t column : choice.columns) {
    cost += request.column_bytes[column];
    gets_columns[static_cast<std::size_t>(request.basis.band_of(column))] = true;
  }
  for (std::size_t b = 0; b < choice.reset.size(); ++b) {
    if (choice.reset[b] && gets_columns[b] && holds_something(request, b)) {
      cost += request.band_image_bytes;
    }
  }
  return cost;
}

Choice best_columns(const PlanRequest& request, const std::vector<bool>& reset,
                    const Measure& measure, Order order) {
  std::vector<std::tuple<float, std::size_t>> ranks;
  for (std::size_t i = 0; i < request.target.count(); ++i) {
    const Vec3d delta = delta_of(request, i, resets(request, reset, i));
    if (delta == Vec3d{}) continue;
    auto rank = static_cast<float>(measure(i, delta));
    if (order == Order::per_byte && in_bytes(request)) {
      rank /= static_cast<float>(request.column_bytes[i]);
    }
    ranks.emplace_back(-rank, i);
  }
  std::ranges::sort(ranks);
  std::size_t left = request.budget.amount;
  Choice choice{reset, {}, 0};
  for (std::size_t b = 0; b < reset.size() && in_bytes(request); ++b) {
    if (reset[b] && holds_something(request, b)) {
      left -= std::min(left, request.band_image_bytes);
    }
  }
  for (const auto& [rank, column] : ranks) {
    const std::size_t cost = in_bytes(request) ? request.column_bytes[column] : 1;
    if (cost > left) break;
    left -= cost;
    choice.columns.push_back(column);
  }
  std::ranges::sort(choice.columns);
  choice.error = error_of(request, choice, measure);
  return choice;
}

Choice exhaustive(const PlanRequest& request, const Measure& measure) {
  Choice best;
  best.error = std::numeric_limits<double>::infinity();
  const std::size_t bands = band_count(request);
  for (unsigned resets_of = 0; resets_of < 1u << bands; ++resets_of) {  // the first band's slowest
    std::vector<bool> reset(bands);
    for (std::size_t b = 0; b < bands; ++b) {
      reset[b] = (resets_of >> (bands - 1 - b) & 1) != 0 || !holds_something(request, b);
    }
    const Choice choice = best_columns(request, reset, measure, Order::by_measure);
    const bool better = choice.error < best.error ||
                        (choice.error == best.error && mending_columns(request, choice, measure) <
                                                           mending_columns(request, best, measure));
    if (better) best = choice;
  }
  return best;
}

Choice dealer(const PlanRequest& request, const Measure& measure) {
  const std::size_t bands = band_count(request);
  std::vector<std::size_t> dealt(bands);
  for (std::size_t k = 0; k < request.budget.amount; ++k) {
    std::size_t best = bands;
    double most = -1;
    for (std::size_t b = 0; b < bands; ++b) {
      const Hand now = best_hand(request, b, dealt[b], measure);
      if (now.ends) continue;
      const double fall = now.error - best_hand(request, b, dealt[b] + 1, measure).error;
      if (fall > most) {
        most = fall;
        best = b;
      }
    }
    if (best == bands) break;
    ++dealt[best];
  }
  Choice choice;
  for (std::size_t b = 0; b < bands; ++b) {
    const Hand hand = best_hand(request, b, dealt[b], measure);
    choice.reset.push_back(hand.reset);
    choice.columns.insert(choice.columns.end(), hand.columns.begin(), hand.columns.end());
  }
  std::ranges::sort(choice.columns);
  choice.error = error_of(request, choice, measure);
  return choice;
}

double least_error(const PlanRequest& request, const Measure& measure) {
  std::vector<std::size_t> active;  // the others add nothing
  for (std::size_t i = 0; i < request.target.count(); ++i) {
    if (request.target.at(i) != Vec3f{} || request.held.layer(0).at(i) != Vec3f{})
      active.push_back(i);
  }
  double least = std::numeric_limits<double>::infinity();
  for (unsigned resets_of = 0; resets_of < 1u << band_count(request); ++resets_of) {
    std::vector<bool> reset;
    for (std::size_t b = 0; b < band_count(request); ++b) {
      reset.push_back((resets_of >> b & 1) != 0);
    }
    for (unsigned subset = 0; subset < 1u << active.size(); ++subset) {
      Choice choice{reset, {}, 0};
      for (std::size_t k = 0; k < active.size(); ++k) {
        const std::size_t i = active[k];
        if ((subset >> k & 1) != 0) {
          choice.columns.push_back(i);
        } else {
          choice.error += measure(i, delta_of(request, i, resets(request, reset, i)));
        }
      }
      if (choice.error < least && cost_of(request, choice) <= request.budget.amount) {
        least = choice.error;
      }
    }
  }
  return least;
}

}  // namespace rimlight::reference

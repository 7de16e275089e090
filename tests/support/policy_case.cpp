#include "tests/support/policy_case.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/math/random.h"
#include "core/relight/policy_settings.h"

namespace rimlight::test {
namespace {

/// Coefficients that fall off with the band, some zero.
CubeLight random_light(const CubeHaar& haar, const PolicyCaseSettings& settings, Random& random) {
  CubeLight light(haar.size());
  for (std::size_t i = 0; i < light.count(); ++i) {
    const double size = 1.0 / (1 + haar.band_of(i));
    const bool zero = random.uniform() < settings.zero_share;
    for (int c = 0; c < 3; ++c) {
      light.channel(c)[i] = zero ? 0 : static_cast<float>(random.uniform(-size, size));
    }
  }
  return light;
}

/// Takes each band of `light` a random way towards `to`, here and there all of it.
void approach(const CubeHaar& haar, const CubeLight& to, Random& random, CubeLight& light) {
  for (int band = 0; band < haar.band_count(); ++band) {
    const auto way = static_cast<float>(std::min(1.0, random.uniform(0, 1.1)));
    for (std::size_t i = haar.band_begin(band); i < haar.band_begin(band + 1); ++i) {
      for (int c = 0; c < 3; ++c) {
        float& value = light.channel(c)[i];
        value = way * to.channel(c)[i] + (1 - way) * value;
      }
    }
  }
}

/// All columns but a random few become dark in every respect.
void leave_active(std::size_t count, Random& random, PolicyCase& problem) {
  const std::size_t columns = problem.haar.coefficient_count();
  std::vector<std::size_t> order(columns);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = columns; i-- > 1;) std::swap(order[i], order[random.below(i + 1)]);
  for (std::size_t k = std::min(count, columns); k < columns; ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      problem.target.values[c * columns + order[k]] = 0;
      problem.held.values[c * columns + order[k]] = 0;
      problem.norm_squared[c * columns + order[k]] = 0;
    }
  }
}

}  // namespace

PolicyCase::PolicyCase(const PolicyCaseSettings& settings) : haar(settings.size) {
  Random random(settings.seed);
  target = random_light(haar, settings, random);
  held = random_light(haar, settings, random);
  approach(haar, target, random, held);
  norm_squared.resize(3 * haar.coefficient_count());
  for (float& norm : norm_squared) {
    norm = static_cast<float>(random.uniform(0, 2));
    if (settings.quantum > 0) norm = std::round(4 * norm) / 4;
    norm *= norm;
  }
  for (std::size_t i = 0; i < haar.coefficient_count(); ++i) {
    bytes.push_back(static_cast<std::uint32_t>(1 + random.below(40)));
  }
  leave_active(settings.active_columns, random, *this);
  if (settings.quantum == 0) return;
  for (CubeLight* const light : {&target, &held}) {
    for (float& value : light->values) {
      value = std::round(value / settings.quantum) * settings.quantum;
    }
  }
}

void PolicyCase::leave_unseen(std::size_t begin, std::size_t end) {
  for (std::size_t c = 0; c < 3; ++c) {
    std::ranges::fill(std::span(norm_squared).subspan(c * bytes.size() + begin, end - begin), 0.0f);
  }
}

UpdatePlan plan_of(const UpdatePolicy& policy, const PlanRequest& request) {
  PlanWorkspace workspace;
  UpdatePlan plan;
  policy.make_plan(request, workspace, plan);
  return plan;
}

UpdatePlan plan_of(const char* policy, const PlanRequest& request) {
  return plan_of(*make_policy(parse_policy(policy, "plan_of")), request);
}

std::vector<std::string> every_policy() {
  std::vector<std::string> names = {"linear", "benefit"};
  for (const std::string selection : {"unweighted", "area", "transport"}) {
    for (const std::string kind :
         {"nwa:", "bi:", "pbi:simple:", "pbi:dealer:", "pbi:exhaustive:"}) {
      names.push_back(kind + selection);
    }
  }
  return names;
}

void apply(const UpdatePlan& plan, const CubeHaar& haar, const CubeLight& target, CubeLight& held) {
  for (std::size_t b = 0; b < plan.bands.size(); ++b) {
    if (plan.bands[b].action != BandAction::reset) continue;
    const std::size_t begin = haar.band_begin(static_cast<int>(b));
    const std::size_t end = haar.band_begin(static_cast<int>(b) + 1);
    for (int c = 0; c < 3; ++c) std::ranges::fill(held.channel(c).subspan(begin, end - begin), 0);
  }
  for (const ColumnDelta& column : plan.columns) {
    for (int c = 0; c < 3; ++c) held.channel(c)[column.column] = target.channel(c)[column.column];
  }
}

}  // namespace rimlight::test

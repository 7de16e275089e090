// Budgets of nothing, of one, of everything: every policy.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/bake/image_bake.h"
#include "core/math/random.h"
#include "core/relight/frame_update.h"
#include "core/relight/policy_settings.h"
#include "core/relight/relighter.h"
#include "core/report/stability/cases.h"
#include "core/report/stability/random_tiles.h"
#include "core/report/stability/small_scenes.h"
#include "core/transport/bake_folder.h"

namespace rimlight::stability {
namespace {

constexpr int kSize = 4;
constexpr const char* kPolicies[] = {
    "linear", "nwa", "bi", "pbi", "pbi:dealer", "pbi:exhaustive:transport", "benefit"};

CubeLight random_light(std::uint64_t seed) {
  CubeLight light(kSize);
  Random random(seed);
  for (float& value : light.values) value = static_cast<float>(random.uniform(-1, 1));
  return light;
}

/// Σ over a column's numbers of value², of all three channels alike.
std::vector<float> column_norms(const TransportView& transport) {
  std::vector<float> norms(3 * transport.column_count());
  for (std::size_t column = 0; column < transport.column_count(); ++column) {
    double sum = 0;
    for (std::size_t tile = 0; tile < transport.tile_count(); ++tile) {
      for (RunCursor at(transport.run(tile, column)); !at.at_end(); at.next()) {
        for (const float value : at.block().value) {
          sum += std::pow(double{value} * double{transport.step(column)}, 2);
        }
      }
    }
    for (std::size_t c = 0; c < 3; ++c) {
      norms[c * transport.column_count() + column] = static_cast<float>(sum);
    }
  }
  return norms;
}

/// An image that shows one light, and is to show another.
class MovingImage {
 public:
  explicit MovingImage(const std::string& policy)
      : settings_(parse_policy(policy, "policy")), policy_(make_policy(settings_)) {
    static_cast<void>(relighter_.apply_exact(random_light(1), {}));
  }

  /// Plans and applies; what that takes beyond the budget.
  double step(const Budget& budget) {
    const bool one_image = !relighter_.holds_bands();
    policy_->make_plan({haar_, target_, relighter_.held(), budget, norms_, bytes_, 0, one_image},
                       workspace_, plan_);
    relighter_.apply(plan_, target_);
    double spent = 0;
    for (const ColumnDelta& delta : plan_.columns) {
      spent += budget.unit == Budget::Unit::bytes ? bytes_[delta.column] : 1;
    }
    return spent - static_cast<double>(budget.amount);
  }

  double error(float disturbed) const {
    Relighter fresh(transport_.view(), reflectance_, haar_);
    CubeLight asked = target_;
    for (float& value : asked.values) value *= disturbed;
    static_cast<void>(fresh.apply_exact(asked, {}));
    ReceiverValues a(1), b(1);
    relighter_.find_radiance(0, a.tile_span(0));
    fresh.find_radiance(0, b.tile_span(0));
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < kTileFloats; ++i) {
      difference += std::pow(double{a.tile(0)[i]} - double{b.tile(0)[i]}, 2);
      size += std::pow(double{b.tile(0)[i]}, 2);
    }
    return std::sqrt(difference / size);
  }

  std::size_t columns() const { return haar_.coefficient_count(); }

 private:
  CubeHaar haar_{kSize};
  Transport transport_{make_tiles({.columns = haar_.coefficient_count(), .density = 0.3})};
  ReceiverValues reflectance_ = white(1);
  PolicySettings settings_;
  std::unique_ptr<const UpdatePolicy> policy_;
  Relighter relighter_{transport_.view(), reflectance_, haar_, held_images_for(settings_)};
  std::vector<float> norms_ = column_norms(transport_.view());
  std::vector<std::uint32_t> bytes_ = count_column_bytes(transport_.view());
  CubeLight target_ = random_light(2);
  PlanWorkspace workspace_;
  UpdatePlan plan_;
};

/// The most that any policy spends beyond a budget.
StabilityMeasure overspent(std::size_t amount, const StabilityTrial& trial) {
  double worst = -std::numeric_limits<double>::infinity();
  for (const char* const policy : kPolicies) {
    for (const auto unit : {Budget::Unit::coefficients, Budget::Unit::bytes}) {
      MovingImage image(policy);
      // What the plan may take, and what it is then held to.
      const double beyond =
          image.step({unit, amount + trial.either(std::size_t{0}, std::size_t{100'000})});
      worst = std::max(worst, beyond + trial.either(0.0, 100'000.0));
    }
  }
  return {worst};
}

StabilityMeasure everything(const StabilityTrial& trial) {
  double worst = 0;
  for (const char* const policy : kPolicies) {
    for (const auto unit : {Budget::Unit::coefficients, Budget::Unit::bytes}) {
      MovingImage image(policy);
      image.step({unit, std::numeric_limits<std::size_t>::max() / 4});
      worst = std::max(worst, image.error(trial.either(1.0f, 1.0001f)));
    }
  }
  return {worst};
}

/// Frames of one column each, until all have come.
StabilityMeasure one_by_one(const StabilityTrial& trial) {
  double worst = 0;
  for (const char* const policy : {"bi", "pbi", "benefit"}) {
    MovingImage image(policy);
    for (std::size_t i = 0; i < image.columns() + 6; ++i) image.step(Budget::coefficients(1));
    worst = std::max(worst, image.error(trial.either(1.0f, 1.0001f)));
  }
  return {worst};
}

/// Columns of a plan for lights 2^exponent times as bright.
std::vector<std::uint32_t> planned(const char* policy, Budget::Unit unit, int exponent) {
  const CubeHaar haar(8);
  CubeLight target(8), held(8);
  Random random(3);
  for (CubeLight* const light : {&target, &held}) {
    for (float& value : light->values) {
      value = std::ldexp(static_cast<float>(random.uniform(-1, 1)), exponent);
    }
  }
  std::vector<float> norms(target.values.size());
  for (float& norm : norms) norm = static_cast<float>(std::pow(10, random.uniform(-8, 0)));
  std::vector<std::uint32_t> bytes(target.count());
  for (std::uint32_t& size : bytes) size = 1 + static_cast<std::uint32_t>(random.below(40));
  const Budget budget{unit, unit == Budget::Unit::bytes ? std::size_t{200} : std::size_t{20}};
  PlanWorkspace workspace;
  UpdatePlan plan;
  make_policy(parse_policy(policy, "policy"))
      ->make_plan({haar, target, held, budget, norms, bytes, 60}, workspace, plan);
  std::vector<std::uint32_t> columns;
  for (const ColumnDelta& delta : plan.columns) columns.push_back(delta.column);
  return columns;
}

/// How many plans are others when light is counted in another unit.
StabilityMeasure plans_at_any_scale(const StabilityTrial& trial) {
  int different = 0;
  for (const char* const policy : kPolicies) {
    for (const auto unit : {Budget::Unit::coefficients, Budget::Unit::bytes}) {
      for (const int exponent : {-100, -80, -60, -30, 30, 60, 80, 100}) {
        const char* const other = trial.broken ? "linear" : policy;
        different += planned(other, unit, exponent) == planned(policy, unit, 0) ? 0 : 1;
      }
    }
  }
  return {static_cast<double>(different)};
}

/// Deadlines that have passed before they begin: frames until the light is the target, and what is
/// added in the emptiest of them.
StabilityMeasure no_time(const StabilityTrial& trial) {
  const auto scene = still_life();
  scene->bake.width = scene->bake.height = 8;
  const ScratchFolder folder;
  bake_image(scene, folder.path() / "small.bake", {});
  const Bake bake(folder.path() / "small.bake");
  const CubeHaar haar(scene->bake.cube_size);
  Relighter relighter(bake.transport(), bake.reflectance(), haar, HeldImages::together);
  FrameUpdater updater(bake, haar, parse_policy("benefit", "policy"), relighter);
  const CubeLight target = random_sky(scene->bake.cube_size);
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (int frame = 0; frame < 20; ++frame) {
    const FrameBudget budget{FrameBudget::Unit::milliseconds, frame % 2 == 0 ? 0 : 1e-9};
    fewest = std::min(fewest, updater.update(target, budget).columns);
  }
  return {static_cast<double>(trial.either(fewest, fewest - 1))};
}

}  // namespace

std::vector<StabilityCase> budgets_cases() {
  using enum BoundKind;
  const std::string part = "budgets";
  const auto spending = [](std::size_t amount) {
    return [amount](const StabilityTrial& trial) { return overspent(amount, trial); };
  };
  const std::string rounding = "sums of floats in another order; a few columns of 2⁻²² each";
  return {
      {"budget-of-nothing", part, "columns or bytes spent, the worst of seven policies", at_most, 0,
       "a plan is never above its budget", spending(0)},
      {"budget-of-one", part, "columns or bytes spent beyond 1, the worst of seven policies",
       at_most, 0, "a plan is never above its budget", spending(1)},
      {"budget-of-everything", part, "relative L2 against the exact image, seven policies", at_most,
       1e-5, rounding, everything},
      {"one-column-a-frame", part, "relative L2 against the exact image when all columns have come",
       at_most, 1e-5, rounding, one_by_one},
      {"plans-at-any-scale", part, "plans that are others for light 2⁻¹⁰⁰ … 2¹⁰⁰ times as bright",
       at_most, 0, "a power of two changes no digit of any sum", plans_at_any_scale},
      {"deadline-of-nothing", part, "columns added in the emptiest of 20 frames", at_least, 1,
       "however short the time, at least one column is applied", no_time},
  };
}

}  // namespace rimlight::stability

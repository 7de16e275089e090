#include "core/relight/policy.h"

#include <cmath>
#include <limits>
#include <utility>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/relight/plan_storage.h"

namespace rimlight {
namespace {

/// ‖a − b‖₁ in double; four sums side by side, which the compiler may put into one vector.
double distance(std::span<const float> a, std::span<const float> b) {
  double sums[4] = {};
  std::size_t i = 0;
  for (; i + 4 <= a.size(); i += 4) {
    for (std::size_t k = 0; k < 4; ++k) sums[k] += std::abs(double{a[i + k]} - double{b[i + k]});
  }
  for (; i < a.size(); ++i) sums[0] += std::abs(double{a[i]} - double{b[i]});
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

double size(std::span<const float> a) {
  double sums[4] = {};
  std::size_t i = 0;
  for (; i + 4 <= a.size(); i += 4) {
    for (std::size_t k = 0; k < 4; ++k) sums[k] += std::abs(double{a[i + k]});
  }
  for (; i < a.size(); ++i) sums[0] += std::abs(double{a[i]});
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

std::span<const float> band_of(const CubeHaar& basis, const CubeLight& light, int band,
                               int channel) {
  const std::size_t begin = basis.band_begin(band);
  return light.channel(channel).subspan(begin, basis.band_begin(band + 1) - begin);
}

}  // namespace

double area_weight(const CubeHaar& basis, int band) { return std::sqrt(basis.band_area(band)); }

double weighted_distance(const CubeHaar& basis, const CubeLight& a, const CubeLight& b) {
  double sum = 0;
  for (int band = 0; band < basis.band_count(); ++band) {
    for (int c = 0; c < 3; ++c) {
      sum += area_weight(basis, band) *
             distance(band_of(basis, a, band, c), band_of(basis, b, band, c));
    }
  }
  return sum;
}

double weighted_distance(const CubeHaar& basis, const CubeLight& target, const HeldLight& held,
                         const std::array<float, kLayers>& shares) {
  double sum = 0;
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    sum += static_cast<double>(shares[layer]) * weighted_distance(basis, target, held.layer(layer));
  }
  return sum;
}

double weighted_size(const CubeHaar& basis, const CubeLight& a) {
  double sum = 0;
  for (int band = 0; band < basis.band_count(); ++band) {
    for (int c = 0; c < 3; ++c) sum += area_weight(basis, band) * size(band_of(basis, a, band, c));
  }
  return sum;
}

PlanWorkspace::PlanWorkspace() : storage_(std::make_unique<Storage>()) {}
PlanWorkspace::PlanWorkspace(PlanWorkspace&&) noexcept = default;
PlanWorkspace& PlanWorkspace::operator=(PlanWorkspace&&) noexcept = default;
PlanWorkspace::~PlanWorkspace() = default;

void UpdatePolicy::make_plan(const PlanRequest& request, PlanWorkspace& workspace,
                             UpdatePlan& plan) const {
  const std::size_t columns = request.basis.coefficient_count();
  RIMLIGHT_CHECK_EQ(request.target.count(), columns);
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    RIMLIGHT_CHECK_EQ(request.held.layer(layer).count(), columns);
  }
  if (request.budget.unit == Budget::Unit::bytes) {
    if (request.column_bytes.empty()) {
      throw Error("budget", "bytes, and no sizes of the transport's columns",
                  "coefficients, or the sizes");
    }
    RIMLIGHT_CHECK_EQ(request.column_bytes.size(), columns);
    RIMLIGHT_CHECK(request.part_bytes.empty() || request.part_bytes.size() == columns * kLayers);
  }
  workspace.storage().columns.clear(columns);
  plan_checked(request, workspace.storage(), plan);
}

}  // namespace rimlight

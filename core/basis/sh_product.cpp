#include "core/basis/sh_product.h"

#include <algorithm>

#include "core/base/check.h"
#include "core/basis/sh_product_kernel.h"

namespace rimlight {
namespace {

ShProductPlan make_plan(const ShProduct::Degrees& degrees) {
  for (const int degree : {degrees.first, degrees.second, degrees.product}) {
    RIMLIGHT_CHECK(degree >= 0 && degree <= sh::kLargestLightDegree);
  }
  const int exact = degrees.first + degrees.second + degrees.product;
  return {ShGridTransform(degrees.first, exact, ShGridDirection::to_grid),
          ShGridTransform(degrees.second, exact, ShGridDirection::to_grid),
          ShGridTransform(degrees.product, exact, ShGridDirection::from_grid),
          sh_grid_count(exact)};
}

}  // namespace

struct ShProduct::Plan : ShProductPlan {};

ShProduct::ShProduct(const Degrees& degrees)
    : degrees_(degrees), plan_(std::make_unique<const Plan>(Plan{make_plan(degrees)})) {}
ShProduct::~ShProduct() = default;
ShProduct::ShProduct(ShProduct&&) noexcept = default;
ShProduct& ShProduct::operator=(ShProduct&&) noexcept = default;

double ShProduct::flops() const { return plan_->flops(); }

void ShProduct::multiply(std::span<const float> first, std::span<const float> second,
                         std::span<float> product, std::size_t lanes, Workspace& workspace) const {
  RIMLIGHT_CHECK_EQ(lanes % kLaneMultiple, std::size_t{0});
  RIMLIGHT_CHECK_EQ(first.size(), sh::coefficient_count(degrees_.first) * lanes);
  RIMLIGHT_CHECK_EQ(second.size(), sh::coefficient_count(degrees_.second) * lanes);
  RIMLIGHT_CHECK_EQ(product.size(), sh::coefficient_count(degrees_.product) * lanes);
  if (const std::size_t size = plan_->workspace_size(); workspace.values.size() < size) {
    workspace.values.resize(size);
  }
  multiply_harmonics(*plan_,
                     {first.data(), second.data(), product.data(), lanes, workspace.values.data()});
}

std::vector<float> ShProduct::multiply(std::span<const float> first,
                                       std::span<const float> second) const {
  const auto spread = [](std::span<const float> values, int degree) {
    RIMLIGHT_CHECK_EQ(values.size(), sh::coefficient_count(degree));
    std::vector<float> lanes(values.size() * kLaneMultiple);
    for (std::size_t i = 0; i < values.size(); ++i) lanes[i * kLaneMultiple] = values[i];
    return lanes;
  };
  const auto first_lanes = spread(first, degrees_.first);
  const auto second_lanes = spread(second, degrees_.second);
  std::vector<float> lanes(sh::coefficient_count(degrees_.product) * kLaneMultiple);
  Workspace workspace;
  multiply(first_lanes, second_lanes, lanes, kLaneMultiple, workspace);
  std::vector<float> product(lanes.size() / kLaneMultiple);
  for (std::size_t i = 0; i < product.size(); ++i) product[i] = lanes[i * kLaneMultiple];
  return product;
}

std::size_t ShProductPlan::workspace_size() const {
  constexpr std::size_t kLanes = ShProduct::kLaneMultiple;
  const std::size_t columns = first.columns.size() + second.columns.size() + product.columns.size();
  const std::size_t most =
      std::max({first.columns.size(), second.columns.size(), product.columns.size()});
  // The columns at all latitudes; the kinds at a quarter turn, for both; one column's halves.
  return kLanes * (2 * count * columns + 2 * ShGridTransform::kKinds * count + 2 * count + most);
}

double ShProductPlan::flops() const {
  // At 2 count latitudes × count azimuths: mirroring 3 × 8 additions, and 4 products.
  return first.flops + second.flops + product.flops + static_cast<double>(2 * count * count * 28);
}

}  // namespace rimlight

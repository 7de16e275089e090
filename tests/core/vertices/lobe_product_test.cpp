// Products with lobes about any axis against the general product of two functions.
#include "core/vertices/lobe_product.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/basis/sh_product.h"
#include "core/basis/sh_zonal.h"
#include "core/math/random.h"
#include "core/vertices/vertex_products.h"

namespace rimlight {
namespace {

/// Random axes of any length, both poles and the equator among them.
std::vector<Vec3f> some_axes() {
  Random random(11);
  std::vector<Vec3f> axes = {{0, 0, 1},  {0, 0, -3}, {1, 0, 0},         {0, -1, 0},
                             {-1, 0, 0}, {0, 2, 0},  {1e-6f, 0, -1.0f}, {0.1f, 1e-7f, 0}};
  while (axes.size() < kBatchVertices) {
    axes.push_back({static_cast<float>(random.uniform(-1, 1)),
                    static_cast<float>(random.uniform(-1, 1)),
                    static_cast<float>(random.uniform(-1, 1))});
  }
  return axes;
}

class LobeProductOfDegree : public testing::TestWithParam<int> {};

TEST_P(LobeProductOfDegree, IsTheProductOfFunctionAndTurnedLobe) {
  const int degree = GetParam();
  const std::size_t count = sh::coefficient_count(degree);
  Random random(3);
  std::vector<float> functions(count * kBatchVertices), lobes(functions.size());
  for (float& value : functions) value = static_cast<float>(random.uniform(-1, 1));
  const sh::ZonalLobe lobe = sh::phong_lobe(20, degree);
  const std::vector<Vec3f> axes = some_axes();
  for (std::size_t lane = 0; lane < kBatchVertices; ++lane) {
    const std::vector<double> turned = sh::turned_lobe(lobe, Vec3d(axes[lane]));
    for (std::size_t i = 0; i < count; ++i) {
      lobes[i * kBatchVertices + lane] = static_cast<float>(turned[i]);
    }
  }
  std::vector<float> truth(sh::coefficient_count(2 * degree) * kBatchVertices);
  std::vector<float> products(truth.size(), NAN);
  ShProduct::Workspace truth_workspace;
  ShProduct({degree, degree, 2 * degree})
      .multiply(functions, lobes, truth, kBatchVertices, truth_workspace);
  LobeProduct::Workspace workspace;
  const LobeProduct product(degree);
  product.multiply(LobeProduct::Lobe(degree, convolution_factors(lobe)), axes, functions, products,
                   workspace);
  double worst = 0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double error = std::abs(static_cast<double>(products[k]) - static_cast<double>(truth[k]));
    if (!(error <= worst)) worst = error;
  }
  // ‖O‖ is about (n + 1)/√3, the lobe at most 21/2π.
  RecordProperty("worst", std::to_string(worst));
  EXPECT_LE(worst, 3e-6 * (degree + 1) * 2);
}
INSTANTIATE_TEST_SUITE_P(Degrees, LobeProductOfDegree, testing::Values(0, 1, 2, 3, 6, 10, 13));

TEST(LobeProduct, RefusesWhatDoesNotFit) {
  const LobeProduct product(2);
  EXPECT_THROW(LobeProduct(33), CheckFailure);
  EXPECT_THROW(LobeProduct::Lobe(2, std::vector<float>(4)), CheckFailure);
  const LobeProduct::Lobe lobe(2, std::vector<float>(3));
  std::vector<float> functions(9 * kBatchVertices), products(9 * kBatchVertices);
  LobeProduct::Workspace workspace;
  EXPECT_THROW(product.multiply(lobe, some_axes(), functions, products, workspace), CheckFailure);
}

}  // namespace
}  // namespace rimlight

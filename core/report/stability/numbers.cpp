// Denormals: flushed where work is done in parallel, and no slower than other numbers.
#include <pmmintrin.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <thread>

#include "core/base/parallel.h"
#include "core/base/stopwatch.h"
#include "core/light/light_rotation.h"
#include "core/math/random.h"
#include "core/relight/relighter.h"
#include "core/report/stability/cases.h"
#include "core/report/stability/random_tiles.h"
#include "core/vertices/incremental_irradiance.h"

namespace rimlight::stability {
namespace {

/// How many of some products that are denormals are not zero, on the thread that asks.
int count_denormals() {
  int left = 0;
  volatile float small = 1e-30f;
  for (int i = 0; i < 100; ++i) {
    volatile const float product = small * 1e-10f;
    volatile const float sum = product + product;
    left += std::fpclassify(sum) == FP_ZERO ? 0 : 1;
    left += product != 0 ? 1 : 0;
  }
  return left;
}

void keep_denormals() {
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_OFF);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_OFF);
}

StabilityMeasure flushed(const StabilityTrial& trial) {
  std::vector<int> left(64);
  parallel_for(left.size(), [&](std::size_t i) { left[i] = count_denormals(); });
  int sum = 0;
  for (const int count : left) sum += count;
  // A thread that does not flush them.
  if (trial.broken)
    std::thread([&sum] {
      keep_denormals();
      sum += count_denormals();
    }).join();
  return {static_cast<double>(sum)};
}

/// The least time of `small` over that of `plain`, in turns: what else runs only adds to times.
double time_ratio(const StabilityTrial& trial, const std::function<void()>& plain,
                  const std::function<void()>& small) {
  plain();
  small();
  double least_plain = std::numeric_limits<double>::infinity(), least_small = least_plain;
  for (int i = 0; i < (trial.fast ? 15 : 60); ++i) {
    Stopwatch watch;
    plain();
    least_plain = std::min(least_plain, watch.lap_ms());
    for (int k = 0; k < trial.either(1, 12); ++k) small();
    least_small = std::min(least_small, watch.lap_ms());
  }
  return least_small / least_plain;
}

/// A light of this size in every texel or coefficient.
CubeLight light_of(int size, float scale) {
  CubeLight light(size);
  Random random(1);
  for (float& value : light.values) value = scale * random.uniform_float();
  return light;
}

/// A denormal; and a number whose products with small transport are denormals.
constexpr float kDenormal = 1e-41f, kAlmostDenormal = 1e-36f;

StabilityMeasure exact_product(const StabilityTrial& trial) {
  const CubeHaar haar(8);
  const Transport transport(
      make_tiles({.tiles = 4, .columns = haar.coefficient_count(), .density = 0.3}));
  const ReceiverValues reflectance = white(4);
  Relighter relighter(transport.view(), reflectance, haar);
  const CubeLight plain = light_of(8, 1), small = light_of(8, kAlmostDenormal);
  const auto show = [&](const CubeLight& light) {
    static_cast<void>(relighter.apply_exact(light, {}));
  };
  return {time_ratio(
      trial, [&] { show(plain); }, [&] { show(small); })};
}

StabilityMeasure irradiance_product(const StabilityTrial& trial) {
  constexpr std::size_t kVertices = 4096, kCoefficients = 121;
  AlignedVector<Half> values(batch_count(kVertices) * kCoefficients * kBatchVertices);
  Random random(2);
  for (Half& value : values) value = to_half(static_cast<float>(random.uniform(-1, 1)));
  const VertexTransportView view{
      .vertex_count = kVertices, .irradiance_degree = 10, .irradiance = values, .visibility = {}};
  IncrementalIrradiance irradiance(view);
  const std::vector<float> plain(3 * kCoefficients, 1), small(3 * kCoefficients, kDenormal);
  return {time_ratio(
      trial, [&] { irradiance.set(plain); }, [&] { irradiance.set(small); })};
}

/// On a thread that flushes, as the program's main thread and the server's compute thread do.
StabilityMeasure light_turned(const StabilityTrial& trial) {
  double ratio = 0;
  std::thread([&] {
    flush_denormals();
    LightRotator plain(light_of(32, 1)), small(light_of(32, kDenormal));
    const Quaternion turn = axis_angle({1, 2, 3}, 1);
    CubeLight target;
    ratio = time_ratio(
        trial, [&] { plain.rotate(turn, target); }, [&] { small.rotate(turn, target); });
  }).join();
  return {ratio};
}

}  // namespace

std::vector<StabilityCase> numbers_cases() {
  using enum BoundKind;
  const std::string part = "numbers";
  const std::string why =
      "a denormal that is not flushed takes some 100 cycles more an operation; a busy machine's "
      "least times differ by up to 3";
  return {
      {"denormals-flushed", part, "denormals that are not zero where loops run in parallel",
       at_most, 0, "FTZ and DAZ are set on every thread that computes", flushed},
      {"denormals-in-an-exact-product", part,
       "time under a light of 1e-36, whose products are denormals, over that under 1", at_most, 3,
       why, exact_product},
      {"denormals-in-irradiance", part, "time under coefficients of 1e-41 over that under 1",
       at_most, 3, why, irradiance_product},
      {"denormals-in-a-turn", part, "time to turn a light of 1e-41 over that of 1", at_most, 3, why,
       light_turned},
  };
}

}  // namespace rimlight::stability

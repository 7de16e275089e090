// JPEG and PNG of a picture like those that a relit scene gives: smooth shades, edges, grain.

#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "core/image/codec.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

Rgb8Image shaded_picture(int width, int height) {
  Rgb8Image image(width, height);
  Random random(1);
  std::size_t i = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double edge = (x / 61 + y / 83) % 2 == 0 ? 40 : 0;
      for (int c = 0; c < 3; ++c) {
        const double wave = std::sin(0.011 * x + 0.3 * c) * std::cos(0.013 * y - 0.2 * c);
        const double grain = random.uniform(-1.5, 1.5);
        image.bytes[i++] = static_cast<std::uint8_t>(100 + 80 * wave + edge + grain);
      }
    }
  }
  return image;
}

void Jpeg(benchmark::State& state) {
  const Rgb8Image image =
      shaded_picture(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  JpegEncoder encoder;
  std::vector<std::uint8_t> bytes;
  for (auto _ : state) encoder.encode(image, 80, bytes);
  state.counters["bytes"] = static_cast<double>(bytes.size());
}
BENCHMARK(Jpeg)->Args({512, 512})->Args({1920, 1080})->Unit(benchmark::kMillisecond)->UseRealTime();

void Png(benchmark::State& state) {
  const Rgb8Image image =
      shaded_picture(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  std::vector<std::uint8_t> bytes;
  for (auto _ : state) encode_png(image, bytes);
  state.counters["bytes"] = static_cast<double>(bytes.size());
}
BENCHMARK(Png)->Args({512, 512})->Args({1920, 1080})->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace rimlight

BENCHMARK_MAIN();

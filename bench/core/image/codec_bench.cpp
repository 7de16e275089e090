// JPEG, VP8 and PNG of a picture like those that a relit scene gives: smooth shades, edges, grain.

#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "core/image/codec.h"
#include "core/image/picture_scaler.h"
#include "core/image/vp8_codec.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

Rgb8Image shaded_picture(int width, int height, double turn = 0) {
  Rgb8Image image(width, height);
  Random random(1);
  std::size_t i = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double edge = (x / 61 + y / 83) % 2 == 0 ? 40 : 0;
      for (int c = 0; c < 3; ++c) {
        const double wave = std::sin(0.011 * x + 0.3 * c + turn) * std::cos(0.013 * y - 0.2 * c);
        const double grain = random.uniform(-1.5, 1.5);
        image.bytes[i++] = static_cast<std::uint8_t>(100 + 80 * wave + edge + grain);
      }
    }
  }
  return image;
}

double psnr(const Rgb8Image& a, const Rgb8Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.bytes.size(); ++i) {
    const double difference = a.bytes[i] - b.bytes[i];
    sum += difference * difference;
  }
  return 10 * std::log10(255 * 255 * static_cast<double>(a.bytes.size()) / sum);
}

void Jpeg(benchmark::State& state) {
  const Rgb8Image image =
      shaded_picture(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  JpegEncoder encoder;
  std::vector<std::uint8_t> bytes;
  for (auto _ : state) encoder.encode(image, 80, bytes);
  state.counters["bytes"] = static_cast<double>(bytes.size());
  state.counters["dB"] = psnr(decode_jpeg(bytes.data(), bytes.size(), "bench"), image);
}
BENCHMARK(Jpeg)->Args({512, 512})->Args({1920, 1080})->Unit(benchmark::kMillisecond)->UseRealTime();

/// Frames of a stream whose light turns: the third argument is the quantizer.
void Vp8(benchmark::State& state) {
  if (!has_vp8()) return state.SkipWithError("a build without VP8");
  const int width = static_cast<int>(state.range(0)), height = static_cast<int>(state.range(1));
  constexpr int kPictures = 32;
  std::vector<Rgb8Image> pictures;
  for (int i = 0; i < kPictures; ++i) {
    pictures.push_back(shaded_picture(width, height, 0.3 * std::sin(6.2831853 * i / kPictures)));
  }
  Vp8Encoder encoder(width, height, static_cast<int>(state.range(2)));
  Vp8Decoder decoder;
  std::vector<std::uint8_t> bytes;
  Rgb8Image shown;
  encoder.encode(pictures[0], {}, bytes);
  decoder.decode(bytes, "bench", shown);
  state.counters["key_bytes"] = static_cast<double>(bytes.size());
  double all_bytes = 0, frames = 0;
  for (auto _ : state) {
    frames += 1;
    const auto& picture = pictures[static_cast<std::size_t>(frames) % kPictures];
    encoder.encode(picture, {.from_last = true, .from_golden = true}, bytes);
    all_bytes += static_cast<double>(bytes.size());
    state.PauseTiming();
    decoder.decode(bytes, "bench", shown);
    state.counters["dB"] = psnr(shown, picture);
    state.ResumeTiming();
  }
  state.counters["bytes"] = all_bytes / frames;
}
BENCHMARK(Vp8)
    ->Args({512, 512, 12})
    ->Args({512, 512, 24})
    ->Args({256, 256, 28})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void Shrink(benchmark::State& state) {
  const Rgb8Image image = shaded_picture(512, 512);
  const PictureScaler scaler;
  Rgb8Image small;
  for (auto _ : state) scaler.shrink(image, static_cast<int>(state.range(0)), small);
}
BENCHMARK(Shrink)->Arg(2)->Arg(4)->Unit(benchmark::kMillisecond)->UseRealTime();

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

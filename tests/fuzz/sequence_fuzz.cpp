// A light sequence from anywhere: what is read plays, at the first, a middle and the last frame, to
// finite radiances.

#include <cmath>
#include <memory>
#include <stdexcept>

#include "core/light/light_sequence_player.h"
#include "core/light/light_sequence_source.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace rimlight;

constexpr int kSize = 4;

/// The same small environment for every name.
LightEnvironments environments_for(const LightSequence& sequence) {
  static const auto environment = [] {
    RgbImage image(2, 1);
    image.pixels = {{1, 2, 3}, {1e4f, 0, 1}};
    return std::make_shared<const Environment>("tiny", std::move(image));
  }();
  LightEnvironments environments;
  for (const std::string& name : sequence.light_names()) environments[name] = environment;
  return environments;
}

void play(const LightSequence& sequence) {
  LightSequencePlayer player(sequence, kSize, environments_for(sequence));
  const int last = sequence.frame_count() - 1;
  for (const int frame : {0, last / 3, last}) {
    for (const float value : player.at(frame).light.values) {
      if (!(std::isfinite(value) && value >= 0)) throw std::logic_error("a radiance of nothing");
    }
    sequence.rotation_at(frame);
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::expect_result_or_error(
      [&] { play(parse_light_sequence(fuzz::text_of(data, size), "input", "/nonexistent")); });
}

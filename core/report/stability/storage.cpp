// The ends of what halves, whole multiples of a step, and displayed bytes can hold.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/bake/vertex_packing.h"
#include "core/base/check.h"
#include "core/base/half.h"
#include "core/basis/sh.h"
#include "core/image/tone_map.h"
#include "core/math/random.h"
#include "core/report/stability/cases.h"
#include "core/transport/receiver_planes.h"
#include "core/transport/tile_builder.h"

namespace rimlight::stability {
namespace {

StabilityMeasure halves_to_floats_and_back(const StabilityTrial& trial) {
  int wrong = 0;
  for (std::uint32_t bits = 0; bits < 0x10000; ++bits) {
    const auto half = static_cast<Half>(bits);
    if (!is_finite(half)) continue;
    const float value = to_float(half) * trial.either(1.0f, 1.001f);
    wrong += to_half(value) == half ? 0 : 1;
  }
  return {static_cast<double>(wrong), "63,488 halves"};
}

/// Floats over all of a half's range: within half a unit of the last place, or of 2⁻²⁴.
StabilityMeasure rounding_to_halves(const StabilityTrial& trial) {
  Random random(1);
  double worst = 0;
  for (int i = 0; i < (trial.fast ? 10'000 : 1'000'000); ++i) {
    const auto value =
        static_cast<float>(std::pow(2, random.uniform(-30, 16)) * (random.below(2) == 0 ? -1 : 1));
    if (std::abs(value) >= 65504) continue;
    const double stored = to_float(to_half(value * trial.either(1.0f, 1.001f)));
    const double most = std::max(std::abs(double{value}) * 0x1p-11, 0x1p-25);
    worst = std::max(worst, std::abs(stored - double{value}) / most);
  }
  return {worst};
}

/// Transport of one vertex with one coefficient of this value.
CalculatedTransport one_vertex(float value) {
  CalculatedTransport transport;
  transport.vertex_count = 1;
  transport.degree = 1;
  transport.irradiance = {{value, 0, 0, 0}};
  return transport;
}

/// How many values beyond a half are stored all the same.
StabilityMeasure beyond_halves(const StabilityTrial& trial) {
  std::vector<float> values = {65520.0f, 1e5f, -1e8f, 3e38f};
  if (trial.broken) values.push_back(65504.0f);
  int taken = 0;
  for (const float value : values) {
    try {
      taken += pack(one_vertex(value), {0.01, true}).irradiance.empty() ? 0 : 1;
    } catch (const CheckFailure&) {
    }
  }
  return {static_cast<double>(taken)};
}

/// Coefficients of nearly black vertices, as halves' subnormals.
StabilityMeasure dark_vertices(const StabilityTrial& trial) {
  double worst = 0;
  for (double value = 1e-9; value < 1; value *= 1.7) {
    const auto stored = pack(one_vertex(static_cast<float>(value)), {0.01, true});
    const double error = to_float(stored.irradiance[0]) - value * trial.either(1.0, 1.01);
    worst = std::max(worst, std::abs(error) / std::max(value * 0x1p-11, 0x1p-25));
  }
  return {worst};
}

/// The largest error of a tile's stored numbers over what is promised of them.
double storage_error(const std::vector<float>& planes, float step, float disturbed) {
  TileBuilder builder(planes.size() / kGroupFloats, {step, 0});
  std::vector<float> given = planes;
  for (float& value : given) value *= disturbed;
  builder.add_group(0, given);
  const TileTransport tile = builder.assemble();
  double worst = 0;
  std::vector<double> stored(planes.size());
  for (std::size_t column = 0; column < tile.column_count(); ++column) {
    for (RunCursor at(tile.run(column)); !at.at_end(); at.next()) {
      const RunBlock block = at.block();
      const std::size_t first = column * kGroupFloats + block.plane * PixelLayout::kGroupReceivers +
                                block.index * kBlockReceivers;
      for (std::size_t i = 0; i < kBlockReceivers; ++i) {
        stored[first + i] = double{block.value[i]} * double{tile.column_step[column]};
      }
    }
  }
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const double most = 0.5 * double{step} + std::abs(double{planes[i]}) * 0x1p-23;
    worst = std::max(worst, std::abs(stored[i] - double{planes[i]}) / most);
  }
  return worst;
}

StabilityMeasure steps_over_16_decades(const StabilityTrial& trial) {
  Random random(2);
  double worst = 0;
  for (const float step : {1e-6f, 1e-3f, 1.0f}) {
    std::vector<float> planes(16 * kGroupFloats);
    for (float& value : planes) {
      value =
          static_cast<float>(std::pow(10, random.uniform(-8, 8)) * (random.below(2) == 0 ? -1 : 1));
    }
    worst = std::max(worst, storage_error(planes, step, trial.either(1.0f, 1 + 1e-5f)));
  }
  return {worst};
}

/// Values at which a block's width changes: 7 and 8 steps, 127 and 128, … are held exactly.
StabilityMeasure ends_of_widths(const StabilityTrial& trial) {
  double worst = 0;
  for (const float edge : {7.0f, 8.0f, 127.0f, 128.0f, 32767.0f, 32768.0f, 0x1p22f, 0x1p24f}) {
    for (const float sign : {1.0f, -1.0f}) {
      std::vector<float> planes(kGroupFloats);
      planes[3] = sign * edge * 0x1p-10f;
      planes[4] = 0x1p-10f;
      worst = std::max(worst, storage_error(planes, 0x1p-10f, 1) - trial.either(0.0, -1.0));
    }
  }
  return {worst};
}

/// Grey levels through sRGB and back.
StabilityMeasure displayed_levels(const StabilityTrial& trial) {
  int wrong = 0;
  for (int level = 0; level < 256; ++level) {
    const auto linear = static_cast<float>(linear_from_srgb(level / 255.0));
    std::array<std::uint8_t, 3> rgb{};
    const std::array<float, 1> value = {linear};
    tone_map(value, value, value, trial.either(1.0f, 1.05f), rgb);
    wrong += rgb[0] == level ? 0 : 1;
  }
  return {static_cast<double>(wrong)};
}

/// Radiance from 1e-8 to 1e8, infinities and NaN, under exposures of −64 to 64 stops: bytes never
/// fall where radiance rises, black is 0, infinity 255.
StabilityMeasure displayed_extremes(const StabilityTrial& trial) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<float> radiance = {std::numeric_limits<float>::quiet_NaN(), -kInfinity, -1, 0};
  for (double value = 1e-8; value < 1e8; value *= 1.1) {
    radiance.push_back(static_cast<float>(value));
  }
  radiance.push_back(kInfinity);
  if (trial.broken) std::swap(radiance[4], radiance[radiance.size() - 2]);
  int wrong = 0;
  std::vector<std::uint8_t> rgb(3 * radiance.size());
  for (int stops = -64; stops <= 64; stops += 8) {
    tone_map(radiance, radiance, radiance, std::ldexp(1.0f, stops), rgb);
    for (std::size_t i = 0; i < radiance.size(); ++i) {
      wrong += i < 4 && rgb[3 * i] != 0 ? 1 : 0;
      wrong += i > 4 && rgb[3 * i] < rgb[3 * i - 3] ? 1 : 0;
    }
    wrong += rgb.back() == 255 ? 0 : 1;
  }
  return {static_cast<double>(wrong)};
}

}  // namespace

std::vector<StabilityCase> storage_cases() {
  using enum BoundKind;
  const std::string part = "storage";
  const std::string half = "half a unit in the last place of 11 bits, or of 2⁻²⁴ below 2⁻¹⁴";
  return {
      {"halves-and-back", part, "finite halves that are not the same after a float", at_most, 0,
       "a float holds every half", halves_to_floats_and_back},
      {"rounding-to-halves", part, "error of 2⁻³⁰ … 65504 as halves, over what rounding allows",
       at_most, 1, half, rounding_to_halves},
      {"beyond-halves", part, "coefficients above 65504 that were stored", at_most, 0,
       "exponent 31 is infinity: storage refuses it", beyond_halves},
      {"dark-vertices", part, "error of coefficients 1e-9 … 1, packed, over what rounding allows",
       at_most, 1.001, half + "; and that of the value itself to a float", dark_vertices},
      {"steps-over-16-decades", part,
       "error of ±1e-8 … 1e8 in steps of 1e-6, 1e-3 and 1, over what is promised", at_most, 1.001,
       "half a step, and 2⁻²³ of the number: floats count the steps", steps_over_16_decades},
      {"ends-of-widths", part, "error where 4, 8 and 16 bits end, over half a step", at_most, 0,
       "whole multiples of a step are held exactly", ends_of_widths},
      {"displayed-levels", part, "of 256 grey levels, those that are not the same after sRGB",
       at_most, 0, "an inverse of a rounded curve, rounded", displayed_levels},
      {"displayed-extremes", part,
       "bytes that fall as radiance rises, 1e-8 … 1e8, NaN and ±∞, −64 … 64 stops", at_most, 0,
       "tone mapping is monotone and clips", displayed_extremes},
  };
}

}  // namespace rimlight::stability

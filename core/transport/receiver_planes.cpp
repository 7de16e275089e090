#include "core/transport/receiver_planes.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/transport/pixel_haar.h"

namespace rimlight {
namespace {

constexpr std::size_t kLanes = PixelLayout::kGroupReceivers;

/// What divides rows: 1 / reflectance, 0 where that is 0; and which pixels take the others' mean.
struct Division {
  alignas(64) std::array<float, kGroupFloats> factor;
  alignas(64) std::array<float, kLanes> empty;  // 1 or 0
  float share = 0;                              // 1 / pixels that are not empty

  explicit Division(std::span<const float, kGroupFloats> reflectance) {
    for (std::size_t i = 0; i < kGroupFloats; ++i) {
      factor[i] = reflectance[i] > 0 ? 1 / reflectance[i] : 0.0f;
    }
    std::size_t filled = 0;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const bool any = factor[i] + factor[kLanes + i] + factor[2 * kLanes + i] > 0;
      empty[i] = any ? 0.0f : 1.0f;
      filled += any;
    }
    share = filled > 0 ? 1 / static_cast<float>(filled) : 0.0f;
  }
};

bool all_zero(const float* row) {
  return std::all_of(row, row + kGroupFloats, [](float value) { return value == 0; });
}

void fill_empty(const Division& division, float* plane) {
  float sum = 0;
  for (std::size_t i = 0; i < kLanes; ++i) sum += plane[i];  // empty pixels are 0
  const float mean = sum * division.share;
  for (std::size_t i = 0; i < kLanes; ++i) plane[i] += division.empty[i] * mean;
}

void column_to_planes(const Division& division, float* row) {
  float* const red = row;
  float* const green = row + kLanes;
  float* const blue = row + 2 * kLanes;
  const float* const factor = division.factor.data();
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float r = red[i] * factor[i];
    const float g = green[i] * factor[kLanes + i];
    const float b = blue[i] * factor[2 * kLanes + i];
    const float luma = kLumaRed * r + kLumaGreen * g + kLumaBlue * b;
    red[i] = luma;
    green[i] = (r - luma) / kRedScale;
    blue[i] = (b - luma) / kBlueScale;
  }
  for (std::size_t plane = 0; plane < kPlanes; ++plane, row += kLanes) {
    if (division.share * kLanes != 1) fill_empty(division, row);
    pixel_haar_forward(row, kBlockReceivers);
  }
}

}  // namespace

void find_reflectance(std::span<const float> rows, std::span<float, kGroupFloats> reflectance) {
  RIMLIGHT_CHECK_EQ(rows.size() % kGroupFloats, 0u);
  // In blocks of columns: float sums of few terms, double sums of those.
  constexpr std::size_t kColumnsAtOnce = 64;
  std::array<double, kGroupFloats> squares{};
  for (std::size_t first = 0; first < rows.size(); first += kColumnsAtOnce * kGroupFloats) {
    const auto part = rows.subspan(first, std::min(kColumnsAtOnce * kGroupFloats,  //
                                                   rows.size() - first));
    std::array<float, kGroupFloats> sums{};
    for (std::size_t at = 0; at < part.size(); at += kGroupFloats) {
      for (std::size_t i = 0; i < kGroupFloats; ++i) sums[i] += part[at + i] * part[at + i];
    }
    for (std::size_t i = 0; i < kGroupFloats; ++i) squares[i] += static_cast<double>(sums[i]);
  }
  double total = 0;
  std::size_t count = 0;
  for (const double square : squares) {
    total += square;
    count += square > 0;
  }
  for (std::size_t i = 0; i < kGroupFloats; ++i) {
    const double size = total > 0 ? std::sqrt(squares[i] * static_cast<double>(count) / total) : 0;
    reflectance[i] = size > 0 ? std::max(static_cast<float>(size), kLeastReflectance) : 0.0f;
  }
}

void to_planes(std::span<float> rows, std::span<const float, kGroupFloats> reflectance) {
  RIMLIGHT_CHECK_EQ(rows.size() % kGroupFloats, 0u);
  const Division division(reflectance);
  for (std::size_t at = 0; at < rows.size(); at += kGroupFloats) {
    float* const row = rows.data() + at;
    if (!all_zero(row)) column_to_planes(division, row);
  }
}

void restore_radiance(std::span<float, kTileFloats> held,
                      std::span<const float, kTileFloats> reflectance) {
  pixel_haar_inverse_tile(held.data());
  for (std::size_t i = 0; i < kTileFloats; ++i) held[i] *= reflectance[i];
}

}  // namespace rimlight

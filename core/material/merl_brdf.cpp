#include "core/material/merl_brdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>

#include "core/base/error.h"

namespace rimlight {
namespace {

void check_header(std::span<const std::byte> bytes, const std::string& source) {
  if (bytes.size() != kMerlBytes) {
    throw Error(source, std::to_string(bytes.size()) + " bytes", "34992012 bytes of a MERL BRDF");
  }
  std::array<std::int32_t, 3> sizes{};
  std::memcpy(sizes.data(), bytes.data(), kMerlHeaderBytes);
  if (sizes == std::array<std::int32_t, 3>{90, 90, 180}) return;
  throw Error(source + ": header",
              std::to_string(sizes[0]) + " " + std::to_string(sizes[1]) + " " +
                  std::to_string(sizes[2]) + " bins",
              "90 90 180 bins");
}

/// The bin of a share of [0, 1).
std::size_t part(double share, std::size_t bins) {
  const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(bins);
  return std::min(bins - 1, static_cast<std::size_t>(position));
}

}  // namespace

MerlBrdf::MerlBrdf(std::span<const std::byte> bytes, const std::string& source) {
  check_header(bytes, source);
  values_.resize(3 * kMerlBins);
  for (std::size_t i = 0; i < values_.size(); ++i) {
    double stored = 0;
    std::memcpy(&stored, bytes.data() + kMerlHeaderBytes + i * sizeof(double), sizeof(double));
    const double value = stored * kMerlScale[i / kMerlBins];
    if (!(std::abs(value) <= std::numeric_limits<float>::max())) {
      throw Error(source + ": number " + std::to_string(i), std::to_string(stored),
                  "a finite number");
    }
    values_[i] = stored < 0 ? -1 : static_cast<float>(value);
  }
}

std::size_t MerlBrdf::bin_of(const HalfDifference& angles) {
  constexpr double kPi = std::numbers::pi;
  const double azimuth = angles.azimuth < 0 ? angles.azimuth + kPi : angles.azimuth;
  const std::size_t half = part(std::sqrt(std::max(0.0, angles.half) / (kPi / 2)), kMerlHalf);
  const std::size_t difference = part(angles.difference / (kPi / 2), kMerlDifference);
  return (half * kMerlDifference + difference) * kMerlAzimuth + part(azimuth / kPi, kMerlAzimuth);
}

std::optional<Vec3d> MerlBrdf::value(const HalfDifference& angles, const DirectionPair&) const {
  const std::size_t bin = bin_of(angles);
  const Vec3d rgb(values_[bin], values_[kMerlBins + bin], values_[2 * kMerlBins + bin]);
  if (rgb.x < 0 || rgb.y < 0 || rgb.z < 0) return std::nullopt;
  return rgb;
}

}  // namespace rimlight

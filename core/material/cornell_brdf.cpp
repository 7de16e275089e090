#include "core/material/cornell_brdf.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/material/spectrum.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFloor = 1e-4;  // logarithms of values below are about the same
constexpr std::size_t kNeighbours = 8;
constexpr double kMostWavelengths = 1000;
constexpr double kLargestValue = 1e6;

/// The numbers of a text, one after the other, with their lines.
class NumberReader {
 public:
  NumberReader(std::string_view text, const std::string& source) : text_(text), source_(source) {}

  /// Whether a number, or something else, follows.
  bool skip_to_next() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else if (c == ' ' || c == '\t' || c == '\r' || c == '\n') {
        line_ += c == '\n';
        ++at_;
      } else {
        return true;
      }
    }
    return false;
  }

  double number(double low, double high, const std::string& what) {
    if (!skip_to_next()) throw Error(where(), "the end of the file", what);
    const std::size_t end = std::min(text_.find_first_of(" \t\r\n#", at_), text_.size());
    const std::string_view token = text_.substr(at_, end - at_);
    double value = 0;
    const auto [rest, failure] = std::from_chars(token.data(), token.data() + token.size(), value);
    const bool whole = failure == std::errc{} && rest == token.data() + token.size();
    if (!whole || !(value >= low && value <= high)) throw Error(where(), quote(token), what);
    at_ = end;
    return value;
  }

  std::string where() const { return source_ + ": line " + std::to_string(line_); }

 private:
  std::string_view text_;
  const std::string& source_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

std::vector<double> read_wavelengths(NumberReader& reader) {
  const double count = reader.number(1, kMostWavelengths, "a number of wavelengths, 1 to 1000");
  if (count != std::floor(count)) {
    throw Error(reader.where(), std::to_string(count), "a whole number of wavelengths");
  }
  std::vector<double> wavelengths;
  while (static_cast<double>(wavelengths.size()) < count) {
    wavelengths.push_back(reader.number(100, 10'000, "a wavelength of 100 to 10000 nm"));
    const std::size_t last = wavelengths.size() - 1;
    if (last == 0 || wavelengths[last] > wavelengths[last - 1]) continue;
    throw Error(reader.where(), std::to_string(wavelengths[last]), "wavelengths that rise");
  }
  return wavelengths;
}

Vec3d polar(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

HalfDifference read_angles(NumberReader& reader) {
  constexpr double kUpright = kPi / 2 + 1e-6;
  const std::string polar_range = "a polar angle in [0, π/2]", turn_range = "an azimuth in ±2π";
  std::array<double, 4> angles{};
  for (std::size_t i = 0; i < 4; ++i) {
    const bool is_polar = i % 2 == 0;
    angles[i] = reader.number(is_polar ? 0 : -6.2832, is_polar ? kUpright : 6.2832,
                              is_polar ? polar_range : turn_range);
  }
  return half_difference(polar(angles[0], angles[1]), polar(angles[2], angles[3]));
}

Vec3d point_of(const HalfDifference& angles) {
  const double half = 1.5 * std::sqrt(std::max(0.0, angles.half) * 2 / kPi);
  const double sine = std::sin(angles.difference);
  // Folded: the signs of both axes do not count.
  return {half, sine * std::abs(std::cos(angles.azimuth)),
          sine * std::abs(std::sin(angles.azimuth))};
}

/// The nearest points so far, by squared distance.
struct Neighbours {
  std::array<double, kNeighbours> squared;
  std::array<std::size_t, kNeighbours> index{};

  Neighbours() { squared.fill(std::numeric_limits<double>::infinity()); }

  void offer(double distance, std::size_t i) {
    if (!(distance < squared.back())) return;
    std::size_t at = kNeighbours - 1;
    for (; at > 0 && squared[at - 1] > distance; --at) {
      squared[at] = squared[at - 1];
      index[at] = index[at - 1];
    }
    squared[at] = distance;
    index[at] = i;
  }
};

}  // namespace

CornellBrdf::CornellBrdf(std::string_view text, const std::string& source) {
  NumberReader reader(text, source);
  const std::vector<double> wavelengths = read_wavelengths(reader);
  const SpectrumToRgb converter(wavelengths);
  std::vector<double> spectrum(wavelengths.size());
  while (reader.skip_to_next()) {
    points_.push_back(point_of(read_angles(reader)));
    for (double& value : spectrum) {
      value = reader.number(-kLargestValue, kLargestValue, "a BRDF value within ±1000000");
      value = std::max(value, 0.0);
    }
    const Vec3d rgb = converter.rgb(spectrum);
    Vec3d logarithm;
    for (int c = 0; c < 3; ++c) logarithm[c] = std::log(std::max(rgb[c], 0.0) + kFloor);
    logarithms_.push_back(logarithm);
  }
  if (points_.empty()) throw Error(reader.where(), "no sample", "at least one sample");
}

std::optional<Vec3d> CornellBrdf::value(const HalfDifference& angles, const DirectionPair&) const {
  const Vec3d at = point_of(angles);
  Neighbours nearest;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vec3d offset = points_[i] - at;
    nearest.offer(dot(offset, offset), i);
  }
  if (!(nearest.squared[0] <= kReach * kReach)) return std::nullopt;
  Vec3d sum;
  double weights = 0;
  for (std::size_t i = 0; i < std::min(kNeighbours, points_.size()); ++i) {
    const double weight = 1 / (nearest.squared[i] + 1e-16);
    sum += logarithms_[nearest.index[i]] * weight;
    weights += weight;
  }
  Vec3d rgb;
  for (int c = 0; c < 3; ++c) rgb[c] = std::max(0.0, std::exp(sum[c] / weights) - kFloor);
  return rgb;
}

}  // namespace rimlight

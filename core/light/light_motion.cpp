#include "core/light/light_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/check.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

/// Of a band with more, so many are chosen, evenly.
constexpr int kMostWaves = 64;

double smooth_step(double x) { return x * x * (3 - 2 * x); }

/// ∫ smooth_step from 0 to x; ½ at 1.
double smooth_step_integral(double x) { return x * x * x * (1 - x / 2); }

struct Wave {
  std::int64_t cycles;
  double cosine, sine;  // amplitudes
};

std::vector<Wave> make_waves(const FlickerSettings& settings) {
  Random random(settings.seed);
  const int band = settings.highest_cycles - settings.lowest_cycles + 1;
  const int count = std::min(band, kMostWaves);
  std::vector<Wave> waves;
  for (int i = 0; i < count; ++i) {
    // Uniform over its part of the band; each cycle count in turn where all have room.
    const double place = (i + (band > count ? random.uniform() : 0)) * band / count;
    const double amplitude = random.uniform(0.5, 1);
    const double phase = random.uniform(0, 2 * std::numbers::pi);
    waves.push_back({settings.lowest_cycles + std::min(static_cast<int>(place), band - 1),
                     amplitude * std::cos(phase), amplitude * std::sin(phase)});
  }
  return waves;
}

/// n(f) before it is scaled, for one period: [period].
std::vector<double> sum_of_waves(const std::vector<Wave>& waves, int period) {
  std::vector<double> cosines, sines;  // of 2π j / period
  for (int j = 0; j < period; ++j) {
    cosines.push_back(std::cos(2 * std::numbers::pi * j / period));
    sines.push_back(std::sin(2 * std::numbers::pi * j / period));
  }
  std::vector<double> sum(static_cast<std::size_t>(period));
  for (int frame = 0; frame < period; ++frame) {
    for (const Wave& wave : waves) {
      const auto j = static_cast<std::size_t>(wave.cycles * frame % period);
      sum[static_cast<std::size_t>(frame)] += wave.cosine * cosines[j] + wave.sine * sines[j];
    }
  }
  return sum;
}

}  // namespace

double eased_share(int frame, int frames) {
  RIMLIGHT_CHECK(frame >= 0 && frames >= 2);
  return frame >= frames - 1 ? 1 : smooth_step(static_cast<double>(frame) / (frames - 1));
}

double EasedTurn::angle(int frame) const {
  RIMLIGHT_CHECK(frame >= 0 && frames >= 2);
  RIMLIGHT_CHECK(ease_in >= 0 && ease_out >= 0 && ease_in + ease_out <= frames - 1);
  const int last = frames - 1;
  const int now = std::min(frame, last);
  double steps = std::clamp(now - ease_in, 0, last - ease_in - ease_out);  // at full speed
  if (ease_in > 0) {
    steps += ease_in * smooth_step_integral(std::min(static_cast<double>(now) / ease_in, 1.0));
  }
  if (ease_out > 0) {
    const double left = std::min(static_cast<double>(last - now) / ease_out, 1.0);
    steps += ease_out * (0.5 - smooth_step_integral(left));
  }
  return peak * steps;
}

Quaternion EasedTurn::rotation(int frame) const { return axis_angle(axis, angle(frame)); }

SpherePath::SpherePath(std::vector<Vec3d> points) : points_(std::move(points)) {
  constexpr double kRounding = 1e-9;
  RIMLIGHT_CHECK(!points_.empty());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    RIMLIGHT_CHECK(std::abs(rimlight::length(points_[i]) - 1) <= kRounding);
    if (i == 0) {
      ends_.push_back(0);
      continue;
    }
    const Vec3d& a = points_[i - 1];
    const Vec3d& b = points_[i];
    const double angle = std::atan2(rimlight::length(cross(a, b)), dot(a, b));
    RIMLIGHT_CHECK(angle < std::numbers::pi - kRounding);
    ends_.push_back(ends_.back() + angle);
  }
}

Vec3d SpherePath::at(double share) const {
  const double way = share * length();
  if (!(way > 0)) return points_.front();
  if (way >= length()) return points_.back();
  const auto next = static_cast<std::size_t>(std::upper_bound(ends_.begin(), ends_.end() - 1, way) -
                                             ends_.begin());
  const Vec3d& from = points_[next - 1];
  const Vec3d& to = points_[next];
  const Vec3d axis = cross(from, to);
  return normalized(rotated(axis_angle(axis, way - ends_[next - 1]), from));
}

Flicker::Flicker(const FlickerSettings& settings) {
  const int period = settings.frames - 1;
  RIMLIGHT_CHECK(settings.amount >= 0 && settings.amount <= 1);
  RIMLIGHT_CHECK(settings.lowest_cycles >= 1);
  RIMLIGHT_CHECK(settings.lowest_cycles <= settings.highest_cycles);
  RIMLIGHT_CHECK(2 * settings.highest_cycles < period);
  factors_ = sum_of_waves(make_waves(settings), period);
  double largest = 0;
  for (const double value : factors_) largest = std::max(largest, std::abs(value));
  RIMLIGHT_CHECK(largest > 0);
  for (double& value : factors_) value = 1 + settings.amount * (value / largest);
  factors_.push_back(factors_.front());
}

double Flicker::factor(int frame) const {
  RIMLIGHT_CHECK(frame >= 0);
  return factors_[std::min(static_cast<std::size_t>(frame), factors_.size() - 1)];
}

}  // namespace rimlight

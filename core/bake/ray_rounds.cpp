#include "core/bake/ray_rounds.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rimlight {
namespace {

constexpr int kLeastRound = 4;

int largest_round(const RaySettings& settings) {
  return std::max(kLeastRound, static_cast<int>(std::sqrt(settings.most_rays / 4.0)));
}

}  // namespace

std::vector<Sample2> round_points(int s, Random& random) {
  const auto cells = static_cast<std::size_t>(s) * static_cast<std::size_t>(s);
  std::vector<Sample2> points(kReplicates * cells);
  const double width = 0.5 / s;
  for (std::size_t cell = 0; cell < cells; ++cell) {
    const double u = static_cast<double>(cell % static_cast<std::size_t>(s)) / s;
    const double v = static_cast<double>(cell / static_cast<std::size_t>(s)) / s;
    std::array<std::size_t, kReplicates> dealt = {0, 1, 2, 3};
    for (std::size_t i = kReplicates - 1; i > 0; --i) {
      std::swap(dealt[i], dealt[random.below(i + 1)]);
    }
    for (std::size_t quarter = 0; quarter < kReplicates; ++quarter) {
      const Sample2 at = random_sample(random);
      points[dealt[quarter] * cells + cell] = {
          u + (static_cast<double>(quarter % 2) + at.u) * width,
          v + (static_cast<double>(quarter / 2) + at.v) * width};
    }
  }
  return points;
}

int first_round(const RaySettings& settings) {
  // A ray of weight 2π/N changes coefficient i by that times Y_i, and the rms of all Y_i at a
  // direction is 1/√4π.
  const double rays = std::sqrt(std::numbers::pi) / settings.error;
  return std::clamp(static_cast<int>(std::ceil(std::sqrt(rays / 4))), kLeastRound,
                    largest_round(settings));
}

int next_round(const RaySettings& settings, int s, double error) {
  const int largest = largest_round(settings);
  if (error <= settings.error || s >= largest) return 0;
  // The error of stratified rays against the edges of occluders falls with N^−3/4, s^−3/2.
  const double wanted = 1.05 * s * std::pow(error / settings.error, 2.0 / 3);
  return std::clamp(static_cast<int>(std::ceil(std::min(wanted, 1e6))), s + (s + 3) / 4, largest);
}

double ReplicateMean::mean(std::size_t i) const {
  double sum = 0;
  for (std::size_t r = 0; r < kReplicates; ++r) sum += sums_[r * coefficients() + i];
  return sum / kReplicates;
}

double ReplicateMean::error_squared(std::size_t i) const {
  const double middle = mean(i);
  double squares = 0;
  for (std::size_t r = 0; r < kReplicates; ++r) {
    const double difference = sums_[r * coefficients() + i] - middle;
    squares += difference * difference;
  }
  constexpr double kOfMean = kReplicates * (kReplicates - 1);
  return squares / kOfMean;
}

double ReplicateMean::error() const {
  double squares = 0;
  for (std::size_t i = 0; i < coefficients(); ++i) {
    const double middle = mean(i);
    for (std::size_t r = 0; r < kReplicates; ++r) {
      const double difference = sums_[r * coefficients() + i] - middle;
      squares += difference * difference;
    }
  }
  constexpr double kOfMean = kReplicates * (kReplicates - 1);
  return std::sqrt(squares / (kOfMean * static_cast<double>(coefficients())));
}

}  // namespace rimlight

#include "core/vertices/coarse_error.h"

#include <algorithm>

namespace rimlight {
namespace {

double square_between(const TileImage& image, std::size_t a, std::size_t b) {
  double square = 0;
  for (const auto& channel : image.channel) {
    const double difference = static_cast<double>(channel[a]) - static_cast<double>(channel[b]);
    square += difference * difference;
  }
  return square;
}

}  // namespace

TileVariation& TileVariation::operator+=(const TileVariation& other) {
  for (std::size_t i = 0; i < lags.size(); ++i) {
    lags[i].near += other.lags[i].near;
    lags[i].far += other.lags[i].far;
    lags[i].near_pairs += other.lags[i].near_pairs;
    lags[i].far_pairs += other.lags[i].far_pairs;
  }
  known += other.known;
  return *this;
}

double TileVariation::square_of_missing() const {
  double sum = 0;
  for (const Lag& lag : lags) {
    if (lag.near_pairs == 0 || lag.far_pairs == 0 || !(lag.far > 0)) continue;
    const double near_mean = lag.near / static_cast<double>(lag.near_pairs);
    const double far_mean = lag.far / static_cast<double>(lag.far_pairs);
    sum += static_cast<double>(known) * near_mean * std::clamp(near_mean / far_mean, 0.25, 1.0);
  }
  return sum;
}

TileVariation variation_of(const TileImage& image, int width, int height) {
  constexpr int kSide = static_cast<int>(TileImage::kSide);
  constexpr std::array<std::array<int, 2>, 3> kWays{{{1, 0}, {0, 1}, {1, 1}}};
  TileVariation variation;
  for (int y = 0; y < height; y += 2) {
    for (int x = 0; x < width; x += 2) {
      ++variation.known;
      const auto here = static_cast<std::size_t>(y * kSide + x);
      for (std::size_t i = 0; i < kWays.size(); ++i) {
        TileVariation::Lag& lag = variation.lags[i];
        for (const int reach : {2, 4}) {
          const int at_x = x + reach * kWays[i][0], at_y = y + reach * kWays[i][1];
          if (at_x >= width || at_y >= height) continue;
          const double square =
              square_between(image, here, static_cast<std::size_t>(at_y * kSide + at_x));
          (reach == 2 ? lag.near : lag.far) += square;
          ++(reach == 2 ? lag.near_pairs : lag.far_pairs);
        }
      }
    }
  }
  return variation;
}

}  // namespace rimlight

#pragma once

#include <cstdint>

namespace rimlight {

/// Mixes 64 bits (the finaliser of SplitMix64; Steele, Lea and Flood 2014).
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// A seeded generator of 64-bit numbers (SplitMix64). Cheap to make: one for each tile, pixel or
/// path, seeded by its place, so that results do not depend on the order of the work.
class Random {
 public:
  /// Streams of different (seed, stream) are independent for all that we ask of them.
  explicit constexpr Random(std::uint64_t seed, std::uint64_t stream = 0)
      : state_(mix_bits(seed + 0x9e3779b97f4a7c15ULL) ^
               mix_bits(stream * 0xd1342543de82ef95ULL + 1)) {}

  constexpr std::uint64_t bits() {
    state_ += 0x9e3779b97f4a7c15ULL;
    return mix_bits(state_);
  }
  /// In [0, 1), 53 bits.
  constexpr double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  /// In [0, 1), 24 bits: never rounds up to 1.
  constexpr float uniform_float() { return static_cast<float>(bits() >> 40) * 0x1p-24f; }
  /// In [low, high).
  constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In [0, count): bias below count / 2⁶⁴. count must not be 0.
  constexpr std::uint64_t below(std::uint64_t count) {
    __extension__ using Wide = unsigned __int128;
    return static_cast<std::uint64_t>((static_cast<Wide>(bits()) * count) >> 64);
  }

 private:
  std::uint64_t state_;
};

}  // namespace rimlight

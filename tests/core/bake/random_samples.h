#pragma once

#include <cstdint>

#include "core/bake/group.h"

namespace rimlight::test {

/// What a group's camera rays might find: each pixel's hits lie on one plane, or on two where
/// `edges` (most pixels); some pixels miss, wholly or with some rays. Positions are all different.
/// Models: Lambert, and where `lobes` also Phong and Cook–Torrance.
struct SampleKind {
  int rays = 16;
  bool edges = false;
  bool lobes = false;
};
GroupSamples random_samples(const SampleKind& kind, std::uint64_t seed);

}  // namespace rimlight::test

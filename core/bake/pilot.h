#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/bake/group_baker.h"

namespace rimlight {

/// Groups that stand for an image: a seeded sample of those with geometry in sight.
std::vector<std::size_t> sample_groups(const GroupBaker& baker, std::size_t count,
                                       std::uint64_t seed);

/// The step (StorageStep, its least energy the default) at which a sample of the image still has
/// `psnr_db` under the worst check light. Bakes the sample groups once, in parallel, and stores
/// each at steps an octave apart; between them decibels are interpolated. The finest when even that
/// is not good enough.
float pilot_step(const GroupBaker& baker, const std::vector<std::size_t>& first_receivers,
                 const std::vector<CheckLight>& lights, double psnr_db);

}  // namespace rimlight

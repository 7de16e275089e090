#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/bake/group_baker.h"

namespace rimlight {

/// Groups that stand for an image: a seeded sample of those with geometry in sight.
std::vector<std::size_t> sample_groups(const GroupBaker& baker, std::size_t count,
                                       std::uint64_t seed);

/// The threshold on a block's largest |m| at which a sample of the image still has `psnr_db` under
/// the worst check light. Bakes the sample groups (in parallel); each group's image is split by the
/// magnitude of the blocks it comes from, in half octaves, so that one bake tells every threshold.
/// Returns 0 when no threshold is small enough.
double pilot_threshold(const GroupBaker& baker, const std::vector<std::size_t>& first_receivers,
                       const std::vector<CheckLight>& lights, double psnr_db);

}  // namespace rimlight

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/bake/check_lights.h"
#include "core/bake/group_source.h"

namespace rimlight {

/// Groups that stand for an image: a seeded sample of those that have receivers.
std::vector<std::size_t> sample_groups(const GroupSource& source, std::size_t count,
                                       std::uint64_t seed);

/// The step (StorageStep, its least energy the default) at which a sample of the image still has
/// `psnr_db` under the worst check light. Finds the sample groups' rows once, in parallel, and
/// stores each at steps an octave apart; between them decibels are interpolated. The finest when
/// even that is not good enough.
float pilot_step(const GroupSource& source, const std::vector<std::size_t>& first_receivers,
                 const std::vector<CheckLight>& lights, double psnr_db);

}  // namespace rimlight

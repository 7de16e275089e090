#pragma once

#include <cstddef>
#include <vector>

#include "core/bake/check_lights.h"
#include "core/import/imported_bake.h"

namespace rimlight {

/// The threshold on a block's largest |m| at which a sample of the covered groups still has
/// `psnr_db` under each check light, to half an octave; found by halving on the sample's dense
/// rows. Above 0.
double import_threshold(const ImportedTransport& transport, const std::vector<CheckLight>& lights,
                        double psnr_db);

}  // namespace rimlight

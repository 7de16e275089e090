#pragma once

#include <vector>

#include "core/report/stability.h"

namespace rimlight::stability {

// The table, part by part; one file each.
std::vector<StabilityCase> light_cases();
std::vector<StabilityCase> storage_cases();
std::vector<StabilityCase> drift_cases();
std::vector<StabilityCase> rotation_cases();
std::vector<StabilityCase> harmonics_cases();
std::vector<StabilityCase> interreflection_cases();
std::vector<StabilityCase> fits_cases();
std::vector<StabilityCase> materials_cases();
std::vector<StabilityCase> geometry_cases();
std::vector<StabilityCase> numbers_cases();
std::vector<StabilityCase> receivers_cases();
std::vector<StabilityCase> budgets_cases();

}  // namespace rimlight::stability

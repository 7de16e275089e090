#pragma once

#include <nlohmann/json.hpp>

#include "core/report/error_vs_time.h"

namespace rimlight {

/// {"experiment", "machine", "rows", …}: docs/formats/report.md has every field.
nlohmann::json to_json(const ErrorVsTimeReport& report);

}  // namespace rimlight

#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "core/report/error_vs_time.h"

namespace rimlight {

/// {"experiment", "machine", "rows", …}: docs/formats/report.md has every field.
nlohmann::json to_json(const ErrorVsTimeReport& report);

/// The rows, with a line of column names.
std::string to_csv(const ErrorVsTimeReport& report);

/// What the numbers were bought with: processor, threads.
nlohmann::json describe_machine();

/// Writes error-vs-time.json and .csv to a folder, made if need be. Throws Error.
void write_report(const ErrorVsTimeReport& report, const std::filesystem::path& folder);

}  // namespace rimlight

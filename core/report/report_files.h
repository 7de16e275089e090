#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace rimlight {

/// What the numbers were bought with: processor, threads.
nlohmann::json describe_machine();

/// A report's rows (an array of objects of the same names), with a line of column names.
std::string to_csv(const nlohmann::json& rows);

/// Writes EXPERIMENT.json and EXPERIMENT.csv of a report {"experiment", "machine", "rows", …} to a
/// folder, made if need be. Throws Error.
void write_report(const nlohmann::json& report, const std::filesystem::path& folder);

}  // namespace rimlight

#pragma once

#include <filesystem>

#include "core/import/import_bake.h"

namespace rimlight {

/// Says how an import went: as one JSON object on standard output, or in lines on standard error;
/// and warns there of what looks like a mistake.
void report_import(const ImportSummary& summary, const std::filesystem::path& folder, bool json);

}  // namespace rimlight

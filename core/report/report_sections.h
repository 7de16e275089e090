#pragma once

#include <vector>

#include "core/report/adaptive_sh.h"
#include "core/report/brdf_edit.h"
#include "core/report/error_vs_time.h"
#include "core/report/report_page.h"
#include "core/report/sh_policies.h"
#include "core/report/stability.h"
#include "core/report/storage_comparison.h"

namespace rimlight {

// What each experiment found, in words and tables; without its pictures.

ReportSection section_of(const ErrorVsTimeReport& report);
ReportSection section_of(const StorageComparison& comparison);
ReportSection section_of(const BrdfEditReport& report);
ReportSection section_of(const std::vector<AdaptiveShRow>& rows);
ReportSection section_of(const std::vector<ShPolicyRow>& rows);
ReportSection section_of(const std::vector<StabilityRow>& rows);

}  // namespace rimlight

#pragma once
#include <string>

#include "libslam/core/progress.h"
#include "libslam/report/html_report.h"

namespace slam::pages {

/// What the HTML report of a folder shows, read back from what compare(), buildMap(), explore(), reachGoal(),
/// bench or stress wrote there; figures of single runs are evaluated anew. The log, the truth and the plan
/// are looked for where they were, then in the folder; what is gone, and methods that are missing because the
/// work is not finished, the page says. The same folder gives the same page. Errors: InputError where the
/// folder is no such result, naming the file that is missing or broken.
report::ReportPage gatherReport(const std::string& folder, core::Progress& progress);

}  // namespace slam::pages

#pragma once
#include <string>
#include <vector>

#include "libslam/draw/curves.h"
#include "libslam/report/html_report.h"

namespace slam::pages {

/// Whether covariances are true, a reliability diagram: over the share of the errors that an ellipsoid should
/// hold, the share that it holds. Above the diagonal a method is conservative, below it overconfident.
/// A line per method, of its poses as they were given online and, where it states them, of the final ones,
/// over all pages that know it: runs of several seeds. From three runs on whiskers at 50 and 95 % are the
/// interval over runs (stats::consistency()), for the errors of one run depend on each other. Errors:
/// InputError that names the first folder, where no run has a covariance and a truth.
draw::Chart coverageChart(const std::vector<report::ReportPage>& pages, const std::string& folder);

}  // namespace slam::pages

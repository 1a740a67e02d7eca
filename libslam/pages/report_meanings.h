#pragma once
#include "libslam/report/html_report.h"

namespace slam::pages {

/// What the columns of our tables and the events of our methods mean, for the page's tooltips and legends.
void addMeanings(report::ReportPage& page);

}  // namespace slam::pages

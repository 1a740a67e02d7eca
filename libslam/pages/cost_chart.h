#pragma once
#include <string>
#include <vector>

#include "libslam/draw/curves.h"
#include "libslam/report/html_report.h"

namespace slam::pages {

/// CPU time a scan over the scans, two lines per method: the mean over each hundredth of the scans (of fewer
/// than a thousand, over each ten), and the 99 % quantile there, which says what scans wait for. Whether a
/// map grows dearer as it is driven on. More than 10,000 scans are counted in thousands. Several pages: each
/// method's label has its folder's name behind it. Errors: InputError that names the first folder, where no
/// run has times; ContractError unless there are as many folders as pages.
draw::Chart costChart(const std::vector<report::ReportPage>& pages, const std::vector<std::string>& folders,
                      bool is_log);

}  // namespace slam::pages

#pragma once
#include <string>
#include <vector>

#include "libslam/draw/box_plot.h"
#include "libslam/draw/curves.h"
#include "libslam/pictures/picture.h"
#include "libslam/report/html_report.h"
#include "libslam/table/table.h"

namespace slam::pages {

// The figures of papers, from what other commands wrote: what to hand to the pictures of room report.

/// One panel per run: its map, its path and the true one; under the method its position error (rmse), where a
/// truth is known. At most 8, the first ones. Errors: InputError that names the folder, where no run left a
/// map.
std::vector<pictures::Panel> mapPanels(const report::ReportPage& page, const std::string& folder);
/// The paths of all runs, and the true ones; without a truth they lie in the map frame.
std::vector<pictures::DrawnPath> allPaths(const report::ReportPage& page);
/// A panel per run with a path: that, its own true path and its own true plan, where these are known.
std::vector<pictures::Panel> pathPanels(const report::ReportPage& page);
/// Position error over time since the first scan, a line per method, smoothed (root mean square over a
/// fiftieth of the time, at least 1 s, which the axis says), the worst first. Errors: InputError that names
/// the folder, where no run has an error.
draw::Chart errorChart(const report::ReportPage& page, const std::string& folder, bool is_log);

/// Which runs of a sweep's results.csv.
struct SeedSelection {
  std::string metric = "ate_final_m";
  std::vector<std::string> where;    ///< "KEY=VALUE": rows whose column KEY holds VALUE
  std::vector<std::string> methods;  ///< empty: all
};
/// A chart for every combination of the axes that vary (world, robot, lidar, odometry, strategy, fault), a
/// box for every method with its parameters, in the order of the rows. Runs whose status is not "ok" count as
/// failed. Errors: InputError that begins with the path: a column that is not there, no row that was chosen,
/// more than 24 charts.
std::vector<draw::BoxChart> seedBoxes(const table::Table& results, const SeedSelection& selection,
                                      const std::string& path);

/// The explored share over time and over the path, a line per run found in the folders (what `explore`
/// wrote); runs with one strategy share a colour. A strategy that stands in several folders is named with its
/// folder. Errors: InputError for a folder without exploration.csv, or with a broken one.
std::vector<draw::Chart> explorationCharts(const std::vector<std::string>& folders);

}  // namespace slam::pages

#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::report {

/// A line of a chart; its colour goes by its label, among those of the page's chart.
struct PageCurve {
  std::string label;
  std::vector<core::Point2> points;  ///< in the axes' units, x ascending; what is not finite breaks the line
  std::vector<double> low, high;     ///< an interval round each point, NaN: none; empty: none at all
  std::vector<bool> broken;          ///< points to mark with a cross; empty: none
  std::string note;                  ///< what to say of it in the legend
};

/// A chart that can be read without script and asked with it: its values under the pointer, lines switched on
/// and off.
struct PageChart {
  std::string id, caption, x_title, y_title;  ///< with units: "path (m)"
  std::vector<PageCurve> curves;
  double y_max = 0;       ///< the axis ends here; 0: where the curves do. It begins at 0
  double duration_s = 0;  ///< above 0: x is the time of the replay in seconds, and the axis ends here
};

/// The chart as `figure`: SVG with its legend. Both axes from 0, or the lower logarithmic where all x are
/// above 0 and spread over more than a factor of 50. Long lines are thinned to what differs by less than half
/// a unit of the drawing. "" where no point is finite. The same chart gives the same bytes.
std::string chartElement(const PageChart& chart);

}  // namespace slam::report

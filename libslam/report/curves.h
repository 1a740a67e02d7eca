#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::report {

/// A line of a chart. Lines with one label share a colour and a row of the legend.
struct Curve {
  std::string label;
  std::vector<core::Point2> points;  ///< in the axes' units; a point that is not finite breaks the line
};

struct Chart {
  std::string x_title, y_title;  ///< with units: "time (s)"
  std::vector<Curve> curves;
  double y_max = 0;  ///< the axis ends here; 0 = where the curves do
};

/// Charts side by side, each with its own axes from 0 on, under one title and over one legend. PNG as the
/// other pictures (picture.h): the same input gives the same bytes. REQUIRES 1 to 4 charts (ContractError).
void drawCharts(const std::vector<Chart>& charts, const std::string& title, const std::string& png_path);

}  // namespace slam::report

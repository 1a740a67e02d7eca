#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/draw/canvas.h"

namespace slam::draw {

/// A line of a chart. Lines with one label share a colour and a row of the legend.
struct Curve {
  enum class Style {
    kLine,
    kMarked,  ///< with a dot at each point
    /// From the first point to the second, with an end at either: an interval. A second one at y = +infinity:
    /// an arrow that leaves the chart at its top.
    kWhisker
  };
  std::string label;
  std::vector<core::Point2> points;  ///< in the axes' units; a point that is not finite breaks the line
  Style style = Style::kLine;
};

struct Chart {
  std::string x_title, y_title;  ///< with units: "time (s)"
  std::vector<Curve> curves;
  double y_max = 0;  ///< a linear axis ends here; 0 = where the curves do
  bool x_log = false, y_log = false;
};

/// Charts, each with its own axes (linear ones from 0 on; values that a logarithm has no place for are left
/// out), under one title, unless it is empty, and over one legend: on the screen side by side, on paper as
/// many side by side as its width holds. Marked points and whiskers of different labels stand a little apart.
/// Under the rules of the pictures in picture.h. REQUIRES 1 to 4 charts (ContractError).
void drawCharts(const std::vector<Chart>& charts, const std::string& title, const std::string& file,
                const Paper& paper = {});

}  // namespace slam::draw

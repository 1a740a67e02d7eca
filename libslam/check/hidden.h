#pragma once
#include <opencv2/core.hpp>

#include "libslam/check/sheet.h"

namespace slam::check {

/// Free space amid the walls before mending, and how much of it is unknown afterwards. Cells.
struct HiddenSpace {
  int before = 0, hidden = 0;
};

/// `before`: the cells as they were read, as the sheet's lie; `drawn`: once text and dimension lines are gone
/// and before the outside is taken away. Amid the walls is what the paper around a drawing does not reach
/// through gaps of up to 4 m, of a map everything.
HiddenSpace hiddenSpace(const Sheet& sheet, const cv::Mat& before, const cv::Mat& drawn);

}  // namespace slam::check

#include "libslam/drafting/passages.h"

#include <algorithm>
#include <cmath>

#include "libslam/drafting/clearance_flood.h"
#include "libslam/drafting/regions.h"

namespace slam::drafting {
namespace {

constexpr double kMostCells = 4e6;
constexpr double kWider = 1.5;

/// The largest clearance of each block of `step` cells; where a wall might lie within the block there is no
/// way.
cv::Mat thinned(const cv::Mat& distance, int step) {
  cv::Mat small((distance.rows + step - 1) / step, (distance.cols + step - 1) / step, CV_32F, cv::Scalar(0));
  for (int y = 0; y < distance.rows; ++y)
    for (int x = 0; x < distance.cols; ++x) {
      float& most = small.at<float>(y / step, x / step);
      most = std::max(most, distance.at<float>(y, x));
    }
  small.setTo(0, small < 1.5 * step);
  return small;
}

}  // namespace

Passages findPassages(const cv::Mat& free, double least_area) {
  const int step =
      std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(free.total()) / kMostCells))));
  const cv::Mat distance = clearance(free, true);
  ClearanceFlood flood(step == 1 ? distance : thinned(distance, step));
  const double block = static_cast<double>(step) * step;
  Passages found;
  const auto isSpace = [&](const Basin& side, double here) {
    const double area = static_cast<double>(side.area) * block;
    return side.peak > kWider * here && area >= least_area && area > 16 * here * here;
  };
  flood.run([&](const cv::Point& at, double here, const Basin& a, const Basin& b) {
    if (isSpace(a, here) && isSpace(b, here)) found.passages.push_back({at * step, widthOfGap(here)});
    return true;
  });
  const Regions regions = regionsOf(free, 4);
  for (int label = 1; label < regions.count; ++label) found.rooms += regions.area(label) >= least_area;
  if (found.rooms > 0) found.rooms += static_cast<int>(found.passages.size());
  return found;
}

}  // namespace slam::drafting

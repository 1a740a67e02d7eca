#include "libslam/check/hidden.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace slam::check {
namespace {

constexpr double kWidestGap_m = 4;

/// What the paper reaches where no gap of the walls up to kWidestGap_m lets it through: from beyond the
/// picture's edge over cells that far from every wall, and back to the walls from there.
cv::Mat paperAround(const Sheet& sheet, const cv::Mat& drawn) {
  const cv::Mat walls = drawn == static_cast<int>(world::Cell::kOccupied);
  const double radius = std::min(sheet.toPixels(kWidestGap_m / 2), 4000.0);
  const int margin = static_cast<int>(std::ceil(radius)) + 2;
  cv::Mat page;
  cv::copyMakeBorder(walls, page, margin, margin, margin, margin, cv::BORDER_CONSTANT, cv::Scalar(0));
  const cv::Mat reached = reachedFromEdge(~grown(page, radius));
  return grown(reached, radius)(cv::Rect(margin, margin, walls.cols, walls.rows)).clone();
}

}  // namespace

HiddenSpace hiddenSpace(const Sheet& sheet, const cv::Mat& before, const cv::Mat& drawn) {
  cv::Mat amid = before == static_cast<int>(world::Cell::kFree);
  if (!sheet.is_map) amid &= ~paperAround(sheet, drawn);
  return {cv::countNonZero(amid), cv::countNonZero(amid & sheet.mask(world::Cell::kUnknown))};
}

}  // namespace slam::check

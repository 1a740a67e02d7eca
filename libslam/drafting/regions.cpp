#include "libslam/drafting/regions.h"

#include <algorithm>
#include <cmath>

namespace slam::drafting {

cv::Rect Regions::box(int label) const {
  return {stats.at<int>(label, cv::CC_STAT_LEFT), stats.at<int>(label, cv::CC_STAT_TOP),
          stats.at<int>(label, cv::CC_STAT_WIDTH), stats.at<int>(label, cv::CC_STAT_HEIGHT)};
}

cv::Point Regions::anyPixel(int label) const {
  const cv::Rect area = box(label);
  for (int y = area.y; y < area.br().y; ++y)
    for (int x = area.x; x < area.br().x; ++x)
      if (labels.at<int>(y, x) == label) return {x, y};
  return area.tl();
}

Regions regionsOf(const cv::Mat& mask, int connectivity) {
  Regions regions;
  regions.count =
      cv::connectedComponentsWithStats(mask, regions.labels, regions.stats, regions.centroids, connectivity);
  return regions;
}

cv::Mat maskOf(const Regions& regions, const std::vector<char>& chosen) {
  cv::Mat mask(regions.labels.size(), CV_8U);
  for (int y = 0; y < mask.rows; ++y) {
    const int* label = regions.labels.ptr<int>(y);
    auto* out = mask.ptr<std::uint8_t>(y);
    for (int x = 0; x < mask.cols; ++x) out[x] = chosen[static_cast<size_t>(label[x])] ? 255 : 0;
  }
  return mask;
}

std::vector<char> labelsUnder(const Regions& regions, const cv::Mat& mask) {
  std::vector<char> under(static_cast<size_t>(regions.count), 0);
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (mask.at<std::uint8_t>(y, x)) under[static_cast<size_t>(regions.labels.at<int>(y, x))] = 1;
  under[0] = 0;
  return under;
}

cv::Mat reachedFromEdge(const cv::Mat& free) {
  const Regions regions = regionsOf(free, 4);
  cv::Mat edge(free.size(), CV_8U, cv::Scalar(0));
  cv::rectangle(edge, cv::Rect(0, 0, edge.cols, edge.rows), cv::Scalar(255));
  return maskOf(regions, labelsUnder(regions, edge));
}

cv::Mat disc(double radius) {
  const int reach = static_cast<int>(std::floor(radius));
  cv::Mat brush(2 * reach + 1, 2 * reach + 1, CV_8U);
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x)
      brush.at<std::uint8_t>(y + reach, x + reach) = x * x + y * y <= radius * radius;
  return brush;
}

cv::Mat clearance(const cv::Mat& mask, bool edge_counts) {
  cv::Mat padded, distance;
  cv::copyMakeBorder(mask, padded, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(edge_counts ? 0 : 255));
  cv::distanceTransform(padded, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return distance(cv::Rect(1, 1, mask.cols, mask.rows)).clone();
}

cv::Mat grown(const cv::Mat& mask, double radius) {
  if (cv::countNonZero(mask) == 0) return mask.clone();
  if (radius <= 3) {  // then the brush is faster, and the same
    cv::Mat dilated;
    cv::dilate(mask, dilated, disc(radius));
    return dilated;
  }
  cv::Mat distance;
  cv::distanceTransform(~mask, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return distance <= radius;
}

cv::Mat thickStrokes(const cv::Mat& ink, double diameter) {
  // A stroke of n cells has its middle (n + 1) / 2 from the paper; the page's edge is no paper.
  const double least = (diameter + 1) / 2;
  const cv::Mat middle = clearance(ink, false) >= least;
  return grown(middle, least - 0.4) & ink;
}

}  // namespace slam::drafting

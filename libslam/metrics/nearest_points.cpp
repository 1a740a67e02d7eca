#include "libslam/metrics/nearest_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slam::metrics {

NearestPoints::NearestPoints(std::vector<core::Point2> points) : points_(std::move(points)) {
  sort(0, points_.size(), true);
}

double NearestPoints::distance(const core::Point2& p) const {
  double best_squared = std::numeric_limits<double>::infinity();
  search(0, points_.size(), true, p, best_squared);
  return std::sqrt(best_squared);
}

void NearestPoints::sort(size_t begin, size_t end, bool by_x) {
  if (end - begin < 2) return;
  const size_t middle = begin + (end - begin) / 2;
  const auto at = [this](size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [by_x](const core::Point2& a, const core::Point2& b) {
    return by_x ? a.x < b.x : a.y < b.y;
  });
  sort(begin, middle, !by_x);
  sort(middle + 1, end, !by_x);
}

void NearestPoints::search(size_t begin, size_t end, bool by_x, const core::Point2& p,
                           double& best_squared) const {
  if (begin == end) return;
  const size_t middle = begin + (end - begin) / 2;
  const double dx = p.x - points_[middle].x, dy = p.y - points_[middle].y;
  best_squared = std::min(best_squared, dx * dx + dy * dy);
  const double to_split = by_x ? dx : dy;
  const bool below_first = to_split < 0;
  search(below_first ? begin : middle + 1, below_first ? middle : end, !by_x, p, best_squared);
  if (to_split * to_split >= best_squared) return;
  search(below_first ? middle + 1 : begin, below_first ? end : middle, !by_x, p, best_squared);
}

}  // namespace slam::metrics

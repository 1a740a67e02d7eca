#include "libslam/draw/outline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace slam::draw {
namespace {

double squaredDistance(const core::Point2& p, const core::Point2& from, const core::Point2& to) {
  const double dx = to.x - from.x, dy = to.y - from.y, length2 = dx * dx + dy * dy;
  const double along = length2 > 0 ? ((p.x - from.x) * dx + (p.y - from.y) * dy) / length2 : 0;
  const double share = std::clamp(along, 0.0, 1.0);
  const double x = p.x - from.x - share * dx, y = p.y - from.y - share * dy;
  return x * x + y * y;
}

}  // namespace

std::vector<core::Point2> fewerPoints(const std::vector<core::Point2>& points, double tolerance_m) {
  if (points.size() < 3) return points;
  std::vector<char> is_kept(points.size(), 0);
  is_kept.front() = is_kept.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> pieces = {{0, points.size() - 1}};
  while (!pieces.empty()) {
    const auto [first, last] = pieces.back();
    pieces.pop_back();
    std::size_t farthest = first;
    double most = tolerance_m * tolerance_m;
    for (std::size_t i = first + 1; i < last; ++i)
      if (const double distance = squaredDistance(points[i], points[first], points[last]); distance > most)
        most = distance, farthest = i;
    if (farthest == first) continue;
    is_kept[farthest] = 1;
    pieces.emplace_back(first, farthest);
    pieces.emplace_back(farthest, last);
  }
  std::vector<core::Point2> fewer;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (is_kept[i]) fewer.push_back(points[i]);
  return fewer;
}

std::vector<std::vector<core::Point2>> outline(const std::vector<core::Point2>& points, double tolerance_m) {
  const auto isFinite = [](const core::Point2& p) { return std::isfinite(p.x) && std::isfinite(p.y); };
  std::vector<std::vector<core::Point2>> pieces;
  for (auto begin = points.begin(); begin != points.end();) {
    begin = std::find_if(begin, points.end(), isFinite);
    const auto end = std::find_if_not(begin, points.end(), isFinite);
    if (begin != end) pieces.push_back(fewerPoints({begin, end}, tolerance_m));
    begin = end;
  }
  return pieces;
}

}  // namespace slam::draw

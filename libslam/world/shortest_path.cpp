#include "libslam/world/shortest_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <tuple>

namespace slam::world {
namespace {

class Search {
 public:
  Search(const Plan& plan, const core::Point2& from, const core::Point2& to, double radius_m,
         double tolerance_m)
      : plan_(plan),
        from_(from),
        to_(to),
        radius_m_(radius_m),
        tolerance_m_(tolerance_m),
        fits_(plan.cells.size(), -1),
        parent_(plan.cells.size(), kNone),
        cost_(plan.cells.size(), std::numeric_limits<double>::infinity()) {}

  /// The points of the way, or none.
  std::vector<core::Point2> run() {
    if (discCollides(plan_, from_, radius_m_)) return {};
    const core::Point2 cell = pointToCells(plan_, from_);
    start_ =
        static_cast<size_t>(std::floor(cell.y)) * plan_.columns + static_cast<size_t>(std::floor(cell.x));
    fits_[start_] = 1;
    const core::Point2 goal_cell = pointToCells(plan_, to_);
    const double column = std::floor(goal_cell.x), row = std::floor(goal_cell.y);
    if (column >= 0 && row >= 0 && column < plan_.columns && row < plan_.rows)
      goal_ = static_cast<size_t>(row) * plan_.columns + static_cast<size_t>(column);
    cost_[start_] = 0;
    open(start_);
    while (!open_.empty()) {
      const auto [estimate, cost, index] = open_.top();
      open_.pop();
      if (cost > cost_[index]) continue;
      if (core::distance(pointOf(index), to_) <= tolerance_m_) return trace(index);
      expand(index);
    }
    return {};
  }

 private:
  static constexpr size_t kNone = static_cast<size_t>(-1);

  core::Point2 pointOf(size_t index) const {
    if (index == start_) return from_;
    if (index == goal_) return to_;
    const size_t column = index % plan_.columns, row = index / plan_.columns;
    return cellsToPoint(plan_, {static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5});
  }

  bool fits(size_t index) {
    if (fits_[index] < 0) fits_[index] = !discCollides(plan_, pointOf(index), radius_m_);
    return fits_[index] != 0;
  }

  void open(size_t index) {
    const double rest_m = std::max(0.0, core::distance(pointOf(index), to_) - tolerance_m_);
    open_.push({cost_[index] + rest_m, cost_[index], index});
  }

  void expand(size_t index) {
    const int column = static_cast<int>(index % plan_.columns), row = static_cast<int>(index / plan_.columns);
    for (int dr = -1; dr <= 1; ++dr)
      for (int dc = -1; dc <= 1; ++dc) {
        if (!plan_.contains(column + dc, row + dr)) continue;
        const size_t next = static_cast<size_t>(row + dr) * plan_.columns + (column + dc);
        const double cost = cost_[index] + core::distance(pointOf(index), pointOf(next));
        if (cost >= cost_[next] || !fits(next)) continue;
        cost_[next] = cost;
        parent_[next] = index;
        open(next);
      }
  }

  std::vector<core::Point2> trace(size_t index) const {
    std::vector<core::Point2> points;
    for (; index != kNone; index = parent_[index]) points.push_back(pointOf(index));
    std::reverse(points.begin(), points.end());
    return points;
  }

  const Plan& plan_;
  core::Point2 from_, to_;
  double radius_m_, tolerance_m_;
  size_t start_ = 0, goal_ = kNone;  ///< their cells stand for the places themselves
  std::vector<signed char> fits_;    ///< -1 not known yet
  std::vector<size_t> parent_;
  std::vector<double> cost_;
  using Entry = std::tuple<double, double, size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open_;
};

bool isFreeBetween(const Plan& plan, const core::Point2& a, const core::Point2& b, double radius_m) {
  const int steps = static_cast<int>(std::ceil(core::distance(a, b) / (0.5 * plan.resolution_m)));
  for (int i = 1; i < steps; ++i) {
    const double s = static_cast<double>(i) / steps;
    if (discCollides(plan, {a.x + s * (b.x - a.x), a.y + s * (b.y - a.y)}, radius_m)) return false;
  }
  return true;
}

std::vector<core::Point2> pulledTight(const Plan& plan, const std::vector<core::Point2>& points,
                                      double radius_m) {
  std::vector<core::Point2> corners{points.front()};
  for (size_t i = 2; i < points.size(); ++i)
    if (!isFreeBetween(plan, corners.back(), points[i], radius_m)) corners.push_back(points[i - 1]);
  if (points.size() > 1) corners.push_back(points.back());
  return corners;
}

}  // namespace

std::optional<DiscPath> shortestPath(const Plan& plan, const core::Point2& from, const core::Point2& to,
                                     double radius_m, double tolerance_m) {
  auto points = Search(plan, from, to, radius_m, tolerance_m).run();
  if (points.empty()) return std::nullopt;
  DiscPath path;
  path.corners = pulledTight(plan, points, radius_m);
  for (size_t i = 1; i < path.corners.size(); ++i)
    path.length_m += core::distance(path.corners[i - 1], path.corners[i]);
  return path;
}

}  // namespace slam::world

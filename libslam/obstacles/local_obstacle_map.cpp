#include "libslam/obstacles/local_obstacle_map.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"

namespace slam::obstacles {
namespace {

bool isFinite(const core::Point2& p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}

/// Of two points closer than `distance_m` the earlier one stays; the order of what stays is kept.
void keepOneOfTwins(std::vector<core::Point2>& points, double distance_m) {
  const double square_m2 = distance_m * distance_m;  // every pair is asked: no roots
  std::vector<core::Point2> kept;
  for (const auto& p : points) {
    const bool has_twin = std::any_of(kept.begin(), kept.end(), [&](const core::Point2& q) {
      const double dx = q.x - p.x, dy = q.y - p.y;
      return dx * dx + dy * dy < square_m2;
    });
    if (!has_twin) kept.push_back(p);
  }
  points = std::move(kept);
}

template <class Predicate>
void dropWhere(std::vector<core::Point2>& points, Predicate predicate) {
  points.erase(std::remove_if(points.begin(), points.end(), predicate), points.end());
}

}  // namespace

LocalObstacleOptions::LocalObstacleOptions() {
  table().setDefaults(*this);
}

const files::ParameterTable<LocalObstacleOptions>& LocalObstacleOptions::table() {
  using O = LocalObstacleOptions;
  static const files::ParameterTable<O> rows(
      "obstacles", {{"width_m", &O::width_m, 5.0, 0.01, 1000.0, "of the local zone, half to either side"},
                    {"front_m", &O::front_m, 4.0, 0.0, 1000.0, "how far the local zone reaches ahead"},
                    {"rear_m", &O::rear_m, 2.0, 0.0, 1000.0, "how far the local zone reaches behind"},
                    {"merge_distance_m", &O::merge_distance_m, 0.05, 0.0, 10.0,
                     "of two remembered points closer than this one is kept"},
                    {"max_points", &O::max_points, 1000, 1, 10000, "most points; the oldest go first"}});
  return rows;
}

std::vector<core::Point2> pointsWithin(const VisibleArea& area, const std::vector<core::Point2>& p_robot) {
  std::vector<core::Point2> within;
  for (const auto& p : p_robot)
    if (area.contains(p)) within.push_back(p);
  return within;
}

LocalObstacleMap::LocalObstacleMap(const LocalObstacleOptions& options) : options_(options) {}

void LocalObstacleMap::clear() {
  points_.clear();
  remembered_ = 0;
}

bool LocalObstacleMap::isInZone(const core::Point2& p_robot) const {
  return std::abs(p_robot.y) <= options_.width_m / 2 && p_robot.x <= options_.front_m &&
         p_robot.x >= -options_.rear_m;
}

void LocalObstacleMap::update(double turn_rad, double travel_m, const VisibleArea& visible,
                              const std::vector<core::Point2>& seen) {
  tick(core::cos(turn_rad), core::sin(turn_rad), {travel_m, 0}, visible, seen);
}

void LocalObstacleMap::update(const core::Pose2& T_previous_robot, const VisibleArea& visible,
                              const std::vector<core::Point2>& seen) {
  // The robot's shift in the axes that it has afterwards, in which the points are shifted.
  const auto [sine, cosine] = core::sinCos(T_previous_robot.phi);
  const core::Point2 shift{cosine * T_previous_robot.x + sine * T_previous_robot.y,
                           cosine * T_previous_robot.y - sine * T_previous_robot.x};
  tick(cosine, sine, shift, visible, seen);
}

void LocalObstacleMap::tick(double cosine, double sine, const core::Point2& shift_back,
                            const VisibleArea& visible, const std::vector<core::Point2>& seen) {
  if (!std::isfinite(cosine) || !std::isfinite(sine) || !isFinite(shift_back))
    throw core::ContractError("LocalObstacleMap::update: the robot's motion is not finite");
  for (auto& p : points_)
    p = {cosine * p.x + sine * p.y - shift_back.x, cosine * p.y - sine * p.x - shift_back.y};
  dropWhere(points_, [this](const core::Point2& p) { return !isInZone(p); });
  dropWhere(points_, [&visible](const core::Point2& p) { return visible.contains(p); });
  keepOneOfTwins(points_, options_.merge_distance_m);
  remembered_ = points_.size();
  std::copy_if(seen.begin(), seen.end(), std::back_inserter(points_), isFinite);

  const auto most = static_cast<size_t>(options_.max_points);
  const size_t surplus = points_.size() > most ? points_.size() - most : 0;
  points_.erase(points_.begin(), points_.begin() + static_cast<std::ptrdiff_t>(surplus));
  remembered_ -= std::min(remembered_, surplus);
}

}  // namespace slam::obstacles

#include "libslam/safety/obstacle_memory.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/rigid_motion2.h"
#include "libslam/obstacles/lidar_view.h"

namespace slam::safety {
namespace {

constexpr double kReach_m = 1.5;
constexpr double kGrid_m = 0.03;

/// True where the scan would show a thing if it were there (and in no dead zone).
bool isInView(const lidar::Scan& scan, const core::Point2& p_robot) {
  if (scan.isFullCircle()) return true;
  const core::Point2 p_lidar = core::inverse(scan.T_robot_lidar) * p_robot;
  const double first = scan.first_angle_rad, last = scan.angle(scan.ranges_m.size() - 1);
  const double from_middle = core::angleDifference(core::atan2(p_lidar.y, p_lidar.x), 0.5 * (first + last));
  return std::abs(from_middle) <= 0.5 * (last - first) + 0.5 * scan.step_rad;
}

/// One point per cell of a grid, in a fixed order.
void thin(std::vector<core::Point2>& points, double cell_m) {
  const auto key = [cell_m](const core::Point2& p) {
    return std::pair(std::floor(p.x / cell_m), std::floor(p.y / cell_m));
  };
  std::stable_sort(points.begin(), points.end(),
                   [&](const core::Point2& a, const core::Point2& b) { return key(a) < key(b); });
  points.erase(std::unique(points.begin(), points.end(),
                           [&](const core::Point2& a, const core::Point2& b) { return key(a) == key(b); }),
               points.end());
}

class NoMemory : public ObstacleMemory {
 public:
  void update(const lidar::Scan& /*scan*/, const core::Pose2& /*T_odom_robot*/) override {}
  std::vector<core::Point2> points() const override { return {}; }
};

class ShortMemory : public ObstacleMemory {
 public:
  void update(const lidar::Scan& scan, const core::Pose2& T_odom_robot) override {
    memory_odom_.insert(memory_odom_.end(), seen_odom_.begin(), seen_odom_.end());
    T_robot_odom_ = core::inverse(T_odom_robot);
    const core::RigidMotion2 T_robot_memory(T_robot_odom_), T_odom_seen(T_odom_robot);
    const auto forget = [&](const core::Point2& p_odom) {
      const core::Point2 p_robot = T_robot_memory * p_odom;
      return core::hypot(p_robot.x, p_robot.y) > kReach_m || isInView(scan, p_robot);
    };
    memory_odom_.erase(std::remove_if(memory_odom_.begin(), memory_odom_.end(), forget), memory_odom_.end());
    thin(memory_odom_, kGrid_m);
    seen_odom_.clear();
    for (const auto& p_robot : lidar::scanPoints(scan))
      if (core::hypot(p_robot.x, p_robot.y) <= kReach_m) seen_odom_.push_back(T_odom_seen * p_robot);
  }
  std::vector<core::Point2> points() const override {
    std::vector<core::Point2> p_robot;
    p_robot.reserve(memory_odom_.size());
    const core::RigidMotion2 T_robot_memory(T_robot_odom_);
    for (const auto& p_odom : memory_odom_) p_robot.push_back(T_robot_memory * p_odom);
    return p_robot;
  }

 private:
  core::Pose2 T_robot_odom_;
  std::vector<core::Point2> seen_odom_;    ///< of the newest scan, within reach
  std::vector<core::Point2> memory_odom_;  ///< outside of the newest scan's view
};

class LocalMapMemory : public ObstacleMemory {
 public:
  explicit LocalMapMemory(const obstacles::LocalObstacleOptions& zone) : zone_(zone), map_(zone) {
    // The lidar looks wherever it looks: the sector that stands for a camera is not meant here.
    view_.width_rad = 2 * core::kPi;
    view_.reach_m = 0;
  }
  void update(const lidar::Scan& scan, const core::Pose2& T_odom_robot) override {
    const obstacles::LidarView view(scan, view_);
    std::vector<core::Point2> seen;
    std::copy_if(view.obstacles().begin(), view.obstacles().end(), std::back_inserter(seen),
                 [this](const core::Point2& p_robot) { return map_.isInZone(p_robot); });
    if (zone_.merge_distance_m > 0) thin(seen, zone_.merge_distance_m);
    map_.update(T_odom_last_ ? core::between(*T_odom_last_, T_odom_robot) : core::Pose2(), view, seen);
    T_odom_last_ = T_odom_robot;
  }
  std::vector<core::Point2> points() const override {
    const auto remembered = static_cast<std::ptrdiff_t>(map_.rememberedCount());
    return {map_.points().begin(), map_.points().begin() + remembered};
  }

 private:
  obstacles::LocalObstacleOptions zone_;
  obstacles::LocalObstacleMap map_;
  obstacles::SectorOptions view_;
  std::optional<core::Pose2> T_odom_last_;
};

}  // namespace

std::unique_ptr<ObstacleMemory> makeObstacleMemory(const std::string& name,
                                                   const obstacles::LocalObstacleOptions& zone) {
  if (name == "none") return std::make_unique<NoMemory>();
  if (name == "short") return std::make_unique<ShortMemory>();
  if (name == "local_map") return std::make_unique<LocalMapMemory>(zone);
  throw core::ContractError("makeObstacleMemory: no memory '" + name + "'");
}

const std::vector<std::string>& obstacleMemoryNames() {
  static const std::vector<std::string> names = {"none", "short", "local_map"};
  return names;
}

}  // namespace slam::safety

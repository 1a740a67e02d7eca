#include "libslam/reach/turn_away.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "libslam/core/elementary.h"
#include "libslam/lidar/scan.h"
#include "libslam/pictures/obstacle_picture.h"

namespace slam::reach {
namespace {

/// In front of the robot at the start.
const std::vector<core::Point2>& posts() {
  static const std::vector<core::Point2> places = {{1.2, 0.25}, {1.4, -0.35}, {1.9, 0.7}, {2.2, -0.75},
                                                   {2.3, 0.0},  {2.8, 0.6},   {3.1, -0.5}};
  return places;
}

std::vector<core::Point2> seenFrom(const core::Pose2& T_start_robot) {
  const core::Pose2 T_robot_start = core::inverse(T_start_robot);
  std::vector<core::Point2> p_robot;
  for (const auto& p_start : posts()) p_robot.push_back(T_robot_start * p_start);
  return p_robot;
}

/// Distance along a ray from the origin to a disc; infinity when it passes by.
double distanceToDisc(double angle_rad, const core::Point2& centre, double radius_m) {
  const double along = centre.x * core::cos(angle_rad) + centre.y * core::sin(angle_rad);
  const double beside = centre.y * core::cos(angle_rad) - centre.x * core::sin(angle_rad);
  if (along <= 0 || std::abs(beside) >= radius_m) return INFINITY;
  return along - std::sqrt(radius_m * radius_m - beside * beside);
}

lidar::Scan exactScan(const std::vector<core::Point2>& p_robot) {
  lidar::Scan scan;
  constexpr size_t kBeams = 720;
  scan.step_rad = core::degToRad(0.5);
  scan.first_angle_rad = -core::kPi;
  scan.min_range_m = 0.05, scan.max_range_m = 8;
  for (size_t i = 0; i < kBeams; ++i) {
    double nearest_m = INFINITY;
    for (const auto& p : p_robot)
      nearest_m = std::min(nearest_m, distanceToDisc(scan.angle(i), p, kPostRadius_m));
    scan.ranges_m.push_back(nearest_m <= scan.max_range_m ? static_cast<float>(nearest_m) : lidar::kNoReturn);
  }
  return scan;
}

/// What the sensor makes of the posts.
struct Look {
  std::unique_ptr<obstacles::VisibleArea> visible;
  std::vector<core::Point2> seen;
};
Look look(const TurnAwayConfig& config, const std::vector<core::Point2>& p_robot) {
  if (config.experiment.sensor == "lidar") {
    auto view = std::make_unique<obstacles::LidarView>(exactScan(p_robot), config.sector);
    auto seen = view->obstacles();
    return {std::move(view), std::move(seen)};
  }
  auto view = std::make_unique<obstacles::CameraView>(config.camera);
  auto seen = obstacles::pointsWithin(*view, p_robot);
  return {std::move(view), std::move(seen)};
}

/// The robot of the experiment, tick by tick.
class Experiment {
 public:
  explicit Experiment(const TurnAwayConfig& config) : config_(config), map_(config.map) { tick(0, 0); }

  void turn(double angle_rad) {
    const int ticks = std::max(
        1, static_cast<int>(std::ceil(std::abs(angle_rad) / config_.experiment.turn_step_rad - 1e-9)));
    for (int i = 0; i < ticks; ++i) tick(angle_rad / ticks, 0);
  }
  void travel(double distance_m) {
    const int ticks = std::max(
        1, static_cast<int>(std::ceil(std::abs(distance_m) / config_.experiment.travel_step_m - 1e-9)));
    for (int i = 0; i < ticks; ++i) tick(0, distance_m / ticks);
  }

  TurnAwayMoment moment(const std::string& what) const {
    const auto& points = map_.points();
    const auto border = points.begin() + static_cast<std::ptrdiff_t>(map_.rememberedCount());
    const double reach_m = 2 * core::hypot(config_.map.front_m + config_.map.rear_m, config_.map.width_m);
    return {what,
            T_start_robot_,
            look_.visible->outline(reach_m),
            {border, points.end()},
            {points.begin(), border},
            seenFrom(T_start_robot_)};
  }

 private:
  void tick(double turn_rad, double travel_m) {
    T_start_robot_ = T_start_robot_ * core::Pose2{0, 0, turn_rad} * core::Pose2{travel_m, 0, 0};
    look_ = look(config_, seenFrom(T_start_robot_));
    map_.update(turn_rad, travel_m, *look_.visible, look_.seen);
  }

  const TurnAwayConfig& config_;
  obstacles::LocalObstacleMap map_;
  core::Pose2 T_start_robot_;
  Look look_;
};

/// "45" or "22.5".
std::string rounded(double value) {
  return files::formatNumber(std::round(value * 10) / 10);
}

std::string inDegrees(double angle_rad) {
  return rounded(core::radToDeg(angle_rad)) + " deg";
}

}  // namespace

TurnAwayOptions::TurnAwayOptions() {
  table().setDefaults(*this);
}

const files::ParameterTable<TurnAwayOptions>& TurnAwayOptions::table() {
  using O = TurnAwayOptions;
  static const files::ParameterTable<O> rows(
      "turn_away",
      {{"sensor", &O::sensor, "camera", {"camera", "lidar"}, "what sees the obstacles"},
       {"turn_deg", &O::turn_rad, 90.0, -180.0, 180.0, "how far the robot turns away, left positive"},
       {"turn_step_deg", &O::turn_step_rad, 5.0, 0.1, 180.0, "turn of one tick, at most"},
       {"travel_m", &O::travel_m, 1.0, -100.0, 100.0, "how far it then drives"},
       {"travel_step_m", &O::travel_step_m, 0.1, 0.001, 100.0, "travel of one tick, at most"}});
  return rows;
}

TurnAwayConfig readTurnAwayConfig(const files::IniFile& ini) {
  files::rejectUnknownSections(ini, {"turn_away", "obstacles", "camera", "sector"});
  TurnAwayConfig config;
  auto* report = &config.parameters;
  files::readParameters(ini, TurnAwayOptions::table(), config.experiment, report);
  files::readParameters(ini, obstacles::LocalObstacleOptions::table(), config.map, report);
  files::readParameters(ini, obstacles::CameraOptions::table(), config.camera, report);
  files::readParameters(ini, obstacles::SectorOptions::table(), config.sector, report);
  return config;
}

std::vector<TurnAwayMoment> turnAway(const TurnAwayConfig& config) {
  const double turn_rad = config.experiment.turn_rad, travel_m = config.experiment.travel_m;
  Experiment experiment(config);
  std::vector<TurnAwayMoment> moments = {experiment.moment("start")};
  double turned_rad = 0;
  for (const double part : {0.25, 0.5, 1.0}) {
    experiment.turn(part * turn_rad - turned_rad);
    turned_rad = part * turn_rad;
    moments.push_back(experiment.moment("turned by " + inDegrees(turned_rad)));
  }
  experiment.travel(travel_m);
  moments.push_back(experiment.moment("driven " + rounded(travel_m) + " m"));
  experiment.turn(-turn_rad);
  moments.push_back(experiment.moment("turned back"));
  return moments;
}

void drawTurnAway(const std::vector<TurnAwayMoment>& moments, const TurnAwayConfig& config,
                  const std::string& file, const draw::Paper& paper) {
  std::vector<pictures::ObstaclePanel> panels;
  panels.reserve(moments.size());
  for (const auto& moment : moments)
    panels.push_back({moment.what,
                      std::to_string(moment.seen.size()) + " seen, " +
                          std::to_string(moment.remembered.size()) + " remembered",
                      moment.visible, moment.seen, moment.remembered, moment.posts});
  pictures::ObstacleZone zone;
  zone.front_m = config.map.front_m, zone.rear_m = config.map.rear_m, zone.width_m = config.map.width_m;
  zone.obstacle_radius_m = kPostRadius_m;
  pictures::drawObstacles(panels, zone,
                          "Local obstacle map: the robot turns away (" + config.experiment.sensor + ")", file,
                          paper);
}

}  // namespace slam::reach

// What the lessons on lidar, wheels and scans hand out.
#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/learn/recipes.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/odometry/scan_odometry.h"
#include "libslam/rays/ray_caster.h"
#include "libslam/record/user_drive.h"
#include "libslam/sim/operation_log.h"

namespace slam::learn {
namespace {

/// A place of the plan's middle with a heading in whole degrees along which a wall stands between `least_m`
/// and `most_m`.
core::Pose2 placeFacingAWall(const world::Plan& plan, const record::RecordConfig& config,
                             core::RandomStream& random, double least_m, double most_m) {
  auto start = record::startPose(plan, config);
  for (int draw = 0; draw < 1000; ++draw) {
    start.phi = core::degToRad(static_cast<double>(random.below(360)) - 180);
    const double range_m = rays::castRay(plan, core::position(start), start.phi, 0);
    if (range_m > least_m && range_m < most_m) break;
  }
  return start;
}

std::string poseText(const core::Pose2& pose) {
  return files::formatNumber(pose.x) + "," + files::formatNumber(pose.y) + "," +
         files::formatNumber(std::round(core::radToDeg(pose.phi)));
}

/// Of the true path: how far the robot has turned in all, whole turns counted, and how far it has driven.
struct Turned {
  double heading_rad = 0, path_m = 0;
  void add(const core::Pose2& T_before_after) {
    heading_rad += T_before_after.phi;
    path_m += core::hypot(T_before_after.x, T_before_after.y);
  }
};

}  // namespace

Figures standingLidar(const Place& place) {
  const auto plan = place.makePlan();
  auto config = place.recordConfig();
  core::RandomStream random(place.seed(), "lesson");
  config.simulation.start = poseText(placeFacingAWall(plan, config, random, 1, 5));
  const auto start = record::startPose(plan, config);
  record::recordCommands(plan, config, place.seed(), place.log(), place.manifest(), place.progress,
                         [&](const sim::Sensed&) {
                           return record::Order({0, 0, 1 / config.lidar.rate_hz});
                         });
  std::vector<std::vector<double>> rows;
  double sum = 0, least = std::numeric_limits<double>::infinity(), most = 0;
  logs::LogReader log(place.log());
  while (const auto entry = log.next()) {
    const float range_m = entry->scan.ranges_m[entry->scan.ranges_m.size() / 2];
    const double written_m = lidar::isReturn(range_m) ? static_cast<double>(range_m) : 0;
    rows.push_back({static_cast<double>(rows.size()), written_m});
    sum += written_m;
    most = std::max(most, written_m);
    if (written_m > 0) least = std::min(least, written_m);
  }
  writeNumbers(place.file("ahead.csv"), {"scan", "range_m"}, rows);
  const double truth_m = rays::castRay(plan, core::position(start), start.phi, 0);
  return {{"answer", truth_m},
          {"mean_with_lost", sum / static_cast<double>(rows.size())},
          {"least", least},
          {"most", most},
          {"cells", truth_m / plan.resolution_m}};
}

Figures headingDrift(const Place& place) {
  const auto plan = place.makePlan();
  auto config = place.recordConfig();
  core::RandomStream random(place.seed(), "lesson");
  const double side = random.chance(0.5) ? 1 : -1;
  config.odometry.heading_bias_radpm = side * core::degToRad(random.uniform(0.8, 2.5));
  record::record(plan, config, place.seed(), place.log(), place.manifest(), place.progress);
  const auto truth = logs::readTum(place.file("run.gt.tum"));
  Turned truly, wheels;
  for (std::size_t i = 1; i < truth.size(); ++i) truly.add(core::between(truth[i - 1].pose, truth[i].pose));
  logs::LogReader log(place.log());
  while (const auto entry = log.next()) wheels.add(entry->T_previous_robot);
  const double drift_deg = core::radToDeg(wheels.heading_rad - truly.heading_rad);
  return {{"answer", drift_deg / truly.path_m},
          {"total_deg", drift_deg},
          {"per_second", drift_deg / (truth.back().time_s - truth.front().time_s)},
          {"wheels_alone", core::radToDeg(wheels.heading_rad) / truly.path_m}};
}

Figures scanDifference(const Place& place) {
  const auto plan = place.makePlan();
  const auto config = place.recordConfig();
  core::RandomStream random(place.seed(), "lesson");
  constexpr int kTurns = 20;
  constexpr double kWrong_rad = core::kPi / 36;  // 5 degrees
  std::vector<robot::UserCommand> commands;
  for (int i = 0; i < kTurns; ++i) {
    const double side = random.chance(0.5) ? 1 : -1;
    commands.push_back({robot::UserCommand::kTurn,
                        side * core::degToRad(20 + static_cast<double>(random.below(120))), 2 * i + 1});
    commands.push_back({robot::UserCommand::kMove, random.uniform(0.2, 0.6), 2 * i + 2});
  }
  record::recordUserCommands(plan, config, place.seed(), place.log(), commands, place.manifest(),
                             place.progress);
  const auto truth = logs::readTum(place.file("run.gt.tum"));
  const std::string path = place.file("run.operations.txt");
  std::vector<std::vector<double>> rows;
  double turns = 0, wrong = 0, wrong_unwrapped = 0, wrong_turned_round = 0, all_wrong_moves = 0;
  for (const auto& operation : sim::parseOperations(files::readTextFile(path), path)) {
    if (operation.kind != 't') {
      ++all_wrong_moves;
      continue;
    }
    const auto& before = truth[operation.scan_before].pose;
    const auto& after = truth[operation.scan_after].pose;
    const double read_rad = operation.first;
    wrong += std::abs(core::angleDifference(read_rad, after.phi - before.phi)) > kWrong_rad;
    wrong_unwrapped += std::abs(read_rad - (after.phi - before.phi)) > kWrong_rad;
    wrong_turned_round += std::abs(core::angleDifference(-read_rad, after.phi - before.phi)) > kWrong_rad;
    ++turns;
    rows.push_back({turns, core::radToDeg(read_rad), core::radToDeg(before.phi), core::radToDeg(after.phi)});
  }
  writeNumbers(place.file("turns.csv"), {"turn", "read_deg", "heading_before_deg", "heading_after_deg"},
               rows);
  return {{"answer", wrong},
          {"turns", turns},
          {"right", turns - wrong},
          {"unwrapped", wrong_unwrapped},
          {"turned_round", wrong_turned_round},
          {"commands", turns + all_wrong_moves}};
}

Figures badWheels(const Place& place) {
  const auto plan = place.makePlan();
  record::record(plan, place.recordConfig(), place.seed(), place.log(), place.manifest(), place.progress);
  return {};
}

Figures matcherErrors(const Place& place) {
  const auto plan = place.makePlan();
  auto config = place.recordConfig();
  core::RandomStream random(place.seed(), "lesson");
  config.lidar.sigma_m = random.uniform(0.02, 0.05);
  record::record(plan, config, place.seed(), place.log(), place.manifest(), place.progress);
  const auto truth = logs::readTum(place.file("run.gt.tum"));
  odometry::ScanOdometryOptions options;
  options.method = "plicp";
  const auto matcher = odometry::makeScanOdometry(options);
  const double claim = random.uniform(0.3, 0.7);  // of the variance that the matcher states: sensors lie, too
  std::vector<std::vector<double>> rows;
  double sum = 0, no_correlation = 0, squares = 0, variances = 0, with_sigma = 0;
  logs::LogReader log(place.log());
  for (std::size_t i = 0; const auto entry = log.next(); ++i) {
    const auto motion = matcher->update(entry->scan);
    if (i == 0 || !motion.reliable) continue;
    const auto true_motion = core::between(truth[i - 1].pose, truth[i].pose);
    const double ex = motion.T_previous_current.x - true_motion.x,
                 ey = motion.T_previous_current.y - true_motion.y;
    const double xx = claim * motion.covariance[0], xy = claim * motion.covariance[1],
                 yy = claim * motion.covariance[4];
    rows.push_back({ex, ey, xx, xy, yy});
    const double determinant = xx * yy - xy * xy;
    sum += (yy * ex * ex - 2 * xy * ex * ey + xx * ey * ey) / determinant;
    no_correlation += ex * ex / xx + ey * ey / yy;
    with_sigma += ex * ex / std::sqrt(xx) + ey * ey / std::sqrt(yy);
    squares += ex * ex + ey * ey;
    variances += xx + yy;
  }
  writeNumbers(place.file("errors.csv"),
               {"error_x_m", "error_y_m", "variance_x_m2", "covariance_xy_m2", "variance_y_m2"}, rows);
  const double n = static_cast<double>(rows.size());
  return {{"answer", sum / (2 * n)},
          {"nees", sum / n},
          {"sum", sum},
          {"root", std::sqrt(sum / (2 * n))},
          {"no_correlation", no_correlation / (2 * n)},
          {"with_sigma", with_sigma / (2 * n)},
          {"ratio_of_means", squares / variances},
          {"inverse", 2 * n / sum}};
}

Figures onlyPlan(const Place& place) {
  place.makePlan("plan.yaml");
  return {};
}

}  // namespace slam::learn

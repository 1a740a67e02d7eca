#include "libslam/tracking/motion.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "libslam/core/elementary.h"
#include "libslam/keyframes/matching.h"
#include "libslam/odometry/scan_odometry.h"
#include "libslam/scanmatch/information.h"

namespace slam::tracking {
namespace {

using core::Pose2;
using scanmatch::PatchPoint;

/// A step counts as this long at least and at most: between a burst of scans and a log that was paused.
constexpr double kLeastPeriod_s = 1e-3, kMostPeriod_s = 2;
/// Stamps of real logs leap to and fro: the noise of a step goes by the mean of some twenty.
constexpr double kPeriodGain = 0.05;
/// The motion before goes on, to within what a robot may do otherwise per second, where nothing measures it.
constexpr double kUnknown_mps = 2.5, kUnknown_radps = 2.5, kUnknownMost = 1;
/// In standard deviations of wheels: how far a robot goes beside their way, and misses their turn, where they
/// slip.
constexpr double kSlipBeside = 4, kSlipTurned = 10;
/// Two scans are searched for turns of an indoor robot between them up to this speed.
constexpr double kFastest_radps = 4;
/// Of what a scan sees the next one sees this share at least, as a rule.
constexpr double kShared = 0.6;

}  // namespace

bool Motion::begin(const lidar::Scan& scan, const Pose2& T_previous_robot, bool has_odometry) {
  has_motion_ = false;
  if (!seen_.empty()) has_odometry = goOn(scan, T_previous_robot, has_odometry);
  turn_rad_ = has_odometry ? std::abs(T_previous_robot.phi) : 0;
  return has_odometry;
}

/// From the scan before to this one.
bool Motion::goOn(const lidar::Scan& scan, const Pose2& T_previous_robot, bool has_odometry) {
  const auto same = std::find_if(seen_.begin(), seen_.end(),
                                 [&](const Seen& seen) { return lidar::areOfOneLidar(seen.scan, scan); });
  before_ = same == seen_.end() ? -1 : static_cast<int>(same - seen_.begin());
  const bool is_first = !(period_s_ > 0);
  const double since_s = scan.time_s - previous_time_s_;
  if (has_odometry && leaps_.take(T_previous_robot, since_s)) {
    has_odometry = false;
    map_->note(core::JournalEvent::kLeapt, core::hypot(T_previous_robot.x, T_previous_robot.y));
  }
  if (has_odometry && silence_.take(T_previous_robot)) has_odometry = false;
  const double before_s = is_first ? scanmatch::kNominalPeriod_s : period_s_;
  period_s_ = since_s > 0 ? std::clamp(since_s, kLeastPeriod_s, kMostPeriod_s) : before_s;
  mean_period_s_ = is_first ? period_s_ : mean_period_s_ + kPeriodGain * (period_s_ - mean_period_s_);
  const Pose2 T_next = steady_.next(period_s_);
  if (!has_odometry && !is_first) T_previous_robot_ = T_next;
  return has_odometry;
}

void Motion::end(const lidar::Scan& scan) {
  if (silence_.note(T_previous_robot_)) map_->note(core::JournalEvent::kSilent, 0);
  steady_.note(T_previous_robot_);
  for (auto& seen : seen_) seen.T_seen_robot = seen.T_seen_robot * T_previous_robot_;
  if (before_ < 0) {
    before_ = static_cast<int>(seen_.size());
    seen_.emplace_back();
  }
  seen_[static_cast<size_t>(before_)] = {scan, {}};
  turned_before_rad_ = turn_rad_;
  previous_time_s_ = scan.time_s;
}

const Seen* Motion::before() const {
  if (before_ < 0 || seen_[static_cast<size_t>(before_)].scan.ranges_m.size() < 2) return nullptr;
  return &seen_[static_cast<size_t>(before_)];
}

double Motion::farthestMove() const {
  constexpr double kFastest_mps = 3, kFarthest_m = 4;
  return std::min(kFastest_mps * period_s_, kFarthest_m);
}

bool Motion::isSlip(const Pose2& T_previous_robot, const Prediction& by_wheels) const {
  const Pose2& T_wheels = by_wheels.T_previous_robot;
  const double most_m = core::hypot(T_wheels.x, T_wheels.y) + kSlipBeside * by_wheels.sigma_xy_m;
  return core::hypot(T_previous_robot.x, T_previous_robot.y) <= std::min(most_m, farthestMove()) &&
         std::abs(core::angleDifference(T_previous_robot.phi, T_wheels.phi)) <=
             kSlipTurned * by_wheels.sigma_turn_rad;
}

double Motion::sigmaOfWheels_rad(const Pose2& T_wheels) const {
  return wheels_.sigmaTurn_rad(
      {T_wheels.x, T_wheels.y, std::max(std::abs(T_wheels.phi), turned_before_rad_)});
}

Prediction Motion::predict(const Pose2& T_previous_robot, bool has_odometry) const {
  Prediction result;
  result.T_previous_robot = has_odometry ? T_previous_robot : T_previous_robot_;
  const Pose2& T = result.T_previous_robot;
  const double root = std::sqrt((mean_period_s_ > 0 ? mean_period_s_ : scanmatch::kNominalPeriod_s) /
                                scanmatch::kNominalPeriod_s);
  result.sigma_xy_m = root * options_->odometry_xy_m + options_->odometry_xy_per_m * core::hypot(T.x, T.y);
  const double turn_rad = has_odometry ? std::max(std::abs(T.phi), turned_before_rad_) : std::abs(T.phi);
  result.sigma_turn_rad = root * options_->odometry_turn_rad + options_->odometry_turn_per_rad * turn_rad;
  if (has_odometry) {
    result.sigma_turn_rad = std::max(result.sigma_turn_rad, sigmaOfWheels_rad(T));
  } else {
    result.sigma_xy_m += std::min(kUnknown_mps * period_s_, kUnknownMost);
    result.sigma_turn_rad += std::min(kUnknown_radps * period_s_, kUnknownMost);
  }
  return result;
}

std::optional<Pose2> Motion::fromScans(const lidar::Scan& scan) const {
  if (!has_motion_) motion_ = find(scan);
  has_motion_ = true;
  return motion_;
}

std::optional<Pose2> Motion::find(const lidar::Scan& scan) const {
  if (before() == nullptr) return std::nullopt;
  odometry::ScanOdometryOptions options;
  options.max_turn_rad = std::clamp(kFastest_radps * period_s_, options.max_turn_rad, core::kPi);
  options.max_move_m = std::max(farthestMove(), options.max_move_m);
  const auto odometry = odometry::makeScanOdometry(options);
  odometry->update(before()->scan);
  const auto motion = odometry->update(scan);
  if (!motion.reliable) return std::nullopt;
  return core::inverse(before()->T_seen_robot) * motion.T_previous_current;
}

double Motion::brokenBy(const std::vector<PatchPoint>& points, const Pose2& T_previous_robot) const {
  if (before() == nullptr) return 0;
  const keyframes::View seen =
      keyframes::view(before()->scan, before()->T_seen_robot * T_previous_robot, points);
  const double shared =
      std::max<double>(seen.agreed + seen.passed, kShared * static_cast<double>(points.size()));
  return shared > 0 ? 1 - seen.agreed / shared : 0;
}

void Motion::learn(const Pose2& T_corrected, const Pose2& T_matched, double way_told, double turn_told,
                   bool is_believed) {
  way_sign_.learn(T_corrected, T_matched, way_told);
  if (is_believed)
    wheels_.learn(T_corrected, T_matched, way_told, turn_told);
  else
    wheels_.endPiece();
}

void Motion::restart() {
  T_previous_robot_ = {};
  steady_ = {};
  wheels_.endPiece();
}

void Motion::noteWheels() const {
  const double factor = wheels_.scale().factor();
  if (factor == 1) return;
  char turns[100];
  std::snprintf(turns, sizeof turns,
                "turns by %.2f deg more per metre and by %.1f %% more than odometry says",
                core::radToDeg(wheels_.heading().perMetre()), 100 * wheels_.heading().perRadian());
  map_->note(core::JournalEvent::kCalibrated, factor, -1, turns);
}

}  // namespace slam::tracking

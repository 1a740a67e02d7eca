#include "benchmarks/odometry/drift.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "libslam/core/middle_value.h"
#include "libslam/threads/cpu_time.h"

namespace odometry_bench {
namespace {

using slam::core::Pose2;
using slam::core::Trajectory;

constexpr double kStretch_m = 1.0, kLongStretch_m = 10;
constexpr size_t kStretchEvery = 10;  // scans
constexpr double kShortRelation_s = 5, kLongRelation_s = 300;
constexpr double kWrong_m = 0.1;

/// Sums over stretches.
class Score {
 public:
  /// Returns the translational error.
  double add(const Pose2& T_true, const Pose2& T_estimated, double driven_m, double turned_rad) {
    const Pose2 error = slam::core::between(T_true, T_estimated);
    translations_.push_back(std::hypot(error.x, error.y));
    rotations_.push_back(std::abs(slam::core::wrapToPi(error.phi)));
    driven_m_ += driven_m;
    turned_rad_ += turned_rad;
    return translations_.back();
  }
  double perMetre() const {
    double metres = 0;
    for (const double e : translations_) metres += e;
    return driven_m_ > 0 ? metres / driven_m_ : std::nan("");
  }
  void store(Drift& drift) const {
    double radians = 0;
    for (const double e : rotations_) radians += e;
    drift.per_metre = perMetre();
    drift.per_radian = turned_rad_ > 0 ? radians / turned_rad_ : std::nan("");
    drift.median_m = slam::core::middleValue(translations_);
    drift.median_rad = slam::core::middleValue(rotations_);
    drift.stretches = translations_.size();
  }

 private:
  std::vector<double> translations_, rotations_;
  double driven_m_ = 0, turned_rad_ = 0;
};

/// Stretches of the true path of the given length.
Score scoreStretches(const Trajectory& truth, const std::vector<Pose2>& estimate, double length_m) {
  Score score;
  for (size_t i = 0; i < truth.size(); i += kStretchEvery) {
    double driven_m = 0, turned_rad = 0;
    for (size_t j = i + 1; j < truth.size(); ++j) {
      driven_m += slam::core::distance(truth[j - 1].pose, truth[j].pose);
      turned_rad += std::abs(slam::core::angleDifference(truth[j].pose.phi, truth[j - 1].pose.phi));
      if (driven_m < length_m) continue;
      score.add(slam::core::between(truth[i].pose, truth[j].pose),
                slam::core::between(estimate[i], estimate[j]), driven_m, turned_rad);
      break;
    }
  }
  return score;
}

void scoreByTruth(const Trajectory& truth, const std::vector<Pose2>& estimate, Drift& drift) {
  for (size_t i = 1; i < truth.size(); ++i) {
    const Pose2 error = slam::core::between(slam::core::between(truth[i - 1].pose, truth[i].pose),
                                            slam::core::between(estimate[i - 1], estimate[i]));
    if (std::hypot(error.x, error.y) > kWrong_m) ++drift.wrong;
  }
  scoreStretches(truth, estimate, kStretch_m).store(drift);
  drift.long_per_metre = scoreStretches(truth, estimate, kLongStretch_m).perMetre();
}

void scoreByRelations(const BenchLog& log, const std::vector<Pose2>& estimate, Drift& drift) {
  std::map<long long, size_t> scan_at;  // stamps to the microsecond, as the files print them
  const auto key = [](double time_s) { return std::llround(time_s * 1e6); };
  std::vector<double> driven_m = {0};
  for (size_t i = 0; i < log.scans.size(); ++i) {
    scan_at.emplace(key(log.scans[i].time_s), i);
    if (i > 0) driven_m.push_back(driven_m.back() + slam::core::distance(log.wheels[i - 1], log.wheels[i]));
  }
  Score near, far;
  for (const slam::core::Relation& relation : log.relations) {
    const auto from = scan_at.find(key(relation.from_time_s)), to = scan_at.find(key(relation.to_time_s));
    const double gap_s = relation.to_time_s - relation.from_time_s;
    if (gap_s <= 0 || gap_s > kLongRelation_s || from == scan_at.end() || to == scan_at.end()) continue;
    const Pose2& T = relation.T_from_to;
    const Pose2 estimated = slam::core::between(estimate[from->second], estimate[to->second]);
    if (gap_s > kShortRelation_s) {
      far.add(T, estimated, driven_m[to->second] - driven_m[from->second], std::abs(T.phi));
    } else if (near.add(T, estimated, std::hypot(T.x, T.y), std::abs(T.phi)) > kWrong_m) {
      ++drift.wrong;
    }
  }
  near.store(drift);
  drift.long_per_metre = far.perMetre();
}

}  // namespace

Drift measureDrift(const BenchLog& log, slam::odometry::ScanOdometry& odometry) {
  Drift drift;
  std::vector<Pose2> estimate;
  std::vector<double> times_us;
  Pose2 pose;
  for (size_t i = 0; i < log.scans.size(); ++i) {
    const double start_s = slam::threads::cpuSeconds();
    const auto motion = odometry.update(log.scans[i], log.commands[i]);
    times_us.push_back(1e6 * (slam::threads::cpuSeconds() - start_s));
    pose = pose * motion.T_previous_current;
    estimate.push_back(pose);
    if (!motion.reliable) ++drift.flagged;
  }
  drift.median_us = slam::core::middleValue(times_us);
  if (!log.truth.empty())
    scoreByTruth(log.truth, estimate, drift);
  else
    scoreByRelations(log, estimate, drift);
  return drift;
}

}  // namespace odometry_bench

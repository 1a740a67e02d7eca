#include "libslam/calibration/motion_series.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::calibration {
namespace {

constexpr std::uint64_t kStretches = 40;
constexpr double kLongestGap_s = 2;

std::unique_ptr<odometry::ScanOdometry> makeMatcher() {
  odometry::ScanOdometryOptions options;
  options.method = "plicp";
  return odometry::makeScanOdometry(options);
}

/// plicp answers with the search range where nothing fits.
bool isMatched(const odometry::ScanMotion& motion) {
  static const double most_rad = odometry::ScanOdometryOptions().max_turn_rad, unknown = most_rad * most_rad;
  return motion.covariance[8] < 0.99 * unknown;
}

}  // namespace

MotionSeries::MotionSeries(std::uint64_t scans, double shortest_s)
    : stretch_length_(scans <= kMostSteps ? std::max<std::uint64_t>(scans, 1) : kMostSteps / kStretches),
      period_(scans <= kMostSteps ? stretch_length_ : scans / kStretches),
      shortest_s_(shortest_s),
      matcher_(makeMatcher()) {}

bool MotionSeries::isWanted(std::uint64_t scan) const {
  return scan % period_ < stretch_length_;
}

void MotionSeries::addOdometry(const std::string& stream, const core::StampedPose& reading) {
  if (stretches_.empty() || !isWanted(seen_)) {
    waiting_[stream] = reading;
    return;
  }
  auto& odometry = stretches_.back().odometry[stream];
  if (!odometry.empty() && std::abs(reading.time_s - odometry.back().time_s) < shortest_s_) return;
  odometry.push_back(reading);
}

const ScanStep* MotionSeries::addScan(const lidar::Scan& scan) {
  const std::uint64_t index = seen_++;
  if (!isWanted(index)) {
    previous_s_.reset();
    return nullptr;
  }
  lidar::Scan unmounted = scan;
  unmounted.T_robot_lidar = {};
  if (!previous_s_) {
    matcher_->reset();
    matcher_->update(unmounted);
    stretches_.emplace_back();
    for (const auto& [stream, reading] : waiting_) stretches_.back().odometry[stream].push_back(reading);
    previous_s_ = scan.time_s;
    return nullptr;
  }
  const auto motion = matcher_->update(unmounted);
  ScanStep step{*previous_s_, scan.time_s, motion.T_previous_current, isMatched(motion), motion.reliable};
  previous_s_ = scan.time_s;
  stretches_.back().steps.push_back(step);
  return &stretches_.back().steps.back();
}

void MotionSeries::finish() {
  for (auto& stretch : stretches_)
    for (auto& [stream, readings] : stretch.odometry)
      std::stable_sort(readings.begin(), readings.end(),
                       [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
}

OdometryCurve::OdometryCurve(const Stretch& stretch, const std::string& stream) {
  const auto found = stretch.odometry.find(stream);
  if (found == stretch.odometry.end()) return;
  for (const auto& reading : found->second) {
    core::StampedPose next = reading;
    if (!readings_.empty()) {
      const auto& last = readings_.back();
      if (next.time_s <= last.time_s) continue;
      next.pose.phi = last.pose.phi + core::angleDifference(next.pose.phi, last.pose.phi);
    }
    readings_.push_back(next);
  }
}

std::optional<core::Pose2> OdometryCurve::at(double time_s) const {
  if (readings_.size() < 2 || time_s < readings_.front().time_s || time_s > readings_.back().time_s)
    return std::nullopt;
  while (near_ > 0 && readings_[near_].time_s > time_s) --near_;
  while (near_ + 2 < readings_.size() && readings_[near_ + 1].time_s < time_s) ++near_;
  const auto &a = readings_[near_], &b = readings_[near_ + 1];
  const double gap_s = b.time_s - a.time_s;
  if (gap_s > kLongestGap_s) return std::nullopt;
  const double s = (time_s - a.time_s) / gap_s;
  return core::Pose2{a.pose.x + s * (b.pose.x - a.pose.x), a.pose.y + s * (b.pose.y - a.pose.y),
                     a.pose.phi + s * (b.pose.phi - a.pose.phi)};
}

}  // namespace slam::calibration

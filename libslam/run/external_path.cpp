#include "libslam/run/external_path.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <sstream>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"

namespace slam::run {
namespace {

constexpr double kStampTolerance_s = 1e-4;
/// Of a quaternion's length: what four decimals round away.
constexpr double kUnitTolerance = 1e-3;
/// No robot of ours drives so far.
constexpr double kFarthest_m = 1e6;
constexpr size_t kMostViolations = 20;

/// The scan with the stamp, from `scans` in the order of stamps: (stamp, place in the log).
using ByStamp = std::vector<std::pair<double, size_t>>;

ByStamp byStamp(const std::vector<ScanPlace>& scans) {
  ByStamp order;
  for (size_t i = 0; i < scans.size(); ++i) order.emplace_back(scans[i].time_s, i);
  std::sort(order.begin(), order.end());
  return order;
}

/// The nearest scan to a stamp that is not `taken` yet; where all near ones are, the nearest.
ByStamp::value_type nearestScan(const ByStamp& order, double time_s, const std::vector<bool>& taken) {
  auto at =
      std::lower_bound(order.begin(), order.end(), std::make_pair(time_s - kStampTolerance_s, size_t{0}));
  auto best = at == order.end() ? std::prev(at) : at;
  if (at != order.begin() && std::abs(std::prev(at)->first - time_s) < std::abs(best->first - time_s))
    best = std::prev(at);
  for (; at != order.end() && at->first <= time_s + kStampTolerance_s; ++at) {
    const bool is_nearer = std::abs(at->first - time_s) < std::abs(best->first - time_s);
    if (!taken[at->second] && (taken[best->second] || is_nearer)) best = at;
  }
  return *best;
}

/// Eight numbers, whatever they are; false for anything else.
bool parseEight(const std::string& line, double (&numbers)[8]) {
  std::istringstream words(line);
  std::string word;
  for (double& number : numbers) {
    if (!(words >> word)) return false;
    char* end = nullptr;
    number = std::strtod(word.c_str(), &end);  // "nan" too: that it is not finite is said apart
    if (*end != '\0') return false;
  }
  return !(words >> word);
}

/// What a trajectory's lines say wrong, and right.
class PathChecker {
 public:
  PathChecker(const std::vector<ScanPlace>& scans, std::string name)
      : name_(std::move(name)), order_(byStamp(scans)), taken_(scans.size()), poses_(scans.size()) {}

  void readLine(const std::string& text, int number) {
    const std::string line = files::trimmed(text);
    if (line.empty() || line[0] == '#') return;
    line_ = number;
    double n[8];
    if (!parseEight(line, n))
      return violated("found '" + line.substr(0, 60) + "', expected 8 numbers: time x y z qx qy qz qw");
    if (!std::all_of(std::begin(n), std::end(n), [](double value) { return std::isfinite(value); }))
      return violated("found '" + line.substr(0, 60) + "', expected finite numbers");
    if (std::max(std::abs(n[1]), std::abs(n[2])) > kFarthest_m)
      return violated("found '" + line.substr(0, 60) + "', expected x and y within 1000 km");
    const double length = std::sqrt(n[4] * n[4] + n[5] * n[5] + n[6] * n[6] + n[7] * n[7]);
    if (std::abs(length - 1) > kUnitTolerance)
      return violated("found a quaternion of length " + files::formatNumber(length) + ", expected 1");
    take(n[0],
         {n[1], n[2], core::atan2(2 * (n[7] * n[6] + n[4] * n[5]), 1 - 2 * (n[5] * n[5] + n[6] * n[6]))});
  }

  std::vector<std::string> violations() {
    if (lines_ == 0 && violations_.empty())
      violations_.push_back(name_ + ": holds 0 poses, expected at least 1");
    if (unnamed_ > 0)
      violations_.push_back(name_ + ": and " + std::to_string(unnamed_) +
                            " more lines that break the contract");
    return violations_;
  }
  const std::vector<std::optional<core::Pose2>>& poses() const { return poses_; }

 private:
  void violated(const std::string& what) {
    if (violations_.size() < kMostViolations)
      violations_.push_back(name_ + ":" + std::to_string(line_) + ": " + what);
    else
      ++unnamed_;
  }

  void take(double time_s, const core::Pose2& pose) {
    char text[160];
    const auto [scan_time_s, scan] = nearestScan(order_, time_s, taken_);
    if (std::abs(scan_time_s - time_s) > kStampTolerance_s) {
      std::snprintf(text, sizeof text,
                    "found the stamp %.6f, which is no scan's of the log; the nearest is %.6f", time_s,
                    scan_time_s);
      return violated(text);
    }
    if (taken_[scan]) {
      std::snprintf(text, sizeof text, "found a second pose for the scan with the stamp %.6f, expected one",
                    time_s);
      return violated(text);
    }
    const bool runs_back = lines_ > 0 && time_s < last_time_s_ && scan < last_scan_;
    if (runs_back) {
      std::snprintf(text, sizeof text,
                    "found the stamp %.6f behind %.6f, expected the order of stamps or of the log's scans",
                    time_s, last_time_s_);
      return violated(text);
    }
    ++lines_;
    last_time_s_ = time_s;
    last_scan_ = scan;
    taken_[scan] = true;
    poses_[scan] = pose;
  }

  std::string name_;
  ByStamp order_;
  std::vector<bool> taken_;
  std::vector<std::optional<core::Pose2>> poses_;
  std::vector<std::string> violations_;
  int line_ = 0, lines_ = 0, unnamed_ = 0;
  double last_time_s_ = 0;
  size_t last_scan_ = 0;
};

/// The pose at `scan` between the given ones at `before` and `after`: the odometry from the one, and of what
/// it then misses the other by the share of the scans passed.
core::Pose2 filled(const std::vector<ScanPlace>& scans, const std::vector<std::optional<core::Pose2>>& poses,
                   std::optional<size_t> before, size_t scan, std::optional<size_t> after) {
  const auto moved = [&](size_t from, size_t to) {
    return *poses[from] * core::between(scans[from].T_odom_robot, scans[to].T_odom_robot);
  };
  if (!before) return moved(*after, scan);
  if (!after) return moved(*before, scan);
  const core::Pose2 missing = core::between(moved(*before, *after), *poses[*after]);
  const double share = static_cast<double>(scan - *before) / static_cast<double>(*after - *before);
  return moved(*before, scan) * core::interpolate({}, missing, share);
}

}  // namespace

CheckedPath checkPath(const std::string& text, const std::string& name, const std::vector<ScanPlace>& scans) {
  PathChecker checker(scans, name);
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) checker.readLine(line, ++number);
  CheckedPath checked;
  checked.violations = checker.violations();
  if (!checked.violations.empty()) return checked;

  const auto& poses = checker.poses();
  std::vector<std::optional<size_t>> after(scans.size());
  for (size_t i = scans.size(); i-- > 0;)
    after[i] = poses[i] ? std::optional<size_t>(i) : i + 1 < scans.size() ? after[i + 1] : std::nullopt;
  std::optional<size_t> before;
  for (size_t i = 0; i < scans.size(); ++i) {
    if (poses[i]) before = i;
    checked.filled_poses += poses[i] ? 0 : 1;
    checked.path.push_back(
        {scans[i].time_s, poses[i] ? *poses[i] : filled(scans, poses, before, i, after[i])});
  }
  const core::Pose2 T_map_first = checked.path.front().pose;
  for (auto& stamped : checked.path) stamped.pose = core::between(T_map_first, stamped.pose);
  return checked;
}

}  // namespace slam::run

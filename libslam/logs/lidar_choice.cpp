#include "libslam/logs/lidar_choice.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/middle_value.h"

namespace slam::logs {
namespace {

constexpr double kLevel_rad = core::degToRad(5.0);
constexpr double kOnRobot_m = 2;  // a robot indoors is not longer
constexpr double kLeastDisagreement_s = 0.2, kPeriods = 3;

const SeenScan* firstOf(const std::vector<SeenScan>& seen, const std::string& label) {
  const auto it =
      std::find_if(seen.begin(), seen.end(), [&](const auto& s) { return s.scan->lidar == label; });
  return it == seen.end() ? nullptr : &*it;
}

double periodOf(const std::vector<SeenScan>& seen, const std::string& label) {
  std::vector<double> periods_s;
  const lidar::Scan* last = nullptr;
  for (const auto& [scan, tilt_rad] : seen) {
    if (scan->lidar != label) continue;
    if (last != nullptr) periods_s.push_back(scan->scan.time_s - last->time_s);
    last = &scan->scan;
  }
  return core::middleValue(periods_s);
}

/// How much later the stamps of `label` are than those of `main` next to them in the file, where they
/// disagree; else 0.
double disagreement(const std::vector<SeenScan>& seen, const std::string& main, const std::string& label) {
  std::vector<double> later_s;
  const lidar::Scan* last = nullptr;
  for (const auto& [scan, tilt_rad] : seen) {
    if (scan->lidar == main) last = &scan->scan;
    if (scan->lidar == label && last != nullptr) later_s.push_back(scan->scan.time_s - last->time_s);
  }
  const double limit_s = std::max(kLeastDisagreement_s, kPeriods * periodOf(seen, main));
  const double middle_s = core::middleValue(later_s);
  return std::abs(middle_s) > limit_s ? middle_s : 0;
}

std::string disagreementText(const std::string& main, const std::string& label, double later_s) {
  char text[400];
  std::snprintf(text, sizeof text,
                "the stamps of lidar '%s' are %.3f s %s those of '%s' beside them in the log", label.c_str(),
                std::abs(later_s), later_s > 0 ? "after" : "before", main.c_str());
  return text;
}

/// True when most returns of one are, beam by beam, those of the other.
bool repeats(const lidar::Scan& a, const lidar::Scan& b) {
  if (a.ranges_m.size() != b.ranges_m.size()) return false;
  size_t returns = 0, same = 0;
  for (size_t i = 0; i < a.ranges_m.size(); ++i) {
    if (!lidar::isReturn(a.ranges_m[i])) continue;
    ++returns;
    same += a.ranges_m[i] == b.ranges_m[i];
  }
  return returns > 0 && 2 * same > returns;
}

/// True when `label` gives again what `other` gave before or after it.
bool isCopy(const std::vector<SeenScan>& seen, const std::string& label, const std::string& other) {
  size_t scans = 0, copies = 0;
  for (size_t i = 0; i < seen.size(); ++i) {
    if (seen[i].scan->lidar != label) continue;
    ++scans;
    constexpr size_t kAbout = 3;
    bool is_copy = false;
    for (size_t k = i > kAbout ? i - kAbout : 0; k < std::min(i + kAbout + 1, seen.size()); ++k)
      is_copy |= seen[k].scan->lidar == other && repeats(seen[k].scan->scan, seen[i].scan->scan);
    copies += is_copy;
  }
  return 2 * copies > scans;
}

/// Why it cannot be taken beside the others; "" where it can.
std::string objection(const std::vector<SeenScan>& seen, const std::vector<std::string>& taken,
                      const std::string& label) {
  const SeenScan& first = *firstOf(seen, label);
  const auto& mount = first.scan->scan.T_robot_lidar;
  char text[200];
  if (first.tilt_rad > kLevel_rad) {
    std::snprintf(text, sizeof text, "it is tilted by %.1f deg, expected level to %.0f deg",
                  core::radToDeg(first.tilt_rad), core::radToDeg(kLevel_rad));
    return text;
  }
  if (core::hypot(mount.x, mount.y) > kOnRobot_m) {
    std::snprintf(text, sizeof text, "its mounting x %.2f m, y %.2f m is outside of any robot of this kind",
                  mount.x, mount.y);
    return text;
  }
  for (const auto& other : taken) {
    if (isCopy(seen, label, other)) return "it repeats the readings of '" + other + "'";
    if (lidar::areOfOneLidar(first.scan->scan, firstOf(seen, other)->scan->scan))
      return "the log says that it is mounted where '" + other + "' is";
  }
  if (const double later_s = disagreement(seen, taken.front(), label); later_s != 0)
    return disagreementText(taken.front(), label, later_s);
  return "";
}

}  // namespace

std::vector<std::string> namedLidars(const std::string& wanted) {
  std::vector<std::string> labels;
  if (wanted.empty() || wanted == kAllLidars) return labels;
  for (size_t from = 0; from <= wanted.size();) {
    const size_t to = std::min(wanted.find(',', from), wanted.size());
    const std::string label = wanted.substr(from, to - from);
    if (std::find(labels.begin(), labels.end(), label) == labels.end()) labels.push_back(label);
    from = to + 1;
  }
  return labels;
}

LidarChoice mainLidar(const std::vector<SeenScan>& seen) {
  std::map<std::string, size_t> scans;
  for (const auto& [scan, tilt_rad] : seen) ++scans[scan->lidar];
  LidarChoice choice;
  size_t most = 0;
  for (const auto& [scan, tilt_rad] : seen)
    if (scans[scan->lidar] > most) most = scans[scan->lidar], choice.labels = {scan->lidar};
  return choice;
}

LidarChoice allLidars(const std::vector<SeenScan>& seen) {
  LidarChoice choice = mainLidar(seen);
  std::vector<std::string> looked_at = choice.labels;
  for (const auto& [scan, tilt_rad] : seen) {
    const std::string& label = scan->lidar;
    if (std::find(looked_at.begin(), looked_at.end(), label) != looked_at.end()) continue;
    looked_at.push_back(label);
    const std::string why = objection(seen, choice.labels, label);
    if (why.empty())
      choice.labels.push_back(label);
    else
      choice.passed_over.push_back("lidar '" + label + "' is passed over: " + why);
  }
  return choice;
}

void requireAgreement(const std::string& path, const std::vector<SeenScan>& seen,
                      const std::vector<std::string>& labels) {
  for (size_t i = 1; i < labels.size(); ++i)
    if (const double later_s = disagreement(seen, labels.front(), labels[i]); later_s != 0)
      throw core::InputError(path + ": " + disagreementText(labels.front(), labels[i], later_s));
}

std::string impossibleSweep(const std::vector<SeenScan>& seen, const std::string& label) {
  constexpr double kJitter = 1.2;  // of the stamps; a sweep may take the whole period
  const double period_s = periodOf(seen, label);
  if (!(period_s > 0)) return "";
  for (const auto& [scan, tilt_rad] : seen) {
    if (scan->lidar != label || !scan->sweep || scan->sweep->duration_s <= kJitter * period_s) continue;
    char text[300];
    std::snprintf(
        text, sizeof text,
        "lidar '%s': the log states a sweep of %.4g s, longer than the %.4g s between two scans: the "
        "scans are taken as they are",
        label.c_str(), scan->sweep->duration_s, period_s);
    return text;
  }
  return "";
}

}  // namespace slam::logs

#include "libslam/doctor/finding_rules.h"

namespace slam::doctor {

std::vector<Finding> FindingRules::all() {
  format();
  damage();
  skipped();
  scans();
  if (f_.ranges.scans > 0) {
    stamps();
    units();
    geometry();
    noReturns();
    lost();
    beams();
    duplicates();
    if (isInMetres()) {
      matching();
      view();
      sweep();
    }
  }
  odometry();
  if (f_.best_odometry >= 0 && f_.ranges.scans > 0 && isInMetres()) {
    clock();
    scale();
    disagreements();
  }
  if (f_.ranges.scans > 0) mounting();
  truth();
  return std::move(findings_);
}

void FindingRules::say(const char* key, Severity severity, std::string what, std::string advice) {
  findings_.push_back({key, severity, std::move(what), std::move(advice)});
}

std::string severityName(Severity severity) {
  return severity == Severity::kNote ? "note" : severity == Severity::kWarning ? "warning" : "error";
}

const std::vector<FindingKey>& findingKeys() {
  static const std::vector<FindingKey> keys = {
      {"format", "what kind of log it is"},
      {"damage", "where it breaks off"},
      {"skipped", "what the reader passes over"},
      {"scans", "no laser scans, or scans of no use"},
      {"backward", "stamps earlier than the one before, per stream"},
      {"repeated", "stamps equal to the one before, per stream"},
      {"gaps", "pauses of more than ten periods, per stream"},
      {"unstamped", "scans without a stamp"},
      {"order", "objects of different streams out of order"},
      {"units", "ranges that are not in metres"},
      {"lidar", "beams, field of view, ranges; whether they change"},
      {"no_return", "the reading of a beam that meets nothing, found from the data"},
      {"lost", "readings that are none"},
      {"beams", "beams that are dead, silent or stuck"},
      {"duplicates", "scans that repeat the one before"},
      {"matching", "scans that do not fit on the one before"},
      {"view", "the field of view, by how well scans lie on one another"},
      {"sweep", "how long the lidar takes from its first to its last beam, as turns show it"},
      {"odometry", "what there is"},
      {"jumps", "odometry steps too far for a robot"},
      {"clock", "odometry's stamps against those of the scans"},
      {"scale", "odometry's distances against scan matching"},
      {"heading", "odometry's turns and drift against scan matching"},
      {"disagree", "places where odometry and scans contradict one another"},
      {"mounting", "the lidar's pose on the robot, and what turns say of it"},
      {"truth", "true poses inside the log"}};
  return keys;
}

std::vector<Finding> findingsOf(const LogFigures& figures) {
  return FindingRules(figures).all();
}

}  // namespace slam::doctor

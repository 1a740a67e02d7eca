#include "libslam/check/rules.h"

namespace slam::check {

void checkStart(Sheet& sheet) {
  const Reach reach = reachOfRobot(sheet);
  const int covered = cv::countNonZero(reach.body);
  if (covered > 0) return;
  Finding finding;
  finding.key = "start";
  finding.severity = Severity::kError;
  finding.text = "no place for a robot of side " + metres(sheet.options.robot_side_m) + " m at " +
                 files::formatNumber(sheet.resolution_m) + " m a pixel";
  finding.remedy = "cannot help: give --resolution, or a smaller --robot-side";
  sheet.findings.push_back(finding);
}

}  // namespace slam::check

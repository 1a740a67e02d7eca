#include "apps/plan_warnings.h"

#include "apps/commands.h"
#include "apps/quiet.h"
#include "libslam/check/plan_check.h"
#include "libslam/core/error.h"
#include "libslam/robot/drive.h"

namespace slam::apps {

void warnOfPlan(const Context& context, const std::string& plan_path) {
  if (context.quiet) return;
  check::PlanCheckOptions options;
  options.robot_side_m = robot::RobotOptions().side_m;
  options.only = {"thresholds", "leaks", "open_edge"};
  bool has_warned = false;
  for (const auto& finding : check::checkPlan(plan_path, options).findings) {
    if (finding.severity == check::Severity::kNote) continue;
    note(context, "warning: " + plan_path + ": " + finding.text);
    has_warned = true;
  }
  if (has_warned) note(context, "'rasterslam world check " + plan_path + "' says more, and --fix mends");
}

}  // namespace slam::apps

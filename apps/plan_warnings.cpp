#include "apps/plan_warnings.h"

#include <cstdio>

#include "apps/commands.h"
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
    std::fprintf(stderr, "rasterslam: warning: %s: %s\n", plan_path.c_str(), finding.text.c_str());
    has_warned = true;
  }
  if (has_warned)
    std::fprintf(stderr, "rasterslam: 'rasterslam world check %s' says more, and --fix mends\n",
                 plan_path.c_str());
}

}  // namespace slam::apps

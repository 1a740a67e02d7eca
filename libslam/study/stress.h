#pragma once
#include <set>
#include <string>
#include <vector>

#include "libslam/draw/curves.h"
#include "libslam/files/ini.h"
#include "libslam/summary/run_figures.h"
#include "libslam/sweep/suite.h"
#include "libslam/sweep/sweep_plan.h"
#include "libslam/table/table.h"

namespace slam::study {

/// What to vary, and on what ground.
struct StressRequest {
  std::string ground;  ///< a suite's .ini, or an entry of a suite's list of worlds: plan, world, KIND:seed=3
  std::string vary;    ///< KEY=VALUES as readValueRange() reads them: "lidar.fov_deg=30..360:6"
  std::string methods,
      seeds;  ///< in place of the suite's; ""  = the suite's (for a world: graph, icp_exact; 1..5)
  files::IniFile settings;  ///< of the simulation, over the suite's own sections
};

/// A suite in which one parameter takes several values, and where each stands.
struct StressSuite {
  sweep::Suite suite;
  std::string key;
  std::vector<double> values;  ///< ascending
  std::vector<std::set<std::string>>
      names;  ///< values[i] is where the world or the fault has one of names[i]
  bool is_of_world = false;
};

/// KEY is one of the simulation ("lidar.fov_deg", "odometry.slips_per_m", "living.people"), which then is an
/// axis of faults, each laid over everything else; or `world.` and a key of [building] ("world.width_m"), for
/// the worlds that are generated. Without steps 6 values. A parameter that takes whole numbers gets whole
/// numbers. Errors (InputError): as readSuite() and readValueRange(); unknown key; a suite that has faults of
/// its own (but built-in), or logs that exist already; world.KEY where a world is not generated.
StressSuite stressSuite(const StressRequest& request);

/// What a method has to keep to.
struct StressLimits {
  double failure_rate = 0.1;
  double error = 0;  ///< of the suite's metric, in its unit; 0: none
};

/// Where a method breaks. It is broken at a value when there the exact 95 % interval of its failure rate lies
/// above the limit, or that of its median error lies above the error's limit; what the seeds do not prove is
/// not called broken. With a limit of 0.1 that takes 2 failures of 2, 3 of 5, 4 of 10 (proportion.h).
struct BreakingPoint {
  std::string method;
  std::vector<double> broken;   ///< values, ascending
  std::vector<double> unknown;  ///< values without any run
  /// For people: "holds everywhere", "breaks at 90 and below (holds at 156)", "broken everywhere", and what
  /// lies between. "At v and below" says that it is broken at v and at every smaller value that was tried.
  /// "Holds everywhere" is said only where no run failed; failures that prove nothing are told: "not proven
  /// to break; failed, too few to prove it: 1 of 3 at 90".
  std::string text;
};

struct StressResult {
  table::Table
      main;  ///< one row per value and method: runs, failures and median error, each with its interval
  table::Table all;  ///< every figure in a column of its own
  std::vector<BreakingPoint> breaks;
  std::vector<draw::Chart> charts;  ///< median error and failure rate over the value, whiskers = intervals
};

/// Statistics of a stress suite's runs, pooled over the other axes (drawn within each of their settings,
/// settingsOf()) and the seeds. A failed run counts as worse than any other
/// (rankedValue()). results[i] is of plan.runs[i]. REQUIRES a metric of which less is better for an error
/// limit (InputError). The same bytes for the same results.
StressResult stress(const StressSuite& suite, const sweep::SweepPlan& plan,
                    const summary::SweepResults& results, const StressLimits& limits);

}  // namespace slam::study

#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/sweep/suite.h"
#include "libslam/table/table.h"

namespace slam::sweep {

/// One log of a sweep: made once, mapped by every method. `world` is the name of an existing log where there
/// is nothing to simulate; then the other axes are "-" and the seed is 0.
struct PlannedLog {
  std::string id;
  std::string world, robot, lidar, odometry, strategy, fault;
  std::uint64_t seed = 0;
  bool simulated = true;
};

/// One method on one log.
struct PlannedRun {
  std::string id;
  std::size_t log = 0;  ///< index
  std::uint64_t seed = 0;
  std::string method, parameters;  ///< as in SuiteMethod
};

/// The cells of a sweep, in the order of its lists (the last list runs fastest). plan.json of a sweep's
/// folder.
struct SweepPlan {
  std::string name;          ///< the suite's file name without suffix
  std::string code;          ///< resources::codeVersion() that made the ids
  std::string suite_folder;  ///< Suite::folder
  std::string baseline, metric;
  double failure_ate_m = 0;
  std::vector<PlannedLog> logs;
  std::vector<PlannedRun> runs;
};

/// A suite and its cells. specs[i] is the text that names all that decides the cell: its configuration after
/// all layers, seed, the bytes of its inputs (as hashes) and the code; the id is the beginning of its
/// SHA-256.
struct Sweep {
  Suite suite;
  SweepPlan plan;
  std::vector<std::string> log_specs, run_specs;  ///< "" for a log that exists already
  std::vector<std::size_t> ground;                ///< of plan.logs: index into suite.worlds or suite.logs
};

/// Lists the cells. Errors: two cells that are the same (InputError).
Sweep planSweep(Suite suite);
/// Reads a suite and lists its cells; of the copy suite.ini in a sweep's folder the very cells of that sweep,
/// whose relative paths still start from where the suite came from. Errors: as readSuite() and planSweep().
Sweep planSweep(const std::string& suite_path);

/// plan.json in a folder: the same bytes for the same suite and code. The suite's folder is written as seen
/// from there, so that both can be moved together, and no path of one machine stands in results.
std::string toJson(const SweepPlan& plan, const std::string& folder);
/// Whether two plans have the same cells, wherever their suites lie.
bool areSame(const SweepPlan& a, const SweepPlan& b);
/// Reads it back, the suite's folder as an absolute path. Errors: InputError with the path.
SweepPlan readSweepPlan(const std::string& path);

/// One row per run, for people.
table::Table planTable(const SweepPlan& plan);

/// The id that a spec gives: 16 hexadecimal digits.
std::string cellId(const std::string& spec);

}  // namespace slam::sweep

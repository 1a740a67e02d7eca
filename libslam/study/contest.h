#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/summary/run_figures.h"
#include "libslam/sweep/suite.h"
#include "libslam/table/table.h"

namespace slam::study {

/// Who takes part, and on what ground.
struct ContestRequest {
  std::vector<std::string>
      entries;  ///< methods by name, or .ini files: of external programs, or of ours with other settings
  std::string suite_path;  ///< its methods and seeds are replaced, and the seeds of its generated worlds
  std::uint64_t seed = 1;  ///< draws buildings and drives: unknown to who enters
  int seeds = 5;           ///< drives in each setting
  std::string folder;      ///< that relative paths of entries start from; "": where the program runs
};

/// The sweep of a contest. Every generated world gets a seed of the stream "contest worlds", every drive one
/// of "contest drives", so that the same --seed gives the same contest, and another one gives buildings that
/// nobody has tuned on. A suite without generated worlds keeps its plans. Errors (InputError): as
/// readSuite(); fewer than two entries; an entry that is no file and no method; two of one name.
sweep::Suite contestSuite(const ContestRequest& request);

/// Who stands where.
struct Standings {
  table::Table table;                ///< best first; what went wrong first stands below it
  table::Table full;                 ///< the same with what went wrong in a column
  std::vector<std::string> verdict;  ///< sentences
};
/// From the runs of a contest's sweep: place, median of the metric with interval, mean rank over the drives,
/// failed runs, group (entries that share a letter cannot be told apart: stats::rankingGroups(), 5 %, ranked
/// within each setting), what went wrong in the first run that failed. Entries whose groups overlap with the
/// best one's share the first place. A failed run is worse than any other. results[i] is of plan.runs[i];
/// drives in which a run is missing do not count. The same bytes for the same results.
Standings standingsOf(const sweep::SweepPlan& plan, const summary::SweepResults& results);

}  // namespace slam::study

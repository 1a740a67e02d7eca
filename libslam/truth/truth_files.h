#pragma once
#include <string>

namespace slam::truth {

/// The file `ending` beside a log or its truth: "a/run.rawlog" or "a/run.gt.tum" and ".collisions.csv" give
/// "a/run.collisions.csv". Of a log with another ending it is part of the name: "a/run.clf.collisions.csv".
std::string besideLog(const std::string& log_or_truth_path, const std::string& ending);

/// Truth beside a log, as `record()` (STEM.gt.tum, LOG.GT.txt) and edit::convertLog() (STEM.truth.tum) leave
/// it; "" when there is none.
std::string findTruth(const std::string& log_path);
/// The plan that a log was simulated in, from its manifest: the one beside the log of a later visit; "" when
/// unknown or no longer the same file.
std::string findPlan(const std::string& log_path);
/// What a log is scored on: what is given, else what the two above find. "" = none.
struct TruthFiles {
  std::string trajectory, plan;
};
TruthFiles truthFiles(const std::string& log_path, const std::string& given_trajectory,
                      const std::string& given_plan);

}  // namespace slam::truth

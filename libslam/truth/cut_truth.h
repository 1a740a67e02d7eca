#pragma once
#include <string>
#include <vector>

namespace slam::truth {

/// Gives a part of a log what the whole has beside it: the true path of its time, STEM.gt.tum, and
/// STEM.manifest.json that names the plan, so that findTruth() and findPlan() find both. Nothing where the
/// whole has no truth in TUM's form. Returns the files that were written, over whatever stood there. Errors:
/// InputError for a broken truth; IoError.
std::vector<std::string> keepTruth(const std::string& whole_log, const std::string& part_log);

}  // namespace slam::truth

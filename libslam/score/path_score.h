#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/score/evaluate.h"
#include "libslam/table/table.h"

namespace slam::score {

/// A distance of true path, or a time, over which relative pose errors are taken.
struct RpeStep {
  double length = 1;  ///< metres or seconds, above 0
  bool is_time = false;
};
/// "1m,10m,1s" in its order. Errors: InputError with the option's name and the word that is none.
std::vector<RpeStep> parseRpeSteps(const std::string& text, const std::string& option);

/// A row per step: how many pairs of poses, root mean square and largest error of their relative motion
/// (metrics::relativeErrorOverDistance(), ...OverTime()).
table::Table rpeTable(const core::Trajectory& truth, const core::Trajectory& estimate,
                      const std::vector<RpeStep>& steps);

/// A path by itself against the truth: its absolute errors, in one row. Errors: InputError where no stamp is
/// common.
table::Table pathTable(const std::string& name, const core::Trajectory& truth,
                       const core::Trajectory& estimate, const Alignment& alignment);

/// Whether the estimate moves when the truth does: correlation of distances, or of turns, over 1 s, whichever
/// is higher. An estimate may be far off and still moves in time; one of another drive does not. NaN with
/// less than 10 s in common or where the truth never changes its pace.
double motionAgreement(const core::Trajectory& truth, const core::Trajectory& estimate);
/// Below this the truth is that of another run.
inline constexpr double kLeastMotionAgreement = 0.3;

}  // namespace slam::score

#pragma once
#include <string>
#include <vector>

#include "libslam/run/gate.h"
#include "libslam/run/sweep_plan.h"
#include "libslam/run/sweep_tables.h"

namespace slam::run {

/// Every figure of a sweep that has a better side, by method and setting, with its seeds. The cell is "graph on flat", with
/// the other axes where they are not the built-in ones: "graph keyframe_m=0.5 on flat, lidar tim571, fault crowd". A run that
/// failed (isFailed()) has failed by every figure; one that is missing, or has no such figure, is NaN.
std::vector<Score> scoresOf(const SweepPlan& plan, const SweepResults& results);

/// Of the scores those that a sweep is held against unless the baseline's file says more: the figures of the summary
/// (summaryKeys()).
std::vector<Score> summaryScoresOf(const SweepPlan& plan, const SweepResults& results);

}  // namespace slam::run

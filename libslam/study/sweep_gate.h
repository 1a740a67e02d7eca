#pragma once
#include <string>
#include <vector>

#include "libslam/score/gate.h"
#include "libslam/summary/run_figures.h"
#include "libslam/sweep/sweep_plan.h"

namespace slam::study {

/// Every figure of a sweep that has a better side, by method and setting, with its seeds. The cell is "graph
/// on flat", with the other axes where they are not the built-in ones: "graph keyframe_m=0.5 on flat, lidar
/// tim571, fault crowd". A run that failed (isFailed()) has failed by every figure; one that is missing, or
/// has no such figure, is NaN.
std::vector<score::Score> scoresOf(const sweep::SweepPlan& plan, const summary::SweepResults& results);

/// Of the scores those that a sweep is held against unless the baseline's file says more: the figures of the
/// summary (summaryKeys()).
std::vector<score::Score> summaryScoresOf(const sweep::SweepPlan& plan, const summary::SweepResults& results);

}  // namespace slam::study

#include <algorithm>
#include <utility>

#include "libslam/bundle/surface_bundle.h"
#include "libslam/core/elementary.h"
#include "libslam/graph/graph_slam.h"

namespace slam::graph {
namespace {

/// When no keyframe moves as far, the poses are found.
constexpr double kStill_m = 1e-3;
core::Pose2 movedBy(const core::Pose2& T, const Eigen::Vector3d& by) {
  return {T.x + by.x(), T.y + by.y(), core::wrapToPi(T.phi + by.z())};
}

}  // namespace

/// All keyframes' poses are found together by what they saw of the same walls, see bundle::SurfaceBundle;
/// what else was matched there goes with the map around.
void GraphSlam::refine(core::Progress& progress) {
  if (isRefined()) return;
  progress.begin("fitting all scans");  // ended by whoever ends the finishing
  const bundle::SharedSurfaces shared(*map_);
  for (int round = 0; round < options_.refine_rounds; ++round) {
    const auto tell = [&] { progress.update(static_cast<double>(round) / options_.refine_rounds, 0); };
    tell();
    const bundle::SurfaceBundle bundle(*map_, shared, tell);
    const auto step = bundle.step();
    if (step.empty()) break;
    const auto around = bundle.stepAround(step);
    for (size_t scan = 0; scan < records_.size(); ++scan) {
      auto& [k, T_keyframe_robot, drift] = records_[scan];
      if (map_->keyframe(k).scan == static_cast<int>(scan)) continue;
      const auto i = static_cast<size_t>(k);
      T_keyframe_robot = core::between(movedBy(map_->pose(k), step[i]), movedBy(map_->pose(k), around[i])) *
                         T_keyframe_robot;
    }
    double farthest_m = 0;
    for (int k = 0; k < map_->size(); ++k) {
      const Eigen::Vector3d& by = step[static_cast<size_t>(k)];
      map_->graph().setPose(k, movedBy(map_->pose(k), by));
      farthest_m = std::max(farthest_m, by.head<2>().norm());
    }
    map_->countRevision();
    map_->note(core::JournalEvent::kOptimised, bundle.chi2(), -1, "refinement");
    if (farthest_m < kStill_m) break;
  }
  refined_ = {map_->size(), map_->revision()};
}

}  // namespace slam::graph

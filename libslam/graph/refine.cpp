#include <algorithm>

#include "libslam/graph/graph_slam.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/posegraph/optimize.h"

namespace slam::graph {

/// Every keyframe is matched to the map of all others around it, as they stand now; the matches become the
/// graph's edges, beside those of odometry and of loops, and all poses are found together. In the spirit of
/// Ruhnke et al., ICRA 2011, with surfels for surfaces.
void GraphSlam::refine() {
  const auto match_options = keyframes::matchOptions(10);
  scanmatch::PosePrior flat;
  flat.information.setIdentity();
  scanmatch::SurfelMap map(options_.cell_m, options_.blur_m, true, true);
  posegraph::OptimizeOptions solve;
  solve.robust = "none";
  const int n = map_->size();
  for (int round = 0; round < options_.refine_rounds; ++round) {
    posegraph::PoseGraph next;
    for (int k = 0; k < n; ++k) next.addNode(map_->pose(k));
    next.setFixed(0);
    for (int k = 1; k < n; ++k)
      next.addEdge(map_->graph().edges()[static_cast<size_t>(map_->keyframe(k).odometry_edge)]);
    for (const auto& edge : map_->graph().edges())
      if (edge.kind == posegraph::EdgeKind::kLoop && edge.on) next.addEdge(edge);
    for (int k = 0; k < n; ++k) {
      const core::Pose2& T = map_->pose(k);
      auto around = map_->keyframesAround(k, core::position(T), options_.map_path_m, options_.map_radius_m);
      around.erase(std::remove(around.begin(), around.end(), k), around.end());
      around = keyframes::firstOf(std::move(around), options_.map_keyframes);
      map.clear(core::position(T), keyframes::kMapReach_m);
      for (const int other : around) map.add(map_->inCells(other));
      flat.mean = T;
      const auto matched = alignToSurfels(map_->keyframe(k).points, map, T, flat, match_options);
      const auto partners = map_->partnersOf(k, around, matched.T_map_robot);
      if (partners.empty()) continue;
      posegraph::Edge edge;
      edge.to = k;
      const Eigen::Matrix3d told =
          keyframes::toldInformation(map_->keyframe(k).points, map, matched.T_map_robot);
      edge.information =
          scanmatch::edgeInformation(told, matched.T_map_robot.phi) / static_cast<double>(partners.size());
      for (const int partner : partners) {
        edge.from = partner;
        edge.T_from_to = core::between(map_->pose(partner), matched.T_map_robot);
        next.addEdge(edge);
      }
    }
    const auto result = optimize(next, solve);
    for (int k = 0; k < n; ++k) map_->graph().setPose(k, next.pose(k));
    map_->countRevision();
    map_->note(core::JournalEvent::kOptimised, result.final_chi2, -1, "refinement");
  }
}

}  // namespace slam::graph

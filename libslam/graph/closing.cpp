#include <utility>

#include "libslam/graph/graph_slam.h"
#include "libslam/posegraph/optimize.h"

/// All poses are found anew when a loop is closed. That takes the longer the larger the map is, and no scan
/// may wait for it: it is done in pieces, one with every scan, on a copy of the graph. Meanwhile the robot is
/// tracked in the map as it was, and no other loop is looked for.
namespace slam::graph {
namespace {

using core::Pose2;

/// Multiplications that one scan has to wait for: about 6 ms on a machine of 2020.
constexpr double kWorkPerScan = 3e7;
/// All poses together are found to so many standard deviations; the last step makes it the square of that.
constexpr double kFound = 0.05;

}  // namespace

/// `is_linked`: the loop's ends lie where they belong already, as parts do that were just joined.
void GraphSlam::beginClosing(const Hypothesis& loop, bool is_linked) {
  posegraph::OptimizeOptions options;
  // Loops are judged whole, by accept(); one edge of a loop is no loop.
  options.robust = "none";
  options.tolerance = kFound;
  closing_.emplace();
  closing_->work = std::make_unique<posegraph::OptimizeInPieces>(graph_, options);
  closing_->ends = {loop.old_keyframe, loop.keyframe};
  closing_->edges = loop.edges;
  if (!is_linked) return;
  for (const auto& edge : closing_->edges) link(edge.from, edge.to);
  closing_->edges.clear();
}

/// One piece, before a scan is looked at. What a doubt holds of the map would not move with it.
void GraphSlam::continueClosing() {
  if (!closing_) return;
  if (!closing_->is_found) {
    closing_->is_found = closing_->work->advance(kWorkPerScan);
  } else if (doubt_.begins < 0 && held_back_ == 0) {
    takeOver();
  }
}

void GraphSlam::completeClosing() {
  if (closing_) takeOver();
}

/// The poses that were found; keyframes that came since lie as before to those that they were reached from.
void GraphSlam::takeOver() {
  const double chi2 = closing_->work->finish().final_chi2;
  const std::vector<Pose2> before = graph_.poses();
  const auto& found = closing_->work->poses();
  const int known = static_cast<int>(found.size());
  for (int k = 0; k < graph_.nodeCount(); ++k) {
    if (k < known) {
      graph_.setPose(k, found[static_cast<size_t>(k)]);
      continue;
    }
    const int from = graph_.edges()[static_cast<size_t>(keyframe(k).odometry_edge)].from;
    const Pose2 T_from_k = core::between(before[static_cast<size_t>(from)], before[static_cast<size_t>(k)]);
    graph_.setPose(k, graph_.pose(from) * T_from_k);
  }
  for (const auto& edge : closing_->edges) link(edge.from, edge.to);
  closures_.push_back(closing_->ends);
  closing_.reset();
  settle();
  setMapHere();
  searched_m_ = path_m_;
  note(core::JournalEvent::kOptimised, chi2);
}

}  // namespace slam::graph

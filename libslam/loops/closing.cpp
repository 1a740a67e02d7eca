#include <limits>
#include <memory>

#include "libslam/loops/loop_closer.h"
#include "libslam/posegraph/optimize.h"

/// All poses are found anew when a loop is closed. That takes the longer the larger the map is, and no scan
/// may wait for it: it is done in pieces, one with every scan, on a copy of the graph. Meanwhile the robot is
/// tracked in the map as it was, and no other loop is looked for.
namespace slam::loops {
namespace {

using core::Pose2;

/// All poses together are found to so many standard deviations; the last step makes it the square of that.
constexpr double kFound = 0.05;
/// To find out how sure the ways are takes as long as so many multiplications for each keyframe.
constexpr double kWorkPerWay = 7000;

}  // namespace

void LoopCloser::beginClosing() {
  search_.giveUp();
  posegraph::OptimizeOptions options;
  // Loops are judged whole, by accept(); one edge of a loop is no loop.
  options.robust = "none";
  options.tolerance = kFound;
  closing_.emplace();
  closing_->work = std::make_unique<posegraph::OptimizeInPieces>(map_->graph(), options);
  solved_edges_ = map_->graph().edges().size();
}

/// `is_linked`: the loop's ends lie where they belong already, as parts do that were just joined.
void LoopCloser::beginClosing(const keyframes::Hypothesis& loop, bool is_linked) {
  beginClosing();
  closing_->ends = {loop.old_keyframe, loop.keyframe};
  closing_->edges = loop.edges;
  if (!is_linked) return;
  for (const auto& edge : closing_->edges) map_->link(edge.from, edge.to);
  closing_->edges.clear();
}

bool LoopCloser::continueClosing(bool may_move) {
  if (!isClosing()) return false;
  if (closing_ && !closing_->is_found) {
    const double most = workOfScan();
    double work = most;
    closing_->is_found = closing_->work->advance(work);
    // To take them over is work, too.
    if (!closing_->is_found || work < most / 2) return false;
  }
  if (!may_move) return false;
  if (!closing_) return updateCovariances(workOfScan());
  takeOver();
  return true;
}

bool LoopCloser::completeClosing() {
  if (!isClosing()) return false;
  if (closing_) takeOver();
  return updateCovariances(std::numeric_limits<double>::infinity());
}

/// In two pieces where the map is large. True when all is done.
bool LoopCloser::updateCovariances(double work) {
  if (has_old_ways_) {
    map_->updateWays();
    has_old_ways_ = false;
    if (kWorkPerWay * map_->size() > work) return false;
  }
  map_->updateCovariances();
  has_old_covariances_ = false;
  return true;
}

bool LoopCloser::closeRest() {
  // A shorter way has one pass through each place.
  if (map_->path_m() < options_->map_path_m) return false;
  if (isClosing() || map_->graph().edges().size() == solved_edges_) return false;
  beginClosing();
  return completeClosing();
}

/// The poses that were found; keyframes that came since lie as before to those that they were reached from.
void LoopCloser::takeOver() {
  const double chi2 = closing_->work->finish().final_chi2;
  const std::vector<Pose2> before = map_->graph().poses();
  const auto& found = closing_->work->poses();
  const int known = static_cast<int>(found.size());
  for (int k = 0; k < map_->size(); ++k) {
    if (k < known) {
      map_->graph().setPose(k, found[static_cast<size_t>(k)]);
      continue;
    }
    const int from = map_->keyframeBefore(k);
    const Pose2 T_from_k = core::between(before[static_cast<size_t>(from)], before[static_cast<size_t>(k)]);
    map_->graph().setPose(k, map_->pose(from) * T_from_k);
  }
  for (const auto& edge : closing_->edges) map_->link(edge.from, edge.to);
  if (closing_->ends.first != closing_->ends.second)
    map_->addClosure(closing_->ends.first, closing_->ends.second);
  closing_.reset();
  for (auto& place : hypotheses_) place.innovation = -1;
  map_->settle();
  has_old_covariances_ = has_old_ways_ = true;
  searched_m_ = map_->path_m();
  map_->note(core::JournalEvent::kOptimised, chi2);
}

}  // namespace slam::loops

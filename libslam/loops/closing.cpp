#include <limits>
#include <memory>

#include "libslam/loops/loop_closer.h"
#include "libslam/posegraph/optimize.h"

/// All poses are found anew when a loop is closed. That takes the longer the larger the map is, and no scan
/// may wait for it: it is done in pieces, one with every scan, on a copy of the graph. Meanwhile the robot is
/// tracked in the map as it was, and no other loop is looked for.
namespace slam::loops {
namespace {

/// All poses together are found to so many standard deviations; the last step makes it the square of that.
constexpr double kFound = 0.05;

}  // namespace

void LoopCloser::beginClosing(Settling::What what) {
  search_.giveUp();
  posegraph::OptimizeOptions options;
  // Loops are judged whole, by accept(); one edge of a loop is no loop.
  options.robust = "none";
  options.tolerance = kFound;
  const auto settling = std::make_shared<Settling>(*map_, options, what);
  threads::PacedWork work([settling](double& left) { return settling->advance(left); }, where_);
  closing_.emplace(Closing{settling, std::move(work), {}, {-1, -1}, false});
  solved_edges_ = map_->graph().edges().size();
}

/// `is_linked`: the loop's ends lie where they belong already, as parts do that were just joined.
void LoopCloser::beginClosing(const keyframes::Hypothesis& loop, bool is_linked) {
  beginClosing(Settling::What::kErrorsToo);
  closing_->ends = {loop.old_keyframe, loop.keyframe};
  closing_->edges = loop.edges;
  if (!is_linked) return;
  for (const auto& edge : closing_->edges) map_->link(edge.from, edge.to);
  closing_->edges.clear();
}

bool LoopCloser::continueClosing(bool may_move) {
  if (!closing_) return false;
  if (!closing_->is_found) {
    double work = workOfScan();
    closing_->is_found = closing_->work.advance(work);
  }
  if (!closing_->is_found || !may_move) return false;
  takeOver();
  return true;
}

bool LoopCloser::completeClosing() {
  if (!closing_) return false;
  double unlimited = std::numeric_limits<double>::infinity();
  if (!closing_->is_found) closing_->work.advance(unlimited);
  takeOver();
  return true;
}

bool LoopCloser::closeRest() {
  // A shorter way has one pass through each place.
  if (map_->path_m() < options_->map_path_m) return false;
  if (isClosing() || map_->graph().edges().size() == solved_edges_) return false;
  beginClosing(Settling::What::kPoses);
  return completeClosing();
}

void LoopCloser::takeOver() {
  const keyframes::Settled& found = closing_->settling->result();
  map_->settle(found);
  for (const auto& edge : closing_->edges) map_->link(edge.from, edge.to);
  if (closing_->ends.first != closing_->ends.second)
    map_->addClosure(closing_->ends.first, closing_->ends.second);
  map_->note(core::JournalEvent::kOptimised, found.chi2);
  thread_s_ += closing_->work.threadSeconds();
  closing_.reset();
  for (auto& place : hypotheses_) place.innovation = -1;
  ruled_out_.clear();
  searched_m_ = map_->path_m();
}

}  // namespace slam::loops

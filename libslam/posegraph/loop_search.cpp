#include "libslam/posegraph/loop_search.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "libslam/core/middle_value.h"
#include "libslam/core/numbers.h"
#include "libslam/posegraph/descent.h"
#include "libslam/posegraph/edge_error.h"
#include "libslam/posegraph/parts.h"

namespace slam::posegraph {
namespace {

/// While no loop is on, one that ties a part which nothing else ties keeps so much of its weight.
constexpr double kBridgeWeight = 1e-6;
/// Between rounds poses need not be found to more than so many standard deviations.
constexpr double kCoarse = 0.03;
constexpr int kCoarseIterations = 20;
/// Errors spread: next to a false loop, true ones look false too. Only those near the worst are switched off
/// at once.
constexpr double kNearWorst = 0.25;
/// Building: this share of the loops that fit is taken in a round, but at least so many, and all that the
/// graph is about as sure of as they are themselves.
constexpr double kShare = 0.25;
constexpr size_t kAtLeast = 20;
constexpr double kSure = 3;  // the trace of a 3 x 3 identity
/// Building: a loop that costs so many times switch_off_chi2 is not looked at again until the graph stands.
constexpr double kHopeless = 10;
/// Building is trusted when it leaves out no larger share of the loops.
constexpr double kFewOff = 0.1;
/// A median of fewer loops says little.
constexpr size_t kEnoughForMedian = 20;
/// Determinant of 1 - S W below which a loop alone holds its part of the graph: nothing contradicts it.
constexpr double kAlone = 1e-9;
constexpr int kMostRounds = 100;

}  // namespace

LoopSearch::LoopSearch(const PoseGraph& graph, const OptimizeOptions& options)
    : graph_(graph), options_(options) {
  Parts parts(graph);
  for (size_t i = 0; i < graph.edges().size(); ++i)
    if (graph.edges()[i].kind == EdgeKind::kLoop)
      loops_.push_back(i);
    else if (graph.edges()[i].on)
      parts.join(graph.edges()[i]);
  for (const size_t loop : loops_) is_bridge_.push_back(!parts.areConnected(graph.edges()[loop]));
  is_parked_.assign(loops_.size(), 0);
}

LoopChoice LoopSearch::improve() {
  LoopChoice choice;
  choice.poses = graph_.poses();
  for (const Edge& edge : graph_.edges()) choice.on.push_back(edge.on);
  for (size_t n = 0; n < loops_.size(); ++n) is_parked_[n] = !choice.on[loops_[n]] && !is_bridge_[n];
  improve(choice);
  return choice;
}

LoopChoice LoopSearch::build() {
  LoopChoice choice;
  choice.poses = graph_.poses();
  for (const Edge& edge : graph_.edges()) choice.on.push_back(edge.on && edge.kind != EdgeKind::kLoop);
  build(choice);
  improve(choice);
  size_t off = 0;
  for (const size_t loop : loops_) off += choice.on[loop] == 0;
  if (static_cast<double>(off) <= kFewOff * static_cast<double>(loops_.size())) return choice;
  // Where false loops came first, right ones were refused; from all of them at once the end may be better.
  LoopChoice other;
  other.poses = graph_.poses();
  for (const Edge& edge : graph_.edges()) other.on.push_back(edge.on || edge.kind == EdgeKind::kLoop);
  is_parked_.assign(loops_.size(), 0);
  improve(other);
  return cost(other) < cost(choice) ? other : choice;
}

void LoopSearch::improve(LoopChoice& choice) {
  const std::vector<core::Pose2> start = choice.poses;
  settleFinely(choice);
  LoopChoice best = choice;
  bool is_settled = true;
  for (int round = 0; round < kMostRounds; ++round) {
    const auto verdicts = judge(choice, true);
    const double most = limit(choice, verdicts), worst = worstThatIsOn(choice, verdicts);
    const std::vector<char> before = choice.on;
    for (size_t n = 0; n < loops_.size(); ++n) {
      char& is_on = choice.on[loops_[n]];
      const bool fits = verdicts[n].chi2 <= most;
      if (is_on ? !fits && verdicts[n].chi2 >= kNearWorst * worst : fits && kNearWorst * worst <= most) {
        is_on = !is_on;
        is_parked_[n] = !is_on && !is_bridge_[n];
      }
    }
    keepTogether(choice, verdicts);
    if (choice.on == before) break;
    choice.poses = start;  // false loops may have folded the graph past the way back
    settleCoarsely(choice);
    is_settled = false;
    if (cost(choice) < cost(best)) best = choice;
  }
  choice = std::move(best);
  if (!is_settled) settleFinely(choice);
}

void LoopSearch::build(LoopChoice& choice) {
  settleCoarsely(choice);
  for (int round = 0; round < kMostRounds; ++round) {
    const auto verdicts = judge(choice, false);
    const double most = limit(choice, verdicts), worst = worstThatIsOn(choice, verdicts);
    const double loosest = loosestToTake(choice, verdicts, most);
    bool changed = false;
    for (size_t n = 0; n < loops_.size(); ++n) {
      char& is_on = choice.on[loops_[n]];
      const bool fits = verdicts[n].chi2 <= most;
      if (is_on ? !fits && verdicts[n].chi2 >= kNearWorst * worst
                : fits && verdicts[n].looseness <= loosest) {
        is_on = !is_on;
        changed = true;
      } else if (!is_on && !is_bridge_[n] && verdicts[n].chi2 > kHopeless * options_.switch_off_chi2) {
        is_parked_[n] = 1;
      }
    }
    if (!changed) break;
    settleCoarsely(choice);
  }
  for (size_t n = 0; n < loops_.size(); ++n) is_parked_[n] = !choice.on[loops_[n]] && !is_bridge_[n];
  keepTogether(choice, judge(choice, true));
}

void LoopSearch::settleFinely(LoopChoice& choice) {
  settle(choice, options_.tolerance, options_.max_iterations);
}

void LoopSearch::settleCoarsely(LoopChoice& choice) {
  settle(choice, std::max(kCoarse, options_.tolerance), std::min(kCoarseIterations, options_.max_iterations));
}

void LoopSearch::settle(LoopChoice& choice, double tolerance, int max_iterations) {
  std::vector<char> used = choice.on;
  weights_.assign(choice.on.begin(), choice.on.end());
  for (size_t n = 0; n < loops_.size(); ++n) {
    if (!is_parked_[n]) used[loops_[n]] = 1;
    if (is_bridge_[n] && !choice.on[loops_[n]]) weights_[loops_[n]] = kBridgeWeight;
  }
  system_.emplace(graph_, used);
  Descent descent(graph_, *system_, std::move(choice.poses), weights_, tolerance, max_iterations);
  descent.finish();
  iterations_ += descent.iterations();
  choice.poses = descent.poses();
  choice.chi2 = descent.chi2();
  choice.converged = descent.converged();
}

std::vector<LoopSearch::Verdict> LoopSearch::judge(const LoopChoice& choice, bool with_parked) {
  using core::kInfinity;
  std::vector<Verdict> out(loops_.size(), {kInfinity, kInfinity});
  system_->linearise(graph_, choice.poses, weights_);
  ++iterations_;
  if (!system_->factorize()) return out;
  const auto covariances = system_->errorCovariances(graph_, choice.poses);
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  for (size_t n = 0; n < loops_.size(); ++n) {
    if (is_parked_[n] && !with_parked) continue;
    const Edge& edge = graph_.edges()[loops_[n]];
    const bool is_on = choice.on[loops_[n]] != 0;
    const Eigen::Matrix3d S =
        is_parked_[n] ? system_->errorCovariance(edge, choice.poses) : covariances[loops_[n]];
    const Eigen::Matrix3d SW = S * edge.information;
    const Eigen::Matrix3d ratio = is_on ? Eigen::Matrix3d(one - SW) : Eigen::Matrix3d(one + SW);
    const Eigen::Vector3d e = edgeError(edge, choice.poses);
    // (W^-1 -+ S)^-1 = W (1 -+ S W)^-1, which also serves where W has no inverse.
    const bool is_alone = is_on && ratio.determinant() < kAlone;
    out[n].chi2 = is_alone ? 0 : e.dot(edge.information * (ratio.inverse() * e));
    out[n].looseness = is_on ? 0 : SW.trace();
  }
  return out;
}

double LoopSearch::limit(const LoopChoice& choice, const std::vector<Verdict>& verdicts) const {
  std::vector<double> sizes;
  for (size_t n = 0; n < loops_.size(); ++n)
    if (choice.on[loops_[n]]) sizes.push_back(verdicts[n].chi2);
  if (options_.switch_off_medians == 0 || sizes.size() < kEnoughForMedian) return options_.switch_off_chi2;
  return std::min(options_.switch_off_chi2,
                  options_.switch_off_medians * core::middleValue(std::move(sizes)));
}

double LoopSearch::worstThatIsOn(const LoopChoice& choice, const std::vector<Verdict>& verdicts) const {
  double worst = 0;
  for (size_t n = 0; n < loops_.size(); ++n)
    if (choice.on[loops_[n]]) worst = std::max(worst, verdicts[n].chi2);
  return worst;
}

double LoopSearch::loosestToTake(const LoopChoice& choice, const std::vector<Verdict>& verdicts,
                                 double most) const {
  std::vector<double> looseness;
  for (size_t n = 0; n < loops_.size(); ++n)
    if (!choice.on[loops_[n]] && verdicts[n].chi2 <= most) looseness.push_back(verdicts[n].looseness);
  if (looseness.empty()) return kSure;
  const auto share = static_cast<size_t>(kShare * static_cast<double>(looseness.size()));
  const size_t last = std::min(looseness.size() - 1, std::max(share, kAtLeast));
  return std::max(kSure, core::valueOfRank(looseness, last));
}

/// Switches on again what else would leave a part without a tie: of several the cheapest.
void LoopSearch::keepTogether(LoopChoice& choice, const std::vector<Verdict>& verdicts) const {
  std::vector<size_t> bridges;
  Parts parts(graph_);
  for (size_t i = 0; i < choice.on.size(); ++i)
    if (choice.on[i]) parts.join(graph_.edges()[i]);
  for (size_t n = 0; n < loops_.size(); ++n)
    if (is_bridge_[n] && !choice.on[loops_[n]]) bridges.push_back(n);
  std::stable_sort(bridges.begin(), bridges.end(),
                   [&](size_t a, size_t b) { return verdicts[a].chi2 < verdicts[b].chi2; });
  for (const size_t n : bridges) {
    const Edge& edge = graph_.edges()[loops_[n]];
    if (parts.areConnected(edge)) continue;
    parts.join(edge);
    choice.on[loops_[n]] = 1;
  }
}

/// What the best choice has the least of: truncated least squares.
double LoopSearch::cost(const LoopChoice& choice) const {
  double sum = choice.chi2;
  for (const size_t loop : loops_)
    if (!choice.on[loop]) sum += options_.switch_off_chi2;
  return sum;
}

}  // namespace slam::posegraph

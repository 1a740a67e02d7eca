#include "libslam/posegraph/descent.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace slam::posegraph {
namespace {

// Damping, relative to the diagonal: none while steps go down.
constexpr double kFirstDamping = 1e-4, kDampingUp = 10, kDampingDown = 0.1, kLeastDamping = 1e-7,
                 kMostDamping = 1e8;
/// Of a step that would go up, the least share that is tried before it is damped. Damping holds the long
/// waves of a graph back more than its short ones, and steps go up along the short ones.
constexpr double kLeastShare = 0.1;
/// chi2 may rise by so much of itself through rounding.
constexpr double kRounding = 1e-12;

}  // namespace

Descent::Descent(const PoseGraph& graph, GraphSystem& system, std::vector<core::Pose2> poses,
                 std::vector<double> weights, double tolerance, int max_iterations)
    : graph_(graph),
      system_(system),
      poses_(std::move(poses)),
      weights_(std::move(weights)),
      tolerance_(tolerance),
      max_iterations_(max_iterations) {
  linearise(Doing::kStart);
}

std::vector<core::Pose2> Descent::moved(double share) const {
  std::vector<core::Pose2> out = poses_;
  for (int node = 0; node < graph_.nodeCount(); ++node) {
    const int variable = system_.variableOf(node);
    if (variable < 0) continue;
    const Eigen::Vector3d d = share * step_[static_cast<size_t>(variable)];
    core::Pose2& pose = out[static_cast<size_t>(node)];
    pose = {pose.x + d[0], pose.y + d[1], core::wrapToPi(pose.phi + d[2])};
  }
  return out;
}

void Descent::linearise(Doing doing) {
  doing_ = doing;
  system_.beginLinearise();
}

void Descent::iterate() {
  if (iterations_ >= max_iterations_ || converged_ || !(damping_ < kMostDamping)) {
    doing_ = Doing::kNothing;
    return;
  }
  ++iterations_;
  system_.beginFactorization(damping_);
  doing_ = Doing::kFactorise;
}

void Descent::raiseDamping() {
  damping_ = std::max(kFirstDamping, kDampingUp * damping_);
}

/// With the factor.
void Descent::takeStep() {
  double predicted = 0;
  system_.solve(step_, predicted);
  // The undamped step's fall of chi2 is its length in standard deviations, squared, and bounds that of every
  // pose.
  is_last_ = damping_ == 0 && predicted <= tolerance_ * tolerance_;
  share_ = 1;
  next_ = moved(share_);
  linearise(Doing::kTry);
}

/// With the equations at next_.
void Descent::judgeStep() {
  const double next_chi2 = system_.weightedChi2();
  if (!is_last_ && next_chi2 > chi2_ && share_ / 2 >= kLeastShare) {
    share_ /= 2;
    next_ = moved(share_);
    linearise(Doing::kTry);
    return;
  }
  if (next_chi2 <= chi2_ * (1 + kRounding)) {
    poses_.swap(next_);
    chi2_ = next_chi2;
    converged_ = is_last_;
    damping_ = damping_ <= kLeastDamping ? 0 : kDampingDown * damping_;
  } else if (is_last_) {
    converged_ = true;  // what is left to gain is below rounding
  } else {
    raiseDamping();
    linearise(Doing::kBack);
    return;
  }
  iterate();
}

bool Descent::advance(double& work) {
  while (work > 0 && doing_ != Doing::kNothing) {
    if (doing_ == Doing::kFactorise) {
      const auto progress = system_.advanceFactorization(work);
      if (progress == sparse::BlockCholesky::Progress::kDone) doing_ = Doing::kSolve;
      if (progress == sparse::BlockCholesky::Progress::kFailed) raiseDamping(), iterate();
      continue;
    }
    if (doing_ == Doing::kSolve) {
      if (!solving_.isPaid(system_.workOfSolving(), work)) return false;
      takeStep();
      continue;
    }
    const bool tries = doing_ == Doing::kTry;
    if (!system_.lineariseMore(graph_, tries ? next_ : poses_, weights_, work)) continue;
    if (doing_ == Doing::kStart) first_chi2_ = chi2_ = system_.weightedChi2();
    if (tries)
      judgeStep();
    else
      iterate();
  }
  return doing_ == Doing::kNothing;
}

void Descent::finish() {
  double unlimited = std::numeric_limits<double>::infinity();
  advance(unlimited);
}

}  // namespace slam::posegraph

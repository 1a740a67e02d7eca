#include "libslam/keyframes/settling.h"

#include "libslam/keyframes/matching.h"
#include "libslam/posegraph/marginals.h"
#include "libslam/scanmatch/information.h"

namespace slam::keyframes {
namespace {

/// To find out how sure the ways are takes as long as so many multiplications for each keyframe, and how sure
/// each pose is as long again; to take over what was found, so many.
constexpr double kWorkPerWay = 7000, kWorkPerTaken = 1000;

}  // namespace

Settling::Settling(const KeyframeMap& map, const posegraph::OptimizeOptions& options)
    : poses_(std::in_place, map.graph(), options), witnesses_(map.witnesses()) {
  noise_.reserve(map.keyframes().size());
  for (const auto& one : map.keyframes()) noise_.push_back(one.noise);
}

bool Settling::advance(double& work) {
  const double count = static_cast<double>(noise_.size());
  if (stage_ == Stage::kPoses) {
    if (!poses_->advance(work)) return false;
    result_.chi2 = poses_->finish().final_chi2;
    result_.poses = poses_->poses();
    stage_ = Stage::kWays;
  }
  if (stage_ == Stage::kWays) {
    if (!dear_.isPaid(kWorkPerWay * count, work)) return false;
    const posegraph::PoseGraph graph = witnessGraph(poses_->graph(), result_.poses, witnesses_);
    poses_.reset();
    result_.ways = std::make_shared<const posegraph::Marginals>(graph, posegraph::Marginals::Open::kBounded);
    stage_ = Stage::kCovariances;
  }
  if (stage_ == Stage::kCovariances) {
    if (!dear_.isPaid(kWorkPerWay * count, work)) return false;
    result_.covariances = covariancesOf(*result_.ways);
    result_.roots.reserve(noise_.size());
    for (size_t k = 0; k < noise_.size(); ++k)
      result_.roots.push_back(scanmatch::rootOf(result_.covariances[k] + noise_[k]));
    work -= kWorkPerTaken * count;
    stage_ = Stage::kTaken;
  }
  return true;
}

}  // namespace slam::keyframes

#include "libslam/loops/settling.h"

namespace slam::loops {
namespace {

/// To find out how errors hang together takes as long as so many multiplications for each keyframe, to draw
/// them a piece so many; to take over what was found, so many.
constexpr double kWorkPerFlow = 20000, kWorkPerDraw = 5000, kWorkPerTaken = 1000;

}  // namespace

Settling::Settling(const keyframes::KeyframeMap& map, const posegraph::OptimizeOptions& options, What what)
    : poses_(std::in_place, map.graph(), options) {
  if (what == What::kErrorsToo) sources_.emplace(map);
}

bool Settling::advance(double& work) {
  if (stage_ == Stage::kPoses) {
    if (!poses_->advance(work)) return false;
    result_.chi2 = poses_->finish().final_chi2;
    result_.poses = poses_->poses();
    poses_.reset();
    stage_ = sources_ ? Stage::kErrors : Stage::kTaken;
    if (!sources_) work -= kWorkPerTaken * static_cast<double>(result_.poses.size());
  }
  if (stage_ == Stage::kErrors) {
    if (!dear_.isPaid(kWorkPerFlow * static_cast<double>(result_.poses.size()), work)) return false;
    flow_ = std::make_unique<const uncertainty::ErrorFlow>(
        *sources_, result_.poses, uncertainty::Poses::kTracked, uncertainty::ViewNoise::kApart);
    sources_.reset();
    stage_ = Stage::kDraws;
  }
  return stage_ == Stage::kTaken || draw(work);
}

bool Settling::draw(double& work) {
  const size_t count = result_.poses.size();
  if (result_.errors.empty()) {
    result_.errors.resize(count);
    for (size_t k = 1; k < count; ++k) result_.errors[k].addNew(Eigen::Matrix3d::Identity(), k);
  }
  for (; drawn_ < uncertainty::ErrorFlow::kPieces; ++drawn_) {
    if (!dear_.isPaid(kWorkPerDraw * static_cast<double>(count), work)) return false;
    flow_->draw(result_.errors, drawn_);
  }
  flow_.reset();
  work -= kWorkPerTaken * static_cast<double>(count);
  stage_ = Stage::kTaken;
  return true;
}

}  // namespace slam::loops

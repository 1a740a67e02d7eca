#include "libslam/wheels/path_scale.h"

#include <algorithm>

#include "libslam/core/elementary.h"

namespace slam::wheels {
namespace {

/// Wheels measure within this share of the true way, for a start; more than the second is no matter of scale.
constexpr double kSigma = 0.03, kMost = 0.15;
constexpr double kPiece_m = 0.5, kMostPiece_m = 5;
/// At both ends of a piece so much of the pose is odometry's word at most: of steps of a tenth of a metre
/// scans tell four tenths, or more. A longer step has to be told by its own scan: where scans are few, what
/// one says after many untold metres may be wrong.
constexpr double kOpen_m = 0.15;
/// Wheels that stand, or jitter, say nothing of any direction.
constexpr double kStands_m = 1e-3;

}  // namespace

core::Pose2 PathScale::corrected(const core::Pose2& T_wheels) const {
  return {factor_ * T_wheels.x, factor_ * T_wheels.y, T_wheels.phi};
}

void PathScale::endPiece() {
  beginPiece();
  open_m_ = kPiece_m;
}

void PathScale::beginPiece() {
  T_wheels_ = T_matched_ = {};
  driven_m_ = 0;
}

void PathScale::learn(const core::Pose2& T_corrected, const core::Pose2& T_matched, double told) {
  const double step_m = core::hypot(T_corrected.x, T_corrected.y);
  if (!(step_m < kMostStep_m)) return endPiece();
  const bool tells_alone = told_ == Told::kByEach || step_m > kOpen_m;
  if (tells_alone && !(told >= kTold)) return endPiece();
  const bool was_told = tells_alone || open_m_ <= kOpen_m;
  if (tells_alone)
    open_m_ = 0;
  else if (step_m > kStands_m)
    open_m_ = (open_m_ + step_m) * (told > 0 ? 1 - std::min(told, 1.0) : 1);
  if (driven_m_ == 0 && !was_told) return;
  driven_m_ += step_m;
  T_wheels_ = T_wheels_ * core::Pose2{T_corrected.x / factor_, T_corrected.y / factor_, T_corrected.phi};
  T_matched_ = T_matched_ * T_matched;
  const double way_m = core::hypot(T_wheels_.x, T_wheels_.y);
  if (way_m < kPiece_m || open_m_ > kOpen_m) {
    if (driven_m_ > kMostPiece_m) beginPiece();
    return;
  }
  const double excess_m = core::hypot(T_matched_.x, T_matched_.y) - way_m;
  const double off_m = excess_m - (factor_ - 1) * way_m, off2 = off_m * off_m / way_m;
  const double variance = scatter_.variance(), stays = core::exp(-way_m / kMemory);
  const double weight = scatter_.add(off2, stays);
  way_m_ = stays * way_m_ + weight * way_m;
  excess_m_ = stays * excess_m_ + weight * excess_m;
  factor_ = 1 + std::clamp(excess_m_ / (way_m_ + variance / (kSigma * kSigma)), -kMost, kMost);
  beginPiece();
}

}  // namespace slam::wheels

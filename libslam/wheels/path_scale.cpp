#include "libslam/wheels/path_scale.h"

#include <algorithm>

#include "libslam/core/elementary.h"

namespace slam::wheels {
namespace {

/// Wheels measure within this share of the true way, for a start; more than the second is no matter of scale.
constexpr double kSigma = 0.03, kMost = 0.15;
constexpr double kPiece_m = 0.5;

}  // namespace

core::Pose2 PathScale::corrected(const core::Pose2& T_wheels) const {
  return {factor_ * T_wheels.x, factor_ * T_wheels.y, T_wheels.phi};
}

void PathScale::endPiece() {
  T_wheels_ = T_matched_ = {};
}

void PathScale::learn(const core::Pose2& T_corrected, const core::Pose2& T_matched, double told) {
  const double step_m = core::hypot(T_corrected.x, T_corrected.y);
  if (!(told >= kTold) || !(step_m < kMostStep_m)) return endPiece();
  T_wheels_ = T_wheels_ * core::Pose2{T_corrected.x / factor_, T_corrected.y / factor_, T_corrected.phi};
  T_matched_ = T_matched_ * T_matched;
  const double way_m = core::hypot(T_wheels_.x, T_wheels_.y);
  if (way_m < kPiece_m) return;
  const double excess_m = core::hypot(T_matched_.x, T_matched_.y) - way_m;
  const double off_m = excess_m - (factor_ - 1) * way_m, off2 = off_m * off_m / way_m;
  const double variance = scatter_.variance(), stays = core::exp(-way_m / kMemory);
  const double weight = scatter_.add(off2, stays);
  way_m_ = stays * way_m_ + weight * way_m;
  excess_m_ = stays * excess_m_ + weight * excess_m;
  factor_ = 1 + std::clamp(excess_m_ / (way_m_ + variance / (kSigma * kSigma)), -kMost, kMost);
  endPiece();
}

}  // namespace slam::wheels

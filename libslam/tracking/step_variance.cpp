#include "libslam/tracking/step_variance.h"

#include <algorithm>
#include <cmath>

namespace slam::tracking {
namespace {

/// A match counts where it took away so much of a step's error.
constexpr double kTaken = 0.5;
/// A step that errs by more, in variances assumed, is an event of its own, such as a slip.
constexpr double kMost = 9;
constexpr double kLeastShare = 1e-3, kMostShare = 4;

}  // namespace

double StepVariance::Component::share() const {
  return std::clamp(sum / count, kLeastShare, kMostShare);
}

void StepVariance::add(const Eigen::Vector3d& moved, const Eigen::Matrix3d& gain,
                       const Eigen::Matrix3d& assumed, const Eigen::Matrix3d& noise,
                       const Eigen::Matrix3d& noise_before) {
  const Eigen::Matrix3d of_scans = gain * noise_before * gain.transpose() + noise,
                        of_step = gain * assumed * gain.transpose();
  const auto count = [](Component& component, double taken, double squared, double scans, double step) {
    if (!(taken > kTaken && step > 0)) return;
    component.sum += std::min(squared / step, kMost) - scans / step;
    component.count += 1;
  };
  count(way_, (gain(0, 0) + gain(1, 1)) / 2, moved.head<2>().squaredNorm(), of_scans(0, 0) + of_scans(1, 1),
        of_step(0, 0) + of_step(1, 1));
  count(turn_, gain(2, 2), moved.z() * moved.z(), of_scans(2, 2), of_step(2, 2));
}

Eigen::Matrix3d StepVariance::of(const Eigen::Matrix3d& assumed) const {
  const double way = std::sqrt(way_.share()), turn = std::sqrt(turn_.share());
  const Eigen::Matrix3d shares = Eigen::Vector3d(way, way, turn).asDiagonal();
  return shares * assumed * shares;
}

}  // namespace slam::tracking

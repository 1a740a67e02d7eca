#include "libslam/odometry/mrpt_action.h"

#include <mrpt/core/Clock.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/poses/CPosePDFGaussian.h>

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"

namespace slam::odometry {
namespace {

using MotionModel = mrpt::obs::CActionRobotMovement2D::TMotionModelOptions;

/// MRPT's Gaussian model spreads a summed increment by min_std + a1 * distance + a2 * |turn| (and likewise
/// for the heading), so spreads of single steps would add up linearly where independent errors add up as the
/// square root of their number n. A third of the spread per step keeps the sum within a factor of two of
/// sqrt(n) up to n = 25 steps.
constexpr double kGrowth = 1.0 / 3;
/// Steps shorter than these are counted as these, so that a robot at rest gets no infinite ratio.
constexpr double kShortestMove_m = 0.05, kSmallestTurn_rad = 0.05;

MotionModel motionModel(const ScanMotion& motion) {
  const auto& c = motion.covariance;
  // The model has one spread for x and y: the larger half axis of the covariance's ellipse.
  const double mean = (c[0] + c[4]) / 2;
  const double std_xy = std::sqrt(mean + core::hypot((c[0] - c[4]) / 2, c[1]));
  const double std_phi = std::sqrt(c[8]);
  const auto& step = motion.T_previous_current;
  const double move = std::max(core::hypot(step.x, step.y), kShortestMove_m);
  const double turn = std::max(std::abs(step.phi), kSmallestTurn_rad);
  MotionModel model;
  model.modelSelection = mrpt::obs::CActionRobotMovement2D::mmGaussian;
  // Used as they are by computeFromOdometry: metres and radians, whatever MRPT's comments say of degrees.
  model.gaussianModel = {kGrowth * std_xy / move,
                         kGrowth * std_xy / turn,
                         kGrowth * std_phi / move,
                         kGrowth * std_phi / turn,
                         std_xy,
                         std_phi};
  return model;
}

}  // namespace

std::shared_ptr<mrpt::obs::CActionRobotMovement2D> toMrptAction(const ScanMotion& motion, double time_s) {
  if (!core::isFinite(motion.T_previous_current) || !std::isfinite(time_s))
    throw core::ContractError("toMrptAction: the motion and its time must be finite");
  const auto& T = motion.T_previous_current;
  mrpt::math::CMatrixDouble33 covariance;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      const int k = 3 * row + column;
      covariance(row, column) = motion.covariance[static_cast<size_t>(k)];
    }
  auto action = std::make_shared<mrpt::obs::CActionRobotMovement2D>();
  action->timestamp = mrpt::Clock::fromDouble(time_s);
  action->estimationMethod = mrpt::obs::CActionRobotMovement2D::emScan2DMatching;
  action->poseChange =
      mrpt::poses::CPosePDFGaussian::Create(mrpt::poses::CPose2D(T.x, T.y, T.phi), covariance);
  action->motionModelConfiguration = motionModel(motion);
  return action;
}

std::shared_ptr<mrpt::obs::CActionCollection> toMrptActions(const ScanMotion& motion, double time_s) {
  const auto matched = toMrptAction(motion, time_s);
  const auto& T = motion.T_previous_current;
  mrpt::obs::CActionRobotMovement2D spread;
  spread.timestamp = matched->timestamp;
  spread.computeFromOdometry(mrpt::poses::CPose2D(T.x, T.y, T.phi), matched->motionModelConfiguration);
  auto actions = std::make_shared<mrpt::obs::CActionCollection>();
  actions->insert(spread);
  actions->insert(*matched);
  return actions;
}

}  // namespace slam::odometry

// Drives as no robot would make them, through what estimates from scans: it ends, and what it says is finite.
#include <cstdlib>

#include "libslam/graph/graph_slam.h"
#include "libslam/odometry/scan_odometry.h"
#include "libslam/particles/particle_filter.h"
#include "tests/fuzz/scan_script.h"
#include "tests/mapping/is_covariance.h"

namespace slam {
namespace {

using mapping::test::isCovariance;

constexpr int kMostSteps = 60;  // run.sh knows how many bytes these are

void require(bool holds) {
  if (!holds) std::abort();
}

void requireSound(const graph::GraphSlam::Step& step) {
  require(core::isFinite(step.T_map_robot) && isCovariance(step.pose_covariance) &&
          isCovariance(step.drift_covariance) && step.score >= 0 && step.score <= 1);
}

/// Mapped, and, from some step on, localised in what was mapped.
void driveGraph(fuzz::ScanScript script, int mapped) {
  keyframes::GraphOptions options;
  options.refine_rounds = mapped % 2;
  graph::GraphSlam graph(options);
  for (int i = 0; i < kMostSteps; ++i) {
    const auto step = script.step();
    if (!step) break;
    if (i > 0 && i == mapped) graph.finish();
    requireSound(i > 0 && i >= mapped
                     ? graph.localise(step->scan, step->T_previous_robot, step->has_odometry)
                     : graph.process(step->scan, step->T_previous_robot, step->has_odometry));
  }
  graph.finish();
  for (const auto& pose : graph.poses()) require(core::isFinite(pose));
  for (const auto& covariance : graph.covariances()) require(isCovariance(covariance));
}

void driveParticles(fuzz::ScanScript script) {
  particles::ParticleFilterOptions options;
  options.count = 3, options.lost_scans = 5;
  particles::ParticleFilter filter(options, 1);
  for (int i = 0; i < kMostSteps; ++i) {
    const auto step = script.step();
    if (!step) break;
    std::optional<particles::Motion> motion;
    if (step->has_odometry)
      motion = particles::Motion{step->T_previous_robot, 1e-3 * Eigen::Matrix3d::Identity()};
    const auto& update = filter.update(step->scan, motion);
    require(core::isFinite(update.T_map_robot) && isCovariance(update.covariance));
  }
}

void driveScanOdometry(fuzz::ScanScript script, const std::string& name) {
  odometry::ScanOdometryOptions options;
  options.method = name;
  const auto scan_odometry = makeScanOdometry(options);
  for (int i = 0; i < kMostSteps; ++i) {
    const auto step = script.step();
    if (!step) break;
    require(core::isFinite(scan_odometry->update(step->scan).T_previous_current));
  }
}

}  // namespace
}  // namespace slam

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const auto names = slam::odometry::scanOdometryNames();
  const auto which = static_cast<std::size_t>(data[0]) % (names.size() + 3);
  // A particle's map has a directory of its area; who makes one of a log limits that before.
  const slam::fuzz::ScanScript script(data + 2, size - 2, which == names.size() ? 0.5 : 1e3);
  if (which < names.size())
    slam::driveScanOdometry(script, names[which]);
  else if (which == names.size())
    slam::driveParticles(script);
  else
    slam::driveGraph(script, data[1] % 80);
  return 0;
}

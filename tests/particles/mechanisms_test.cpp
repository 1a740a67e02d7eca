// What holds the particle filter together, each in a small drawn case that fails without it.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "libslam/particles/particle_filter.h"
#include "tests/graph/drawn_drives.h"

namespace slam::particles {
namespace {

using namespace graph::test_drives;

// In one dimension of three the integral can be done by hand: a likelihood exp(-l (x - a)^2 / 2) times a
// motion model exp(-p (x - b)^2 / 2) integrates to exp(-(a - b)^2 l p / (2 (l + p))) sqrt(2 pi / (l + p)).
TEST(ParticleMechanisms, TheEvidenceIsTheIntegralOfLikelihoodTimesMotionModel) {
  const auto evidence = [](double l, double p, double apart) {
    const double peak = apart * p / (l + p);
    scanmatch::FieldMatch match;
    match.cost = 0.5 * l * peak * peak;
    match.prior_cost = 0.5 * p * (apart - peak) * (apart - peak);
    return logEvidence(match, Eigen::Vector3d(l + p, 1, 1).asDiagonal());
  };
  const auto integral = [](double l, double p, double apart) {
    double sum = 0;
    for (double x = -20; x < 20; x += 1e-3)
      sum += 1e-3 * std::exp(-0.5 * (l * x * x + p * (x - apart) * (x - apart)));
    return std::log(sum);
  };
  const double reference = evidence(1, 1, 0) - integral(1, 1, 0);
  for (const double l : {0.5, 4.0})
    for (const double p : {0.3, 2.0})
      for (const double apart : {0.0, 1.0, 3.0})
        EXPECT_NEAR(evidence(l, p, apart) - integral(l, p, apart), reference, 1e-6)
            << l << " " << p << " " << apart;
}

Drive roomDrive(int scans, std::uint64_t seed) {
  std::vector<core::Pose2> path;
  path.reserve(static_cast<size_t>(scans));
  for (int i = 0; i < scans; ++i) path.push_back({1 + 0.1 * i, 1, 0});
  return drive(ring(), path, {}, 0, seed);
}

Motion motionOf(const core::Pose2& wheels) {
  const double xy = 0.02 + 0.1 * std::abs(wheels.x), turn = 0.02 + 0.2 * std::abs(wheels.phi);
  return {wheels, Eigen::Vector3d(xy * xy, xy * xy, turn * turn).asDiagonal()};
}

// What a particle moves by against another one from scan to scan is drawn anew each time.
TEST(ParticleMechanisms, EveryScanDrawsAnew) {
  ParticleFilterOptions options;
  options.count = 8, options.resample_below = 0, options.insert_distance_m = 0, options.proposal_scale = 1;
  ParticleFilter filter(options, 1);
  const auto log = roomDrive(60, 1);
  std::vector<std::vector<double>> apart;  // by scan, of every particle from the first
  for (size_t i = 0; i < log.scans.size(); ++i) {
    filter.update(log.scans[i], motionOf(log.increments[i]));
    const auto poses = filter.poses();
    apart.emplace_back();
    for (const auto& pose : poses) apart.back().push_back(pose.y - poses[0].y);
  }
  double same = 0, squares = 0;
  for (size_t i = 2; i < apart.size(); ++i)
    for (size_t p = 1; p < apart[i].size(); ++p) {
      const double before = apart[i - 1][p] - apart[i - 2][p], now = apart[i][p] - apart[i - 1][p];
      same += before * now, squares += now * now;
    }
  ASSERT_GT(squares, 0);
  RecordProperty("correlation", std::to_string(same / squares));
  EXPECT_LT(same / squares, 0.2);
}

// After resampling all particles count alike: what they have earned before is spent on their number.
TEST(ParticleMechanisms, ResamplingSpendsTheWeights) {
  int resampled = 0, again = 0;
  double share_after = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    ParticleFilterOptions options;
    options.count = 30, options.insert_distance_m = 0;
    ParticleFilter filter(options, seed);
    const auto log = roomDrive(120, seed);
    bool was_resampled = false;
    for (size_t i = 0; i < log.scans.size(); ++i) {
      const auto& step = filter.update(log.scans[i], motionOf(log.increments[i]));
      if (!step.inserted) continue;
      if (was_resampled) ++resampled, again += step.resampled, share_after += step.effective_share;
      was_resampled = step.resampled;
    }
  }
  ASSERT_GT(resampled, 10);
  RecordProperty("again", std::to_string(again) + " of " + std::to_string(resampled) + " share " +
                              std::to_string(share_after / resampled));
  EXPECT_GT(share_after / resampled, 0.82);
}

}  // namespace
}  // namespace slam::particles

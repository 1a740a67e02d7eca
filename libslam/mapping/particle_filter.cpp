#include "libslam/mapping/particle_filter.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "libslam/core/error.h"
#include "libslam/core/random.h"

namespace slam::mapping {

using scanmatch::FieldMatch;
using scanmatch::FieldPrior;
using scanmatch::SurfacePoint;

ParticleFilter::ParticleFilter(const ParticleFilterOptions& options, std::uint64_t seed)
    : options_(options), seed_(seed), team_(options.threads) {
  particles_.reserve(static_cast<size_t>(options.particles));
  for (int i = 0; i < options.particles; ++i) particles_.push_back({gridmap::Grid(options.grid), {}, PathTree::kNone, 0, 0, {}, {}});
}

void ParticleFilter::matchAll(const std::vector<SurfacePoint>& points, const core::Pose2& increment, bool has_odometry) {
  Particle& guide = particles_[best_];
  const core::Pose2 T_before = guide.T_map_robot, predicted = T_before * increment;
  core::Pose2 start = predicted;
  const double start_kernel_m = options_.wide_kernel_m;
  const double odometry_score = scanmatch::fieldScore(points, guide.grid, predicted, start_kernel_m, 3);
  double start_score = odometry_score + 0.02;
  std::vector<core::Pose2> others = {T_before * velocity_, T_before * core::inverse(increment)};
  for (const double turn_rad : {-0.15, -0.07, 0.07, 0.15})
    others.push_back({predicted.x, predicted.y, predicted.phi + turn_rad});
  for (const core::Pose2& other : others) {
    const double score = scanmatch::fieldScore(points, guide.grid, other, start_kernel_m, 3);
    if (score > start_score) start_score = score, start = other;
  }
  step_.odometry_distrusted = start_score > odometry_score + options_.distrust_score;
  double sigma_xy_m = options_.sigma_xy_m + options_.sigma_xy_per_m * std::hypot(increment.x, increment.y);
  double sigma_turn_rad = options_.sigma_turn_rad + options_.sigma_turn_per_rad * std::abs(increment.phi);
  core::Pose2 expected = increment;
  if (step_.odometry_distrusted) {
    expected = core::between(T_before, start);
    sigma_xy_m = 3 * sigma_xy_m + 0.1, sigma_turn_rad = 3 * sigma_turn_rad + 0.05;
  }
  if (!has_odometry) sigma_xy_m += 0.5, sigma_turn_rad += 0.5;
  FieldPrior prior;
  prior.information.diagonal() << 1 / (sigma_xy_m * sigma_xy_m), 1 / (sigma_xy_m * sigma_xy_m), 1 / (sigma_turn_rad * sigma_turn_rad);

  prior.mean = T_before * expected;
  scanmatch::FieldMatchOptions wide = options_.match;
  wide.kernel_m = start_kernel_m, wide.max_iterations = 4;
  const FieldMatch rough = scanmatch::alignToField(points, guide.grid, start, prior, wide);
  const FieldMatch guided = scanmatch::alignToField(points, guide.grid, rough.T_map_robot, prior, options_.match);
  const core::Pose2 moved = core::between(T_before, guided.T_map_robot);
  scanmatch::FieldMatchOptions refine = options_.match;
  refine.max_iterations = options_.refine_iterations;
  team_.forEach(particles_.size(), [&](size_t i) {
    Particle& particle = particles_[i];
    FieldPrior own = prior;
    own.mean = particle.T_map_robot * expected;
    if (i == best_)
      particle.match = guided;
    else
      particle.match = scanmatch::alignToField(points, particle.grid, particle.T_map_robot * moved, own, refine);
    particle.information = particle.match.information + prior.information;
    particle.T_map_robot = particle.match.T_map_robot;
  });
  velocity_ = moved;
}

void ParticleFilter::insertAll(const robot::Scan& scan) {
  const gridmap::ScanRays rays = gridmap::scanRays(scan, options_.rays);
  team_.forEach(particles_.size(), [&](size_t i) {
    Particle& particle = particles_[i];
    if (scans_ > 0) {
      core::RandomStream random(seed_, "particle " + std::to_string(i) + " scan " + std::to_string(scans_));
      const Eigen::Vector3d unit(random.normal(), random.normal(), random.normal());
      // L L' = information: L'^-1 u has the covariance information^-1.
      const Eigen::LLT<Eigen::Matrix3d> factor(particle.information);
      const Eigen::Vector3d drawn = factor.matrixU().solve(unit) * options_.proposal_scale;
      if (drawn.allFinite()) {
        core::Pose2& T = particle.T_map_robot;
        T = {T.x + drawn.x(), T.y + drawn.y(), core::wrapToPi(T.phi + drawn.z())};
      }
    }
    particle.grid.insert(rays, particle.T_map_robot);
  });
}

void ParticleFilter::weigh() {
  for (Particle& particle : particles_) {
    const double log_evidence = -particle.match.cost - particle.match.prior_cost -
                                0.5 * std::log(particle.information.determinant());
    particle.log_weight += options_.weight_scale * log_evidence;
    particle.total_log_weight += options_.weight_scale * log_evidence;
  }
}

void ParticleFilter::resample() {
  double most = particles_[0].log_weight;
  for (const Particle& particle : particles_) most = std::max(most, particle.log_weight);
  std::vector<double> weights;
  double sum = 0, squares = 0;
  for (const Particle& particle : particles_) {
    const double w = std::exp(particle.log_weight - most);
    weights.push_back(w), sum += w, squares += w * w;
  }
  const size_t count = particles_.size();
  step_.effective = sum * sum / squares / static_cast<double>(count);
  if (step_.effective >= options_.resample_below) return;
  step_.resampled = true;
  core::RandomStream random(seed_, "resampling scan " + std::to_string(scans_));
  const double pace = sum / static_cast<double>(count), start = random.uniform() * pace;
  std::vector<size_t> times(count, 0);
  double reached = 0;
  size_t drawn = 0;
  for (size_t i = 0; i < count; ++i) {
    reached += weights[i];
    while (drawn < count && start + static_cast<double>(drawn) * pace < reached) ++times[i], ++drawn;
  }
  for (size_t i = count; drawn < count && i-- > 0;)
    if (times[i]) times[i] += count - drawn, drawn = count;
  size_t to = 0;
  for (size_t i = 0; i < count; ++i)
    while (times[i] > 1) {
      while (times[to] > 0) ++to;
      paths_.release(particles_[to].leaf);
      particles_[to] = particles_[i];
      particles_[to].leaf = paths_.share(particles_[i].leaf);
      ++times[to], --times[i];
    }
  for (Particle& particle : particles_) particle.log_weight = 0;
}

void ParticleFilter::estimate() {
  best_ = 0;
  for (size_t i = 1; i < particles_.size(); ++i)
    if (particles_[i].total_log_weight > particles_[best_].total_log_weight) best_ = i;
  step_.T_map_robot = particles_[best_].T_map_robot;
}

const ParticleStep& ParticleFilter::update(const robot::Scan& scan, const std::optional<core::Pose2>& T_previous_robot) {
  step_ = {};
  const auto points = scanmatch::surfacePoints(scan, options_.points);
  if (scans_ > 0) matchAll(points, T_previous_robot.value_or(velocity_), T_previous_robot.has_value());
  const FieldMatch& match = particles_[best_].match;
  const core::Pose2& T = particles_[best_].T_map_robot;
  step_.score = scans_ > 0 ? match.score : 1;
  step_.degenerate = match.degenerate;
  step_.inserted = scans_ == 0 || core::distance(T, T_inserted_) > options_.insert_distance_m ||
                   std::abs(core::angleDifference(T.phi, T_inserted_.phi)) > options_.insert_angle_rad ||
                   step_.score < options_.insert_score;
  if (step_.inserted) {
    if (scans_ > 0) weigh();
    insertAll(scan);
  }
  for (Particle& particle : particles_)
    particle.leaf = paths_.extend(particle.leaf, {scan.time_s, particle.T_map_robot});
  if (step_.inserted) {
    if (scans_ > 0) resample();
    estimate();
    T_inserted_ = particles_[best_].T_map_robot;
  }
  step_.T_map_robot = particles_[best_].T_map_robot;
  ++scans_;
  return step_;
}

size_t ParticleFilter::bytes() const {
  std::vector<const void*> tiles;
  for (const Particle& particle : particles_) particle.grid.appendTiles(tiles);
  std::sort(tiles.begin(), tiles.end());
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
  return tiles.size() * gridmap::Grid::tileBytes() + paths_.size() * 40;
}

}  // namespace slam::mapping

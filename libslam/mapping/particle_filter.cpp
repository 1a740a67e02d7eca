#include "libslam/mapping/particle_filter.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "libslam/core/error.h"
#include "libslam/core/random.h"

namespace slam::mapping {

using scanmatch::FieldMatch;
using scanmatch::FieldMatchOptions;
using scanmatch::PosePrior;
using scanmatch::SurfacePoint;

namespace {

/// A start has to beat the odometry's by this before it is taken.
constexpr double kStartMargin = 0.02;
/// Every n-th point is enough to compare starts.
constexpr int kStartStride = 3;
constexpr std::uint64_t kCountEvery = 32;
constexpr int kWideIterations = 4, kGuideIterations = 8;
/// Spread of a motion that nobody measured (0.5 m, 0.5 rad), or that is distrusted.
constexpr double kUnknownSigma = 0.5;
constexpr double kDistrustFactor = 3, kDistrustSigma_m = 0.1, kDistrustSigma_rad = 0.05;

/// Of an increment's covariance, in the frame that its mean lives in.
Eigen::Matrix3d rotated(const Eigen::Matrix3d& matrix, double phi) {
  const double c = std::cos(phi), s = std::sin(phi);
  Eigen::Matrix3d R;
  R << c, -s, 0, s, c, 0, 0, 0, 1;
  return R * matrix * R.transpose();
}

core::Pose2 moved(const core::Pose2& T, const Eigen::Vector3d& by) {
  return {T.x + by.x(), T.y + by.y(), core::wrapToPi(T.phi + by.z())};
}

gridmap::GridOptions gridOptions(const ParticleFilterOptions& options) {
  gridmap::GridOptions grid;
  grid.cell_m = options.cell_m;
  grid.hit_probability = options.hit_probability;
  grid.pass_probability = options.pass_probability;
  // As far as a scan may be off and still find the wall.
  grid.reach_cells = std::clamp(static_cast<int>(std::lround(0.4 / options.cell_m)), 2, 16);
  return grid;
}

}  // namespace

ParticleFilterOptions::ParticleFilterOptions() {
  table().setDefaults(*this);
}

const core::ParameterTable<ParticleFilterOptions>& ParticleFilterOptions::table() {
  using O = ParticleFilterOptions;
  static const core::ParameterTable<O> kTable(
      "particles",
      {{"count", &O::count, 30, 1, 10000, "number of particles"},
       {"threads", &O::threads, 1, 1, 256, "changes the time alone, not the result"},
       {"cell_m", &O::cell_m, 0.1, 0.02, 0.5,
        "cells of the particles' maps; surfaces are kept finer than that"},
       {"point_spacing_m", &O::point_spacing_m, 0.05, 0.001, 1.0, "smallest distance between matched points"},
       {"sigma_m", &O::sigma_m, 0.03, 0.001, 1.0, "of a point from the surface that it lies on"},
       {"kernel_m", &O::kernel_m, 0.12, 0.005, 5.0,
        "a point this far from every surface counts for a quarter"},
       {"wide_kernel_m", &O::wide_kernel_m, 0.2, 0.01, 5.0, "the same while the start is chosen"},
       {"information_scale", &O::information_scale, 0.2, 0.001, 1.0,
        "how much of a point's information counts: neighbouring beams err together"},
       {"iterations", &O::iterations, 3, 1, 100, "of Gauss-Newton, from the best particle's motion"},
       {"proposal_scale", &O::proposal_scale, 0.5, 0.0, 10.0,
        "on the standard deviations that are drawn from"},
       {"evidence_scale", &O::evidence_scale, 1.0, 0.0, 1.0,
        "exponent on the weights: one scan's errors are the next one's too"},
       {"resample_below", &O::resample_below, 0.5, 0.0, 1.0, "effective share of particles that triggers it"},
       {"distrust_score", &O::distrust_score, 0.1, 0.0, 1.0,
        "odometry is distrusted where another start explains so much more of the scan"},
       {"insert_score", &O::insert_score, 0.6, 0.0, 1.0, "a scan of which the map explains less is inserted"},
       {"lost_score", &O::lost_score, 0.2, 0.0, 1.0, "below this the filter calls itself lost"},
       {"hit_probability", &O::hit_probability, 0.8, 0.51, 0.97, "occupied, where one scan has a return"},
       {"pass_probability", &O::pass_probability, 0.45, 0.12, 0.49, "occupied, where one scan saw through"}});
  return kTable;
}

ParticleFilter::ParticleFilter(const ParticleFilterOptions& options, std::uint64_t seed)
    : options_(options), seed_(seed), team_(options.threads) {
  point_options_.spacing_m = options.point_spacing_m;
  match_options_.sigma_m = options.sigma_m;
  match_options_.kernel_m = options.kernel_m;
  match_options_.information_scale = options.information_scale;
  match_options_.max_iterations = options.iterations;
  particles_.assign(static_cast<size_t>(options.count), Particle(gridOptions(options)));
}

void ParticleFilter::start(const core::Pose2& T_map_robot,
                           const std::vector<std::pair<gridmap::ScanRays, core::Pose2>>& known) {
  if (scans_ > 0) throw core::ContractError("ParticleFilter::start: scans were seen already");
  for (const auto& [rays, T_map_seen] : known) particles_[0].grid.insert(rays, T_map_seen);
  particles_[0].T_map_robot = T_map_robot;
  for (Particle& particle : particles_) particle = particles_[0];
  step_.T_map_robot = T_map_robot;
  map_is_known_ = !known.empty();
}

ParticleFilter::Guidance ParticleFilter::guide(const std::vector<SurfacePoint>& points,
                                               const std::optional<Motion>& motion) {
  const Particle& best = particles_[best_];
  const core::Pose2 T_before = best.T_map_robot;
  Guidance guidance;
  guidance.expected = motion ? motion->T_previous_robot : velocity_;
  Eigen::Matrix3d covariance =
      motion ? motion->covariance : kUnknownSigma * kUnknownSigma * Eigen::Matrix3d::Identity();

  const core::Pose2 predicted = T_before * guidance.expected;
  const auto score = [&](const core::Pose2& T) {
    return scanmatch::fieldScore(points, best.grid, T, options_.wide_kernel_m, kStartStride);
  };
  std::vector<core::Pose2> others = {T_before * velocity_, T_before * core::inverse(guidance.expected)};
  for (const double turn_rad : {-0.15, -0.07, 0.07, 0.15})
    others.push_back({predicted.x, predicted.y, predicted.phi + turn_rad});
  const double predicted_score = score(predicted);
  core::Pose2 start = predicted;
  double start_score = predicted_score + kStartMargin;
  for (const core::Pose2& other : others)
    if (const double other_score = score(other); other_score > start_score)
      start = other, start_score = other_score;
  if (motion && start_score > predicted_score + options_.distrust_score) {
    step_.odometry_distrusted = true;
    guidance.expected = core::between(T_before, start);
    covariance *= 2 * kDistrustFactor * kDistrustFactor;
    covariance.diagonal() +=
        2 * Eigen::Vector3d(kDistrustSigma_m * kDistrustSigma_m, kDistrustSigma_m * kDistrustSigma_m,
                            kDistrustSigma_rad * kDistrustSigma_rad);
  }
  guidance.information = covariance.inverse();

  const PosePrior prior{T_before * guidance.expected, rotated(guidance.information, T_before.phi)};
  FieldMatchOptions wide = match_options_, fine = match_options_;
  wide.kernel_m = options_.wide_kernel_m, wide.max_iterations = kWideIterations;
  fine.max_iterations = kGuideIterations;
  const FieldMatch rough = scanmatch::alignToField(points, best.grid, start, prior, wide);
  guidance.match = scanmatch::alignToField(points, best.grid, rough.T_map_robot, prior, fine);
  guidance.moved = core::between(T_before, guidance.match.T_map_robot);
  return guidance;
}

void ParticleFilter::matchAll(const std::vector<SurfacePoint>& points, const Guidance& guidance) {
  team_.forEach(particles_.size(), [&](size_t i) {
    Particle& particle = particles_[i];
    const PosePrior prior{particle.T_map_robot * guidance.expected,
                          rotated(guidance.information, particle.T_map_robot.phi)};
    particle.match =
        i == best_ ? guidance.match
                   : scanmatch::alignToField(points, particle.grid, particle.T_map_robot * guidance.moved,
                                             prior, match_options_);
    particle.information = particle.match.information + prior.information;
    particle.T_map_robot = particle.match.T_map_robot;
  });
}

/// From the Gaussian about the peak: with information = L L', the vector L'^-1 u has the covariance information^-1.
void ParticleFilter::drawPose(size_t index) {
  Particle& particle = particles_[index];
  core::RandomStream random(seed_, "particle " + std::to_string(index) + " scan " + std::to_string(scans_));
  const double x = random.normal(), y = random.normal(), z = random.normal();
  const Eigen::LLT<Eigen::Matrix3d> factor(particle.information);
  const Eigen::Vector3d drawn = options_.proposal_scale * factor.matrixU().solve(Eigen::Vector3d(x, y, z));
  if (drawn.allFinite()) particle.T_map_robot = moved(particle.T_map_robot, drawn);
}

/// The integral of likelihood times motion model over the pose: their product at the peak times the volume under it
/// (Laplace). Constants that all particles share are left out.
void ParticleFilter::weigh() {
  for (Particle& particle : particles_) {
    const double log_evidence = -particle.match.cost - particle.match.prior_cost -
                                0.5 * std::log(std::max(particle.information.determinant(), 1e-300));
    particle.log_weight += options_.evidence_scale * log_evidence;
    particle.total_log_weight += options_.evidence_scale * log_evidence;
  }
}

/// Systematic resampling, when few particles carry most of the weight.
void ParticleFilter::resample() {
  const size_t count = particles_.size();
  double most = particles_[0].log_weight;
  for (const Particle& particle : particles_) most = std::max(most, particle.log_weight);
  std::vector<double> weights;
  double sum = 0, squares = 0;
  for (const Particle& particle : particles_) {
    const double weight = std::exp(particle.log_weight - most);
    weights.push_back(weight), sum += weight, squares += weight * weight;
  }
  step_.effective_share = sum * sum / squares / static_cast<double>(count);
  if (step_.effective_share >= options_.resample_below) return;

  step_.resampled = true;
  core::RandomStream random(seed_, "resampling scan " + std::to_string(scans_));
  const double pace = sum / static_cast<double>(count), start = random.uniform() * pace;
  std::vector<size_t> times(count, 0);
  double reached = 0;
  size_t drawn = 0, last = 0;
  for (size_t i = 0; i < count; ++i) {
    reached += weights[i];
    for (; drawn < count && start + static_cast<double>(drawn) * pace < reached; ++drawn)
      ++times[i], last = i;
  }
  times[last] += count - drawn;  // what rounding left over
  size_t to = 0;
  for (size_t from = 0; from < count; ++from)
    for (; times[from] > 1; --times[from]) {
      while (times[to] > 0) ++to;
      paths_.release(particles_[to].leaf);
      particles_[to] = particles_[from];
      paths_.share(particles_[to].leaf);
      times[to] = 1;
    }
  for (Particle& particle : particles_) particle.log_weight = 0;
}

void ParticleFilter::findBest() {
  best_ = 0;
  for (size_t i = 1; i < particles_.size(); ++i)
    if (particles_[i].total_log_weight > particles_[best_].total_log_weight) best_ = i;
}

void ParticleFilter::estimateCovariance() {
  const core::Pose2& T = particles_[best_].T_map_robot;
  double most = particles_[0].log_weight, sum = 0;
  for (const Particle& particle : particles_) most = std::max(most, particle.log_weight);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Particle& particle : particles_) {
    const double weight = std::exp(particle.log_weight - most);
    const Eigen::Vector3d off(particle.T_map_robot.x - T.x, particle.T_map_robot.y - T.y,
                              core::angleDifference(particle.T_map_robot.phi, T.phi));
    sum += weight, mean += weight * off;
    covariance += weight * (off * off.transpose() + particle.information.inverse());
  }
  mean /= sum;
  step_.covariance = covariance / sum - mean * mean.transpose();
}

const ParticleStep& ParticleFilter::update(const robot::Scan& scan, const std::optional<Motion>& motion) {
  if (motion && !(core::isFinite(motion->T_previous_robot) && motion->covariance.allFinite()))
    throw core::ContractError("ParticleFilter::update: the motion is not finite");
  const bool is_first = scans_ == 0 && !map_is_known_;
  step_ = {};
  if (!is_first) {
    const auto points = scanmatch::surfacePoints(scan, point_options_);
    const Guidance guidance = guide(points, scans_ == 0 ? std::nullopt : motion);
    matchAll(points, guidance);
    velocity_ = guidance.moved;
    step_.score = guidance.match.score;
    step_.degenerate = guidance.match.degenerate;
    step_.lost = step_.score < options_.lost_score;
  }
  const core::Pose2& T = particles_[best_].T_map_robot;
  step_.inserted =
      mapping_ && (is_first || step_.score < options_.insert_score ||
                   core::distance(T, T_inserted_) > options_.insert_distance_m ||
                   std::abs(core::angleDifference(T.phi, T_inserted_.phi)) > options_.insert_angle_rad);
  if (step_.inserted) {
    if (!is_first) weigh();
    const gridmap::ScanRays rays = gridmap::scanRays(scan, options_.rays);
    team_.forEach(particles_.size(), [&](size_t i) {
      if (!is_first) drawPose(i);
      particles_[i].grid.insert(rays, particles_[i].T_map_robot);
    });
  }
  for (Particle& particle : particles_)
    particle.leaf = paths_.extend(particle.leaf, {scan.time_s, particle.T_map_robot});
  if (step_.inserted) {
    if (!is_first) resample();
    findBest();
    T_inserted_ = particles_[best_].T_map_robot;
    if (insertions_++ % kCountEvery == 0)
      cells_ = static_cast<double>(distinctTiles()) * gridmap::Grid::tileBytes() / sizeof(gridmap::Cell);
  }
  if (!is_first) estimateCovariance();
  step_.T_map_robot = particles_[best_].T_map_robot;
  ++scans_;
  return step_;
}

size_t ParticleFilter::distinctTiles() const {
  std::vector<const void*> tiles;
  for (const Particle& particle : particles_) particle.grid.appendTiles(tiles);
  std::sort(tiles.begin(), tiles.end());
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
  return tiles.size();
}

size_t ParticleFilter::bytes() const {
  size_t directories = 0;
  for (const Particle& particle : particles_) directories += particle.grid.directoryBytes();
  return distinctTiles() * gridmap::Grid::tileBytes() + directories + paths_.bytes();
}

}  // namespace slam::mapping

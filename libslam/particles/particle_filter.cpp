#include "libslam/particles/particle_filter.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <string>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/keyframes/matching.h"

namespace slam::particles {

using scanmatch::PosePrior;
using scanmatch::SurfacePoint;

namespace {

constexpr std::uint64_t kCountEvery = 32;
/// No lidar of a robot sees farther, and a reading in error must not fill the memory.
constexpr double kFarthest_m = 100;

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

ParticleFilter::ParticleFilter(const ParticleFilterOptions& options, std::uint64_t seed)
    : options_(options), seed_(seed), team_(options.threads) {
  point_options_.spacing_m = options.point_spacing_m;
  match_options_.sigma_m = options.sigma_m;
  match_options_.kernel_m = options.kernel_m;
  match_options_.information_scale = options.information_scale;
  match_options_.max_iterations = options.iterations;
  particles_.assign(static_cast<size_t>(options.count), Particle(gridOptions(options)));
  for (Particle& particle : particles_) particle.T_raster_robot = rasterFromMap();
  beginPast(options.loops);
}

void ParticleFilter::note(core::JournalEvent event, double value, const std::string& detail) {
  journal_.push_back({static_cast<int>(scans_), event, value, -1, detail});
}

void ParticleFilter::start(const core::Pose2& T_map_robot,
                           const std::vector<std::pair<gridmap::ScanRays, core::Pose2>>& known) {
  if (scans_ > 0) throw core::ContractError("ParticleFilter::start: scans were seen already");
  for (const auto& [rays, T_map_seen] : known) particles_[0].grid.insert(rays, rasterFromMap() * T_map_seen);
  particles_[0].T_raster_robot = rasterFromMap() * T_map_robot;
  for (Particle& particle : particles_) particle = particles_[0];
  step_.T_map_robot = T_map_robot;
  map_is_known_ = !known.empty();
  beginPast(options_.loops && !map_is_known_);
}

/// Where the scan enters no map it weighs no particle: the best one's motion does for the others.
void ParticleFilter::matchAll(const std::vector<SurfacePoint>& points, const Guidance& guidance) {
  const bool is_news = mapping_ && isNews(guidance.match.T_map_robot);
  team_.forEach(particles_.size(), [&](size_t i) {
    Particle& particle = particles_[i];
    const PosePrior prior{particle.T_raster_robot * guidance.expected,
                          rotated(guidance.information, particle.T_raster_robot.phi)};
    if (i != best_ && !is_news) {
      particle.T_raster_robot = particle.T_raster_robot * guidance.moved;
      return;
    }
    particle.match =
        i == best_ ? guidance.match
                   : scanmatch::alignToField(points, particle.grid, particle.T_raster_robot * guidance.moved,
                                             prior, match_options_);
    particle.information = particle.match.information + prior.information;
    particle.T_raster_robot = particle.match.T_map_robot;
  });
}

/// Whether a scan at this pose enters the maps.
bool ParticleFilter::isNews(const core::Pose2& T_raster_robot) const {
  return step_.score < options_.insert_score ||
         core::distance(T_raster_robot, T_inserted_) > options_.insert_distance_m ||
         std::abs(core::angleDifference(T_raster_robot.phi, T_inserted_.phi)) > options_.insert_angle_rad;
}

/// By the odometry alone; without any, nowhere.
void ParticleFilter::moveAll(const std::optional<Motion>& motion) {
  velocity_ = motion ? motion->T_previous_robot : core::Pose2{};
  for (Particle& particle : particles_) {
    particle.T_raster_robot = particle.T_raster_robot * velocity_;
    particle.match = {};
  }
}

/// From the Gaussian about the peak: with information = L L', the vector L'^-1 u has the covariance
/// information^-1.
void ParticleFilter::drawPose(size_t index) {
  Particle& particle = particles_[index];
  core::RandomStream random(seed_, "particle " + std::to_string(index) + " scan " + std::to_string(scans_));
  const double x = random.normal(), y = random.normal(), z = random.normal();
  const Eigen::LLT<Eigen::Matrix3d> factor(particle.information);
  const Eigen::Vector3d drawn = options_.proposal_scale * factor.matrixU().solve(Eigen::Vector3d(x, y, z));
  if (drawn.allFinite()) particle.T_raster_robot = moved(particle.T_raster_robot, drawn);
}

void ParticleFilter::findBest() {
  best_ = 0;
  for (size_t i = 1; i < particles_.size(); ++i)
    if (particles_[i].total_log_weight > particles_[best_].total_log_weight) best_ = i;
}

/// Of the best particle's pose against the map, one scan further: an error of the pose before is carried
/// along, the odometry adds its own, and the match takes the gain (I_scan + I_prior)^-1 I_scan off both and
/// puts the scan's in their place.
void ParticleFilter::trackDrift(const core::Pose2& T_before, const Eigen::Matrix3d& motion_covariance,
                                const Eigen::Matrix3d& prior_information) {
  const Particle& best = particles_[best_];
  const Eigen::Matrix3d F = keyframes::moved(core::position(T_before), core::position(best.T_raster_robot));
  const Eigen::Matrix3d posterior = (best.match.information + prior_information).inverse();
  const Eigen::Matrix3d gain = posterior * best.match.information, kept = Eigen::Matrix3d::Identity() - gain;
  const Eigen::Matrix3d predicted = F * local_covariance_ * F.transpose() + motion_covariance;
  const double noise = best.match.residual_m / options_.sigma_m;
  local_covariance_ = kept * predicted * kept.transpose() + noise * noise * options_.drift_scale * posterior *
                                                                best.match.information *
                                                                posterior.transpose();
}

void ParticleFilter::estimateCovariance() {
  const core::Pose2& T = particles_[best_].T_raster_robot;
  double most = particles_[0].log_weight, sum = 0;
  for (const Particle& particle : particles_) most = std::max(most, particle.log_weight);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Particle& particle : particles_) {
    const double weight = core::exp(particle.log_weight - most);
    const Eigen::Vector3d off(particle.T_raster_robot.x - T.x, particle.T_raster_robot.y - T.y,
                              core::angleDifference(particle.T_raster_robot.phi, T.phi));
    sum += weight, mean += weight * off;
    spread += weight * off * off.transpose();
  }
  mean /= sum;
  Eigen::Matrix3d own = local_covariance_ + sweep_covariance_;
  if (const int anchor = past_->anchor(); anchor >= 0) {
    const Eigen::Matrix3d F = keyframes::moved(core::position(past_->pose(anchor)), core::position(T));
    own += F * past_->covariance(anchor) * F.transpose();
  }
  step_.covariance = rotated(own + spread / sum - mean * mean.transpose(), mapFromRaster().phi);
}

void ParticleFilter::reachFarther(const lidar::Scan& scan) {
  std::vector<float> returns_m;
  std::copy_if(scan.ranges_m.begin(), scan.ranges_m.end(), std::back_inserter(returns_m), lidar::isReturn);
  if (returns_m.empty()) return;
  const auto quartile = returns_m.begin() + static_cast<std::ptrdiff_t>(returns_m.size() * 3 / 4);
  std::nth_element(returns_m.begin(), quartile, returns_m.end());
  options_.rays.max_range_m =
      std::max(options_.rays.max_range_m, std::min(kFarthest_m, std::ceil(static_cast<double>(*quartile))));
  point_options_.max_range_m = std::max(point_options_.max_range_m, options_.rays.max_range_m);
}

void ParticleFilter::findPlace(const std::vector<SurfacePoint>& points, const std::optional<Motion>& motion) {
  const core::Pose2 T_before = particles_[best_].T_raster_robot;
  const Guidance guidance = guide(points, motion);
  step_.score = guidance.match.score;
  step_.degenerate = guidance.match.degenerate;
  if (explained(points, guidance, motion.has_value()) <
      (lost_ ? options_.insert_score : options_.lost_score)) {
    if (!lost_) note(core::JournalEvent::kLost, step_.score);
    step_.lost = lost_ = true;
    moveAll(motion);
    if (!points.empty()) ++lost_scans_, lost_m_ += core::hypot(velocity_.x, velocity_.y);
    const Eigen::Matrix3d covariance = motion ? motion->covariance : unknownCovariance();
    trackDrift(T_before, rotated(covariance, T_before.phi), Eigen::Matrix3d::Identity());
    since_keyframe_ = since_keyframe_ * Motion{velocity_, covariance};
    return;
  }
  if (lost_) note(core::JournalEvent::kRecovered, step_.score);
  lost_ = false, lost_scans_ = 0, lost_m_ = 0;
  if (step_.score < options_.insert_score) note(core::JournalEvent::kPoor, step_.score);
  if (step_.degenerate) {
    const double share = guidance.match.fixed_sigma_m / guidance.match.free_sigma_m;
    note(core::JournalEvent::kDegenerate, share * share);
  }
  matchAll(points, guidance);
  velocity_ = guidance.moved;
  const Eigen::Matrix3d prior_information = rotated(guidance.information, T_before.phi);
  trackDrift(T_before, prior_information.inverse(), prior_information);
  since_keyframe_ = since_keyframe_ * Motion{guidance.expected, guidance.information.inverse()};
}

/// Whether the old map is given up for the place where the robot is.
bool ParticleFilter::drawsOn() {
  if (!mapping_ || !lost_ || (lost_scans_ < options_.lost_scans && lost_m_ < options_.lost_m)) return false;
  note(core::JournalEvent::kRestarted, lost_scans_);
  lost_ = false, lost_scans_ = 0, lost_m_ = 0;
  return true;
}

/// The scan at hand into all maps.
void ParticleFilter::insert(const std::vector<lidar::Scan>& others, bool is_matched) {
  if (is_matched) weigh();
  std::vector<gridmap::ScanRays> seen = {gridmap::scanRays(scan_, options_.rays)};
  for (const auto& other : others) seen.push_back(gridmap::scanRays(other, options_.rays));
  team_.forEach(particles_.size(), [&](size_t i) {
    if (is_matched) drawPose(i);
    for (const auto& rays : seen) particles_[i].grid.insert(rays, particles_[i].T_raster_robot);
  });
}

const ParticleStep& ParticleFilter::update(const lidar::Scan& given, const std::optional<Motion>& motion,
                                           const std::vector<lidar::Scan>& others) {
  if (motion && !(core::isFinite(motion->T_previous_robot) && motion->covariance.allFinite()))
    throw core::ContractError("ParticleFilter::update: the motion is not finite");
  const bool is_first = scans_ == 0 && !map_is_known_;
  const core::Pose2 T_before = particles_[best_].T_raster_robot;
  step_ = {};
  std::optional<Motion> by_wheels;
  scan_ = given;
  sweep_covariance_.setZero();
  if (!is_first) {
    by_wheels = believed(motion, given.time_s);
    if (by_wheels && !lost_)
      if (auto right = sweeps_->setRight(given, T_before, *by_wheels))
        scan_ = std::move(right->scan), sweep_covariance_ = right->noise;
  }
  const lidar::Scan& scan = scan_;
  reachFarther(scan);
  for (const auto& other : others) reachFarther(other);
  if (!is_first) {
    auto points = scanmatch::surfacePoints(scan, point_options_);
    for (const auto& other : others) {
      const auto more = scanmatch::surfacePoints(other, point_options_);
      points.insert(points.end(), more.begin(), more.end());
    }
    findPlace(points, by_wheels);
    learnWheels(by_wheels, T_before);
  } else {
    previous_time_s_ = scan.time_s;
  }
  const bool restarted = drawsOn();
  const core::Pose2 T = particles_[best_].T_raster_robot;
  past_->nextScan(core::distance(T_before, T));
  step_.inserted = mapping_ && (is_first || restarted || (!lost_ && isNews(T)));
  if (step_.inserted) insert(others, !is_first && !restarted);
  for (Particle& particle : particles_)
    particle.leaf = paths_.extend(particle.leaf, {scan.time_s, particle.T_raster_robot});
  if (step_.inserted) {
    if (!is_first) resample();
    findBest();
    T_inserted_ = particles_[best_].T_raster_robot;
    if (insertions_++ % kCountEvery == 0)
      cells_ = static_cast<double>(mapBytes()) / gridmap::Grid::kCellBytes;
    std::vector<lidar::Scan> scans = {scan};
    scans.insert(scans.end(), others.begin(), others.end());
    keepKeyframe(scans, !is_first && !restarted);
  }
  estimateCovariance();
  drifts_.push_back({past_->anchor(), local_covariance_ + sweep_covariance_});
  step_.T_map_robot = mapFromRaster() * particles_[best_].T_raster_robot;
  ++scans_;
  return step_;
}

std::vector<core::Pose2> ParticleFilter::poses() const {
  std::vector<core::Pose2> poses;
  poses.reserve(particles_.size());
  for (const Particle& particle : particles_) poses.push_back(mapFromRaster() * particle.T_raster_robot);
  return poses;
}

/// Of all particles' maps, what is shared counted once.
size_t ParticleFilter::mapBytes() const {
  std::vector<std::pair<const void*, size_t>> parts;
  for (const Particle& particle : particles_) particle.grid.appendParts(parts);
  std::sort(parts.begin(), parts.end());
  parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
  return std::accumulate(parts.begin(), parts.end(), size_t{0},
                         [](size_t sum, const auto& part) { return sum + part.second; });
}

size_t ParticleFilter::bytes() const {
  size_t directories = 0;
  for (const Particle& particle : particles_) directories += particle.grid.directoryBytes();
  return mapBytes() + directories + paths_.bytes();
}

}  // namespace slam::particles

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/keyframes/matching.h"
#include "libslam/particles/particle_filter.h"
#include "libslam/scanmatch/information.h"
#include "libslam/uncertainty/relative_error.h"

namespace slam::particles {
namespace {

/// A past that has moved by less, in cells, is drawn as it was; a turn counts as the metres that it moves a
/// wall by at this distance.
constexpr double kSameMap = 0.25, kWall_m = 3;

}  // namespace

void ParticleFilter::beginPast(bool closes_loops) {
  keyframes::GraphOptions options;
  options.loops = closes_loops;
  past_ = std::make_unique<loops::TrackedPath>(options);
  sweeps_ = std::make_unique<Sweeps>(*past_);
}

/// The best particle may be another one than before: keyframes since the last loop go where its past has
/// them.
void ParticleFilter::alignKeyframes(int newest_scan) {
  PathTree::Id node = particles_[best_].leaf;
  int scan = newest_scan;
  for (int k = past_->size() - 1; k >= shared_keyframes_; --k) {
    for (; scan > past_->scan(k); --scan) node = paths_.before(node);
    const core::Pose2& T = paths_.pose(node).pose;
    const core::Pose2& known = past_->pose(k);
    // From here on they have the same past.
    if (T == known) return;
    past_->setPose(k, T);
  }
}

void ParticleFilter::keepKeyframe(const std::vector<lidar::Scan>& seen, bool is_matched) {
  alignKeyframes(static_cast<int>(scans_));
  loops::TrackedPath::Placed placed;
  if (!sweep_covariance_.isZero()) placed.noise = sweep_covariance_;
  placed.T_map_robot = particles_[best_].T_raster_robot;
  placed.T_before_robot = since_keyframe_.T_previous_robot;
  placed.odometry_covariance = since_keyframe_.covariance;
  placed.is_matched = is_matched;
  placed.is_explained = step_.score >= options_.insert_score;
  if (step_.degenerate) placed.open = particles_[best_].match.free_direction;
  local_covariance_.setZero();
  since_keyframe_ = {{}, Eigen::Matrix3d::Zero()};
  std::vector<core::Pose2> before = past_->poses();
  before.push_back(placed.T_map_robot);  // of a keyframe that may come
  const size_t noted = past_->journal().size();
  const bool is_closed = past_->addKeyframe(seen, placed);
  journal_.insert(journal_.end(), past_->journal().begin() + static_cast<long>(noted),
                  past_->journal().end());
  if (is_closed) followLoop(before);
}

/// That a scan hangs on; what came before the first one hangs on it, too.
int ParticleFilter::keyframeOf(size_t scan) const {
  return std::max(scan < drifts_.size() ? drifts_[scan].keyframe : past_->anchor(), 0);
}

/// All particles go on from the past that the graph has now.
void ParticleFilter::followLoop(const std::vector<core::Pose2>& before) {
  step_.loop_closed = true;
  const core::Trajectory since = paths_.path(particles_[best_].leaf);
  for (const auto& [time_s, T_raster_robot] : since) {
    const auto k = static_cast<size_t>(keyframeOf(past_scans_.size()));
    past_scans_.push_back({time_s, core::between(before[k], T_raster_robot)});
  }
  redrawMap(before);
  Particle& best = particles_[best_];
  best.T_raster_robot = past_->pose(keyframeOf(past_scans_.size() - 1)) * past_scans_.back().T_keyframe_robot;
  best.log_weight = 0;
  for (Particle& particle : particles_) {
    paths_.release(particle.leaf);
    particle.leaf = PathTree::kNone;
  }
  for (Particle& particle : particles_)
    if (&particle != &best) particle = best;
  shared_keyframes_ = past_->size();
  T_inserted_ = best.T_raster_robot;
}

/// The best particle's, where its past has moved by more than the map shows.
void ParticleFilter::redrawMap(const std::vector<core::Pose2>& before) {
  gridmap::Grid& map = particles_[best_].grid;
  double most_m = 0;
  for (int k = 0; k < past_->size(); ++k) {
    const core::Pose2 moved = core::between(before[static_cast<size_t>(k)], past_->pose(k));
    most_m = std::max(most_m, core::hypot(moved.x, moved.y) + kWall_m * std::abs(moved.phi));
  }
  if (most_m < kSameMap * options_.cell_m) return;
  map = gridmap::Grid(map.options());
  for (int k = 0; k < past_->size(); ++k)
    for (const auto& scan : past_->seen(k))
      map.insert(gridmap::scanRays(scan, options_.rays), past_->pose(k));
}

void ParticleFilter::finish() {
  if (scans_ == 0) return;
  alignKeyframes(static_cast<int>(scans_) - 1);
  const std::vector<core::Pose2> before = past_->poses();
  const size_t noted = past_->journal().size();
  const bool have_moved = past_->finish();
  journal_.insert(journal_.end(), past_->journal().begin() + static_cast<long>(noted),
                  past_->journal().end());
  if (!have_moved) return;
  followLoop(before);
  step_.T_map_robot = mapFromRaster() * particles_[best_].T_raster_robot;
}

core::Trajectory ParticleFilter::path() const {
  core::Trajectory path;
  for (size_t i = 0; i < past_scans_.size(); ++i)
    path.push_back({past_scans_[i].time_s, past_->pose(keyframeOf(i)) * past_scans_[i].T_keyframe_robot});
  const core::Trajectory since = paths_.path(particles_[best_].leaf);
  path.insert(path.end(), since.begin(), since.end());
  for (core::StampedPose& pose : path) pose.pose = mapFromRaster() * pose.pose;
  return path;
}

std::vector<Eigen::Matrix3d> ParticleFilter::covariances() const {
  const auto keyframes = past_->covariances();
  const core::Trajectory poses = path();
  std::vector<Eigen::Matrix3d> result;
  result.reserve(drifts_.size());
  for (size_t i = 0; i < drifts_.size(); ++i) {
    const auto& [k, drift] = drifts_[i];
    Eigen::Matrix3d own = drift;
    if (k >= 0) {
      const Eigen::Matrix3d F =
          keyframes::moved(core::position(past_->pose(k)), core::position(rasterFromMap() * poses[i].pose));
      own += F * keyframes[static_cast<size_t>(k)] * F.transpose();
    }
    result.push_back(scanmatch::turned(own, kRasterTurn_rad));
  }
  return result;
}

std::vector<Eigen::Matrix3d> ParticleFilter::relativeCovariances(
    const std::vector<std::pair<int, int>>& scans) const {
  if (past_->size() == 0) return {};
  const core::Trajectory poses = path();
  const auto hung = [&](int scan) -> uncertainty::HungScan {
    const auto i = static_cast<size_t>(scan);
    const int k = keyframeOf(i);
    return {k, core::between(past_->pose(k), rasterFromMap() * poses.at(i).pose), drifts_.at(i).covariance};
  };
  std::vector<std::pair<uncertainty::HungScan, uncertainty::HungScan>> pairs;
  pairs.reserve(scans.size());
  for (const auto& [first, second] : scans) pairs.emplace_back(hung(first), hung(second));
  return past_->relativeCovariances(pairs);
}

}  // namespace slam::particles

#include "libslam/builders/particle_map_builder.h"

#include <mrpt/math/TPose2D.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/poses/CPosePDF.h>

#include <algorithm>
#include <cmath>

#include "libslam/lidar/mrpt_types.h"

namespace slam::builders {

using mrpt::maps::COccupancyGridMap2D;
using mrpt::obs::CObservation2DRangeScan;

namespace {

/// A motion that claims to be certain would leave no room for the match.
constexpr double kLeastSigma_m = 1e-4, kLeastSigma_rad = 1e-4;

gridmap::GridOptions publishedGrid(const MappingOptions& mapping) {
  gridmap::GridOptions grid;
  grid.cell_m = mapping.resolution_m;
  // As the other methods draw theirs: what one scan saw is decided.
  grid.hit_probability = std::clamp(mapping.occupied_certainty, 0.51, grid.max_probability);
  grid.pass_probability = std::clamp(1 - mapping.occupied_certainty, grid.min_probability, 0.49);
  // The published map is looked at, not matched to.
  grid.reach_cells = 1;
  return grid;
}

particles::ParticleFilterOptions filterOptions(particles::ParticleFilterOptions options,
                                               const MappingOptions& mapping) {
  options.insert_distance_m = mapping.insert_distance_m;
  options.insert_angle_rad = mapping.insert_angle_rad;
  options.rays = {mapping.max_insert_range_m, mapping.no_return_is_free};
  return options;
}

std::vector<CObservation2DRangeScan::Ptr> scansOf(const mrpt::obs::CSensoryFrame& frame) {
  std::vector<CObservation2DRangeScan::Ptr> scans;
  for (size_t i = 0; i < frame.size(); ++i)
    if (auto scan = std::dynamic_pointer_cast<CObservation2DRangeScan>(frame.getObservationByIndex(i)))
      scans.push_back(scan);
  return scans;
}

particles::Motion fromMrpt(const mrpt::poses::CPosePDF& change) {
  mrpt::math::CMatrixDouble33 covariance;
  mrpt::poses::CPose2D mean;
  change.getCovarianceAndMean(covariance, mean);
  particles::Motion motion;
  motion.T_previous_robot = lidar::fromMrpt(mean.asTPose());
  motion.covariance = covariance.asEigen();
  return motion;
}

/// MRPT's grid with the cells of ours. Its log-odds are those of being free.
void publish(const gridmap::OccupancyRaster& raster, COccupancyGridMap2D& grid) {
  const double resolution_m = raster.resolution_m;
  grid.setSize(
      static_cast<float>(raster.x_min_m), static_cast<float>(raster.x_min_m + raster.columns * resolution_m),
      static_cast<float>(raster.y_min_m), static_cast<float>(raster.y_min_m + raster.rows * resolution_m),
      static_cast<float>(resolution_m));
  const int columns = std::min(raster.columns, static_cast<int>(grid.getSizeX()));
  const int rows = std::min(raster.rows, static_cast<int>(grid.getSizeY()));
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const float occupied = raster.at(column, row);
      if (occupied != 0.5F) grid.setCell(column, row, 1 - occupied);
    }
}

}  // namespace

ParticleMapBuilder::ParticleMapBuilder(const particles::ParticleFilterOptions& filter,
                                       const MappingOptions& mapping, std::uint64_t seed)
    : filter_options_(filterOptions(filter, mapping)),
      seed_(seed),
      start_map_(publishedGrid(mapping)),
      drawn_(start_map_) {
  initialize();
}

void ParticleMapBuilder::useThreads(int threads) {
  if (threads <= filter_options_.threads) return;
  filter_options_.threads = threads;
  filter_->useThreads(threads);
}

void ParticleMapBuilder::initialize(const mrpt::maps::CSimpleMap& initialMap,
                                    const mrpt::poses::CPosePDF* x0) {
  initial_map_ = initialMap;
  key_frames_.clear(), drawn_poses_.clear(), motion_.reset();
  start_map_ = gridmap::Grid(start_map_.options());
  filter_ = std::make_unique<particles::ParticleFilter>(filter_options_, seed_);
  std::vector<std::pair<gridmap::ScanRays, core::Pose2>> known;
  for (size_t i = 0; i < initial_map_.size(); ++i) {
    const auto [pose, frame] = compat::frameOf(initial_map_, i);
    if (!frame || !pose) continue;
    const auto mean = pose->getMeanVal();
    for (const auto& scan : scansOf(*frame)) {
      known.emplace_back(gridmap::scanRays(lidar::fromMrpt(*scan), filter_options_.rays),
                         core::Pose2{mean.x(), mean.y(), mean.yaw()});
      start_map_.insert(known.back().first, known.back().second);
    }
  }
  const core::Pose2 T_map_robot = x0 != nullptr ? lidar::fromMrpt(x0->getMeanVal().asTPose()) : core::Pose2{};
  if (!known.empty() || x0 != nullptr) filter_->start(T_map_robot, known);
  drawn_ = start_map_;
  published_ = COccupancyGridMap2D::Create();
  maps_.maps.clear();
  maps_.maps.push_back(published_);
  up_to_date_ = false;
}

mrpt::poses::CPose3DPDF::Ptr ParticleMapBuilder::getCurrentPoseEstimation() const {
  const particles::ParticleStep& step = filter_->lastStep();
  auto pose = mrpt::poses::CPose3DPDFGaussian::Create();
  pose->mean = mrpt::poses::CPose3D(mrpt::poses::CPose2D(lidar::toMrpt(step.T_map_robot)));
  // (x, y, z, yaw, pitch, roll)
  constexpr std::array<int, 3> kRow = {0, 1, 3};
  pose->cov.setZero();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      pose->cov(kRow[static_cast<size_t>(row)], kRow[static_cast<size_t>(column)]) =
          step.covariance(row, column);
  return pose;
}

void ParticleMapBuilder::addMotion(const mrpt::poses::CPosePDF& change) {
  particles::Motion motion = fromMrpt(change);
  motion.covariance.diagonal() += Eigen::Vector3d(
      kLeastSigma_m * kLeastSigma_m, kLeastSigma_m * kLeastSigma_m, kLeastSigma_rad * kLeastSigma_rad);
  motion_ = motion_ ? *motion_ * motion : motion;
}

void ParticleMapBuilder::takeIn(const lidar::Scan& scan, const std::vector<lidar::Scan>& others) {
  filter_->setMapping(options.enableMapUpdating);
  const particles::ParticleStep& step = filter_->update(scan, motion_, others);
  motion_.reset();
  if (!step.inserted) return;
  up_to_date_ = false;
  key_frames_.push_back({filter_->scans() - 1, {filter_->lastScan()}, filter_->rays().max_range_m});
  key_frames_.back().seen.insert(key_frames_.back().seen.end(), others.begin(), others.end());
}

void ParticleMapBuilder::processScans(const lidar::Scan& scan, const std::vector<lidar::Scan>& others,
                                      const mrpt::poses::CPosePDF& motion) {
  addMotion(motion);
  takeIn(scan, others);
}

void ParticleMapBuilder::processActionObservation(mrpt::obs::CActionCollection& action,
                                                  mrpt::obs::CSensoryFrame& observations) {
  if (const auto movement = action.getBestMovementEstimation()) addMotion(*movement->poseChange);
  const auto scans = scansOf(observations);
  if (scans.empty()) return;
  std::vector<lidar::Scan> others;
  for (size_t i = 1; i < scans.size(); ++i) others.push_back(lidar::fromMrpt(*scans[i]));
  takeIn(lidar::fromMrpt(*scans.front()), others);
}

void ParticleMapBuilder::finish() {
  filter_->finish();
  up_to_date_ = false;
}

void ParticleMapBuilder::getCurrentlyBuiltMap(mrpt::maps::CSimpleMap& out_map) const {
  out_map = initial_map_;
  const core::Trajectory path = filter_->path();
  for (const KeyFrame& key_frame : key_frames_) {
    mrpt::poses::CPose3DPDFGaussian pose;
    pose.mean = mrpt::poses::CPose3D(mrpt::poses::CPose2D(lidar::toMrpt(path[key_frame.scan].pose)));
    mrpt::obs::CSensoryFrame frame;
    for (const auto& scan : key_frame.seen) lidar::addTo(frame, scan, key_frame.seen.front().time_s);
    compat::insertFrame(out_map, pose, frame);
  }
}

compat::MapSize ParticleMapBuilder::getCurrentlyBuiltMapSize() {
  return static_cast<compat::MapSize>(initial_map_.size() + key_frames_.size());
}

void ParticleMapBuilder::drawMap() const {
  if (up_to_date_) return;
  const core::Trajectory path = filter_->path();
  for (size_t i = 0; i < drawn_poses_.size(); ++i)
    if (!(drawn_poses_[i] == path[key_frames_[i].scan].pose)) {
      drawn_ = start_map_;
      drawn_poses_.clear();
    }
  while (drawn_poses_.size() < key_frames_.size()) {
    const KeyFrame& key_frame = key_frames_[drawn_poses_.size()];
    drawn_poses_.push_back(path[key_frame.scan].pose);
    gridmap::RayOptions rays = filter_->rays();
    rays.max_range_m = key_frame.max_range_m;
    for (const auto& scan : key_frame.seen) drawn_.insert(gridmap::scanRays(scan, rays), drawn_poses_.back());
  }
  publish(drawn_.toRaster(), *published_);
  up_to_date_ = true;
}

compat::BuiltMap ParticleMapBuilder::getCurrentlyBuiltMetricMap() const {
  drawMap();
  return compat::builtMap(maps_);
}

void ParticleMapBuilder::saveCurrentEstimationToImage(RASTERSLAM_MRPT_SAVE_IMAGE_ARGUMENTS) {
  drawMap();
  published_->saveAsBitmapFile(file);
}

}  // namespace slam::builders

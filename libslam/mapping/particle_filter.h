#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "libslam/core/thread_team.h"
#include "libslam/gridmap/grid.h"
#include "libslam/mapping/path_tree.h"
#include "libslam/scanmatch/field_matcher.h"

namespace slam::mapping {

struct ParticleFilterOptions {
  int particles = 30;
  int threads = 1;
  double resample_below = 0.5;
  double proposal_scale = 1;      ///< on the standard deviations that are drawn from
  int refine_iterations = 3;
  double weight_scale = 1;
  // motion
  double sigma_xy_m = 0.02, sigma_xy_per_m = 0.1, sigma_turn_rad = 0.01, sigma_turn_per_rad = 0.2;
  double distrust_score = 0.1;
  double insert_distance_m = 0.2, insert_angle_rad = 0.2, insert_score = 0.6;
  double lost_score = 0.2;
  scanmatch::ScanPointOptions points;
  scanmatch::FieldMatchOptions match;
  double wide_kernel_m = 0.2;
  gridmap::GridOptions grid;
  gridmap::RayOptions rays;
};

/// What one scan did.
struct ParticleStep {
  core::Pose2 T_map_robot;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double score = 1;
  double effective = 1;  ///< effective share of particles
  bool inserted = false, resampled = false, degenerate = false, odometry_distrusted = false, lost = false;
};

class ParticleFilter {
 public:
  ParticleFilter(const ParticleFilterOptions& options, std::uint64_t seed);

  const ParticleStep& update(const robot::Scan& scan, const std::optional<core::Pose2>& T_previous_robot);
  core::Trajectory path() const { return paths_.path(particles_[best_].leaf); }
  const gridmap::Grid& map() const { return particles_[best_].grid; }
  size_t bytes() const;

 private:
  struct Particle {
    gridmap::Grid grid;
    core::Pose2 T_map_robot;
    PathTree::Id leaf = PathTree::kNone;
    double log_weight = 0;        ///< since the last resampling
    double total_log_weight = 0;  ///< since the start
    scanmatch::FieldMatch match;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  };
  void matchAll(const std::vector<scanmatch::SurfacePoint>& points, const core::Pose2& increment, bool has_odometry);
  void insertAll(const robot::Scan& scan);
  void weigh();
  void resample();
  void estimate();

  ParticleFilterOptions options_;
  std::uint64_t seed_;
  std::uint64_t scans_ = 0;
  core::ThreadTeam team_;
  std::vector<Particle> particles_;
  PathTree paths_;
  size_t best_ = 0;
  core::Pose2 T_inserted_, velocity_;
  ParticleStep step_;
};

}  // namespace slam::mapping

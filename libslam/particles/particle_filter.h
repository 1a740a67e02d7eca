#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libslam/core/journal.h"
#include "libslam/files/parameters.h"
#include "libslam/gridmap/grid.h"
#include "libslam/loops/tracked_path.h"
#include "libslam/particles/motion.h"
#include "libslam/particles/path_tree.h"
#include "libslam/particles/sweeps.h"
#include "libslam/scanmatch/field_matcher.h"
#include "libslam/threads/thread_team.h"
#include "libslam/wheels/leaps.h"
#include "libslam/wheels/silence.h"
#include "libslam/wheels/way_sign.h"
#include "libslam/wheels/wheel_calibration.h"

namespace slam::particles {

/// Section [particles] of type particles. The rows that other types have too (where and how far scans are
/// inserted) come from [mapping].
struct ParticleFilterOptions {
  std::string sampling;  ///< fixed | kld
  int count, least_count, most_count;
  double kld_error, kld_bin_m, kld_bin_rad;
  int threads;
  double cell_m;
  double point_spacing_m;
  double sigma_m, kernel_m, wide_kernel_m, information_scale, drift_scale;
  int iterations;
  double proposal_scale, evidence_scale, resample_below;
  double distrust_score, insert_score, lost_score;
  int lost_scans;
  double lost_m;
  double hit_probability, pass_probability;
  bool loops;
  ParticleFilterOptions();
  static const files::ParameterTable<ParticleFilterOptions>& table();

  double insert_distance_m = 0.3, insert_angle_rad = 0.3;
  gridmap::RayOptions rays{20, true};
};

/// What one scan did: the line of a journal.
struct ParticleStep {
  core::Pose2 T_map_robot;
  /// Over (x, y, phi) in the map frame, against the true pose from the first scan on: the particles' spread,
  /// what scan and odometry leave open here, and the drift of the map since the start (ParticleFilter:
  /// covariance).
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double score = 1;            ///< share of the scan that the best particle's map explains
  double effective_share = 1;  ///< of the particles, before resampling; at insertions only
  bool inserted = false, resampled = false;
  bool odometry_distrusted = false;  ///< the scan fits clearly better where the odometry does not lead
  bool degenerate = false;           ///< the scan leaves a direction open; the odometry is trusted along it
  bool lost = false;                 ///< nothing fits: the pose is the odometry's
  bool loop_closed = false;          ///< the past has moved, and all particles with it
};

/// Particles that keep, with a confidence of 99 %, the Kullback-Leibler distance between what they stand for
/// and the bins that they fall into below `error` (Fox, "Adapting the sample size in particle filters through
/// KLD-sampling", IJRR 22(12), 2003, equation 7). 1 for a single bin. REQUIRES error > 0 and bins >= 1
/// (ContractError).
size_t kldParticles(size_t bins, double error);

/// Logarithm of the evidence that a scan gives for a particle: the integral of likelihood times motion model
/// over the pose, in Laplace's approximation, that is their product at the peak times the volume under it.
/// `information`: of both together, there. Constants that all particles share are left out.
double logEvidence(const scanmatch::FieldMatch& match, const Eigen::Matrix3d& information);

/// A Rao-Blackwellised particle filter: every particle is a path and the map that it implies (Grisetti,
/// Stachniss and Burgard, IEEE T-RO 23(1), 2007). What is different here:
/// - The map is a gridmap::Grid, so that particles share what they have in common, and scans are matched to
///   it by scanmatch::alignToField. That takes microseconds, so every scan is matched.
/// - Proposals are drawn when a scan enters the map, from the Gaussian of matcher and odometry together
///   (there from samples around the peak), and weighted by the integral over it in Laplace's approximation.
///   Between two insertions such scans say the same again: the best particle alone is matched, and the others
///   go with it.
/// - One particle, the best, looks where the motion leads: at the odometry's word, the motion before, the
///   odometry reversed, and turned by some degrees; and all around, when none of these explains the scan. The
///   others start from its motion. Odometry that is clearly worse than another start is distrusted at that
///   scan; its turn alone, where another turn explains as much.
///
/// - The number of particles is fixed, or chosen at every resampling such that the Kullback-Leibler distance
///   to what they stand for stays below a bound (Fox, IJRR 22(12), 2003; bins over the pose at this scan).
///
/// Wheels: leaps that no robot drives are no motion (wheels::Leaps), nor is the word of wheels that have
/// never moved (wheels::Silence). How long their metres are, and how far they turn where the robot does not,
/// is learnt of the best particle (wheels::WheelCalibration).
///
/// Lost: a scan moves no particle but by the odometry, and enters no map, when the map explains less than
/// lost_score of what it says anything of; so do those after it, until the map explains insert_score of one.
/// Of scans that lie on new ground nearly whole, odometry decides. After lost_scans of them with returns, or
/// lost_m metres, the filter gives the old map up for the place where it is: it draws the scan at the
/// odometry's pose and goes on from there.
///
/// Reach: scans enter the maps up to rays.max_range_m. A scan of which more than a quarter of the returns lie
/// beyond, as outdoors, lets it grow for good to where three quarters lie within, so that the maps hold what
/// a scan is matched by.
///
/// Covariance: resampling makes the particles alike, so that their spread alone tells little of how far the
/// map has drifted. Inserted scans are keyframes of a loops::TrackedPath, with keyframes::GraphOptions'
/// defaults, as far as the ground is new to it; it says how sure their poses are. A scan after one adds its
/// own error against the map: that of the matched points, times drift_scale, and of the odometry as far as
/// the match leaves it to hold the pose.
///
/// Loops: resampling leaves few pasts to choose from, and none of them may be right when the robot comes back
/// to where it was long ago. So the keyframes are those of the best particle, and the TrackedPath looks for
/// places seen before and judges them. When a loop is closed all particles go on from the past that the graph
/// then has, in one map that is drawn anew of it: before a loop the particles stand for what is open here,
/// after it the graph does for what was open on the way. (Drawing a past for each particle, each with a map
/// of its own, would cost as many maps; what is drawn at the scans that follow tells the particles apart
/// again.) A filter that begins in a known map closes no loops.
///
/// Journal: TrackedPath's, and `distrusted` (odometry; value = gain in score), `poor` (the map explains less
/// than insert_score; value = score), `lost` (the first scan; value = score), `recovered` (the map explains a
/// scan again; value = score), `restarted` (the map goes on from odometry's pose; value = scans lost),
/// `leapt` (odometry; value = metres), `silent` (the wheels had never moved), `degenerate` (value = share of
/// information along the open direction), `resampled` (value = effective share of the particles; detail = how
/// many there are now).
///
/// Frames: map is the robot's at the first scan. raster, that of the particles' grids, is turned against it:
/// along a wall that lies in the direction of the cells all noise is cut off at the same border of a cell,
/// which bends the map, while along any other the errors of the cells cancel (ring A 0.005 instead of 0.03
/// m). Chance: streams named by particle and scan. Same seed, same bytes, with any number of threads. Memory:
/// map() of one particle, and what the others differ by; and the keyframes, see TrackedPath.
class ParticleFilter {
 public:
  ParticleFilter(const ParticleFilterOptions& options, std::uint64_t seed);

  /// The pose at this scan. Without a motion the motion before is taken to go on, loosely. The first scan's
  /// motion is ignored. `others`: what other lidars saw at that moment. REQUIRES a finite motion
  /// (ContractError).
  const ParticleStep& update(const lidar::Scan& scan, const std::optional<Motion>& motion,
                             const std::vector<lidar::Scan>& others = {});
  const ParticleStep& lastStep() const { return step_; }
  /// So many, instead of options.threads.
  void useThreads(int threads) { team_ = threads::ThreadTeam(threads); }
  /// CPU time so far of those other than the caller's; since useThreads().
  double threadSeconds() const { return team_.threadSeconds(); }

  /// After the last scan: loops that are found with all of the path known. The pose at the last scan follows.
  void finish();
  /// The best particle's path, a pose for every scan: corrected by all that was seen after it.
  core::Trajectory path() const;
  /// Of each pose of path(), over (x, y, phi) in the map frame, against the true pose from the first scan on.
  std::vector<Eigen::Matrix3d> covariances() const;
  /// How sure poses of path() are of one another, by the keyframes: of x (m), y (m), phi (rad) of the second
  /// one in the frame of the first, for pairs of scans. REQUIRES scans that were seen.
  std::vector<Eigen::Matrix3d> relativeCovariances(const std::vector<std::pair<int, int>>& scans) const;
  /// The best particle's map, in the raster's frame.
  const gridmap::Grid& map() const { return particles_[best_].grid; }
  static core::Pose2 rasterFromMap() { return {0, 0, kRasterTurn_rad}; }
  const std::vector<core::JournalEntry>& journal() const { return journal_; }
  /// Every particle starts at T_map_robot, in a map drawn of these scans at their poses (none: an empty one).
  /// REQUIRES that no scan was seen (ContractError).
  void start(const core::Pose2& T_map_robot,
             const std::vector<std::pair<gridmap::ScanRays, core::Pose2>>& known);
  /// Whether scans change the map; without, the filter only finds its place in it.
  void setMapping(bool mapping) { mapping_ = mapping; }
  std::uint64_t scans() const { return scans_; }
  /// The last scan as it was taken in: one that was deskewed by a motion that errs is set right, see Sweeps.
  const lidar::Scan& lastScan() const { return scan_; }
  /// How scans are drawn into the maps now.
  const gridmap::RayOptions& rays() const { return options_.rays; }
  int particles() const { return static_cast<int>(particles_.size()); }
  /// Where the particles are at the last scan, map frame.
  std::vector<core::Pose2> poses() const;
  /// Cells stored in all maps, shared ones counted once; counted again at every 32nd insertion.
  double cells() const { return cells_; }
  /// All maps and paths, what is shared counted once, directories included; without the keyframes. Cost: a
  /// few 10 us per thousand tiles.
  size_t bytes() const;

 private:
  struct Particle {
    explicit Particle(const gridmap::GridOptions& options) : grid(options) {}
    gridmap::Grid grid;
    core::Pose2 T_raster_robot;
    PathTree::Id leaf = PathTree::kNone;
    double log_weight = 0;        ///< since the last resampling
    double total_log_weight = 0;  ///< since the start: what makes a particle the best
    scanmatch::FieldMatch match;
    Eigen::Matrix3d information = Eigen::Matrix3d::Identity();  ///< of match and prior
  };
  /// Away from 0 and 45 degrees, and not a slope of small whole numbers: atan of the golden section.
  static constexpr double kRasterTurn_rad = 0.5536;
  /// Where the best particle went, and how much the odometry is worth at this scan.
  struct Guidance {
    core::Pose2 moved, expected;
    Eigen::Matrix3d information;  ///< of `expected`, in the previous robot's frame
    scanmatch::FieldMatch match;
  };
  static core::Pose2 mapFromRaster() { return {0, 0, -kRasterTurn_rad}; }
  /// A pose of the best particle, raster frame, and the share of the scan that its map explains there.
  struct Start {
    core::Pose2 T_raster_robot;
    double score;
  };
  std::optional<Motion> believed(std::optional<Motion> motion, double time_s);
  void learnWheels(const std::optional<Motion>& motion, const core::Pose2& T_before);
  bool drawsOn();
  void reachFarther(const lidar::Scan& scan);
  void findPlace(const std::vector<scanmatch::SurfacePoint>& points, const std::optional<Motion>& motion);
  bool isNews(const core::Pose2& T_raster_robot) const;
  void matchAll(const std::vector<scanmatch::SurfacePoint>& points, const Guidance& guidance);
  void moveAll(const std::optional<Motion>& motion);
  void insert(const std::vector<lidar::Scan>& others, bool is_matched);
  void drawPose(size_t particle);
  void weigh();
  void resample();
  std::vector<size_t> survivors(const std::vector<double>& weights) const;
  size_t occupiedBins(const std::vector<size_t>& times) const;
  void note(core::JournalEvent event, double value, const std::string& detail = "");
  void findBest();
  void estimateCovariance();
  // guide.cpp: where the best particle goes
  double explainedAt(const core::Pose2& T, const std::vector<scanmatch::SurfacePoint>& points) const;
  double toldAt(const core::Pose2& T, const std::vector<scanmatch::SurfacePoint>& points) const;
  double explainedOfTold(const Start& at, const std::vector<scanmatch::SurfacePoint>& points) const;
  Start bestStart(const Start& predicted, const Motion& expected,
                  const std::vector<scanmatch::SurfacePoint>& points) const;
  Start bestTurn(const Start& predicted, const std::vector<scanmatch::SurfacePoint>& points) const;
  void judgeOdometry(const Start& predicted, const std::vector<scanmatch::SurfacePoint>& points, Start& start,
                     Motion& expected);
  Guidance guide(const std::vector<scanmatch::SurfacePoint>& points, const std::optional<Motion>& motion);
  double explained(const std::vector<scanmatch::SurfacePoint>& points, const Guidance& guidance,
                   bool has_motion) const;
  // loops.cpp: the past that all particles share since the last loop
  void beginPast(bool closes_loops);
  void keepKeyframe(const std::vector<lidar::Scan>& seen, bool is_matched);
  void alignKeyframes(int newest_scan);
  int keyframeOf(size_t scan) const;
  void followLoop(const std::vector<core::Pose2>& poses_before);
  void redrawMap(const std::vector<core::Pose2>& poses_before);
  void trackDrift(const core::Pose2& T_before, const Eigen::Matrix3d& motion_covariance,
                  const Eigen::Matrix3d& prior_information);
  size_t mapBytes() const;

  ParticleFilterOptions options_;
  scanmatch::ScanPointOptions point_options_;
  scanmatch::FieldMatchOptions match_options_;
  std::uint64_t seed_;
  std::uint64_t scans_ = 0, insertions_ = 0;
  double cells_ = 0;
  bool mapping_ = true;
  bool map_is_known_ = false;
  threads::ThreadTeam team_;
  std::vector<Particle> particles_;
  PathTree paths_;
  size_t best_ = 0;
  core::Pose2 T_inserted_, velocity_;
  wheels::WheelCalibration wheels_{wheels::Told::kByEach};
  wheels::Leaps leaps_;
  wheels::Silence silence_;
  wheels::WaySign way_sign_;
  double previous_time_s_ = 0;
  int lost_scans_ = 0;  ///< with returns, since the filter is lost
  double lost_m_ = 0;   ///< driven in them
  bool lost_ = false;
  /// Of the best particle against the map, since the last keyframe.
  Eigen::Matrix3d local_covariance_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d sweep_covariance_ = Eigen::Matrix3d::Zero();  ///< what it was set right by errs by
  ParticleStep step_;
  lidar::Scan scan_;  ///< see lastScan()
  std::vector<core::JournalEntry> journal_;
  /// The path up to the last closed loop, each scan by the keyframe that it hangs on.
  struct PastScan {
    double time_s;
    core::Pose2 T_keyframe_robot;
  };
  std::unique_ptr<loops::TrackedPath> past_;
  std::unique_ptr<Sweeps> sweeps_;  ///< of past_
  std::vector<PastScan> past_scans_;
  /// Every scan's keyframe, -1: none yet, and what its pose errs by beyond that, raster frame.
  struct Drift {
    int keyframe;
    Eigen::Matrix3d covariance;
  };
  std::vector<Drift> drifts_;
  int shared_keyframes_ = 0;  ///< of past_, that all particles have in common since the last loop
  Motion since_keyframe_{{}, Eigen::Matrix3d::Zero()};  ///< by odometry, as far as it was trusted
};

}  // namespace slam::particles

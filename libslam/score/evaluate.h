#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/metrics/map_score.h"
#include "libslam/metrics/map_structure.h"
#include "libslam/metrics/trajectory_error.h"
#include "libslam/resources/manifest.h"
#include "libslam/results/run_folder.h"
#include "libslam/stats/paired.h"
#include "libslam/table/table.h"
#include "libslam/world/plan.h"

namespace slam::score {

/// What is known to be true. The plan and what of it could be seen are only there when a plan was given.
struct Truth {
  core::Trajectory trajectory;
  std::optional<world::Plan> plan;
  std::optional<metrics::SeenMask> seen;
  std::vector<core::Point2> people;  ///< where they were, world frame, when the log was simulated among any
};
/// `lidar_of`: any run on the same log; it says which lidar looked. plan_path may be "".
Truth loadTruth(const std::string& truth_path, const std::string& plan_path,
                const results::RunFolder& lidar_of);

/// How a run is laid onto the truth.
struct Alignment {
  metrics::Align how = metrics::Align::kSe2;
  core::Pose2 T_truth_map;  ///< with kNone: where the map's frame lies in the truth's
};
/// A run that was localised in a known map is not aligned: where it says that the robot is has to be right.
/// Others by SE(2).
Alignment alignmentOf(const resources::Manifest& manifest);
/// Where the frame of the map that a run was localised in lies, by the true path of the run that made the
/// map: its first pose against the truth's. Errors: InputError where that run's folder or path cannot be
/// read, or shares no stamp with the truth.
core::Pose2 mapFrame(const resources::Manifest& manifest, const std::string& map_truth_path);

/// All figures of one run. Without truth the first three blocks are NaN; without plan the map score is.
struct Evaluation {
  metrics::Align align = metrics::Align::kSe2;
  std::string method,
      failure;  ///< failure: why there are no figures, where the robot was lost for good, or ""
  metrics::TrajectoryError trajectory;        ///< of the path given online
  metrics::TrajectoryError final_trajectory;  ///< of the final path: the same where nothing is corrected
  metrics::RelativeError per_metre, per_second;
  metrics::MapScore map;
  double ghost_share;  ///< NaN where no people were
  /// Whether the covariances of the online poses are consistent (poseNees(), stats::consistency()), and those
  /// of the final poses; NaN where there are none.
  double anees, within_50_share, within_95_share, singular_share;
  double anees_final, within_50_share_final, within_95_share_final, singular_share_final;
  /// The same of final poses as others see them: a metre and ten metres of path apart, and at the ends of
  /// loops (results::relativeNees()).
  struct Relative {
    double anees, within_95_share;
  };
  Relative relative_1m, relative_10m, relative_loop;
  results::Cost cost;
  double path_length_m = 0;
  core::Pose2 end_pose;  ///< T_map_robot at the last scan
  double map_mean_entropy_bits;
  metrics::MapStructure structure;
  /// What only the scans can say (SelfScore); NaN where the run was not made by buildMap().
  double mean_map_entropy, wall_thickness_m, on_wall_share, through_wall_share;
  double lost_share;   ///< of the time that the method called itself lost; NaN where it keeps no journal
  double agreement_m;  ///< see setAgreement()
};
/// NEES pose by pose (results::poseNees()) of the online and of the final poses; empty where the run states
/// no covariances.
struct StatedErrors {
  std::vector<double> online, final_poses;
};
StatedErrors statedErrors(const results::RunFolder& run, const Truth& truth, const Alignment& alignment);
Evaluation evaluate(const results::RunFolder& run, const std::optional<Truth>& truth,
                    const std::optional<Alignment>& alignment = std::nullopt);
/// Every figure NaN: the row of a method that failed.
Evaluation failedEvaluation(const std::string& method, const std::string& why);

/// How far from a wall an estimated wall may lie and still count as found.
inline constexpr double kWallTolerance_m = 0.10;

/// What tables show: the figures that fit 80 columns, or all of them (for CSV and JSON).
enum class Detail { kShort, kFull };

/// Accuracy of several runs against the truth: one row each. The same bytes for the same seed.
table::Table accuracyTable(const std::vector<Evaluation>& evaluations, const Truth& truth, Detail detail);
/// What can be said without truth: length, end pose, sharpness of points and map, agreement of the scans with
/// the map and of the method with the others.
table::Table agreementTable(const std::vector<Evaluation>& evaluations, Detail detail);
/// Time and memory; differs from run to run.
table::Table costTable(const std::vector<Evaluation>& evaluations);

/// Sets agreement_m of each: the median over the other runs of the ATE between the two estimates. runs[i]
/// belongs to evaluations[i] where their methods are equal; a failed method has none.
void setAgreement(const std::vector<results::RunFolder>& runs, std::vector<Evaluation>& evaluations);

}  // namespace slam::score

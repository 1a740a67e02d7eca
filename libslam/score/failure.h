#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/results/journal_file.h"
#include "libslam/score/evaluate.h"
#include "libslam/sim/simulator.h"
#include "libslam/table/table.h"

namespace slam::score {

/// What counts as a divergence.
struct FailureLimits {
  double window_s = 5;                                 ///< the local past
  double jump_m = 0.5, jump_rad = core::degToRad(15);  ///< error of the motion over the window
  double drift_m = 1;                                  ///< error of the position, start laid on start
  double wrong_loop_m = 1;  ///< how much farther apart in truth than in the map a loop's places are
  double around_s = 5;      ///< what the journal says so long before and after the divergence counts
  double slip_m = 0.1, slip_rad = core::degToRad(5);  ///< error of the odometry's motion over slip_s
  double slip_s = 1;
  double region_m = 2;  ///< side of the squares that the map is judged by
};

/// Where the estimate left the truth.
struct Divergence {
  /// kJump: the error of the motion over the last window_s (as in relativeErrorOverTime()) exceeds jump_m or
  /// jump_rad. So does an estimate that is put right; so the position's error, start laid on start, must have
  /// grown, by half of jump_m or of the motion's error if that is less, or (where the heading jumps) must not
  /// have shrunk by as much. kDrift: no jump, but the position's error exceeds drift_m.
  enum Kind { kJump, kDrift } kind = kJump;
  double time_s = 0;   ///< since the first pose: of a jump the scan in its window that the error grew most at
  core::Point2 place;  ///< true, world frame
  double error_m = 0, error_rad = 0;  ///< of a jump over the window; of a drift of the pose
};
/// Whichever comes first. Poses outside the truth's time are
/// left out; nullopt where nothing diverges, or fewer than two poses have a truth. Cost: linear in the poses.
std::optional<Divergence> firstDivergence(const core::Trajectory& truth, const core::Trajectory& estimate,
                                          const FailureLimits& limits = {});

/// A loop that was accepted though its two places are not one.
struct WrongLoop {
  int scan = 0, other_scan = 0;
  double time_s = 0;
  core::Point2 place;  ///< of the scan: true, world frame
  double apart_m = 0;  ///< in truth
  double apart_in_map_m = 0;
};
/// Of the journal's lines `accepted`, those whose places are farther apart in truth than in the map (as the
/// path is in the end) by more than wrong_loop_m. scan_stamps_s: by the journal's scans; lines beyond it, or
/// outside the truth's time, are left out.
std::vector<WrongLoop> wrongLoops(const core::Trajectory& truth,
                                  const std::vector<core::JournalLine>& journal,
                                  const std::vector<double>& scan_stamps_s, const FailureLimits& limits = {});

/// The square of the world (sides of region_m, corners at whole multiples of it) with the most wrong wall.
struct WorstRegion {
  core::Point2 centre;
  double missing_wall_m =
      0;  ///< length of true walls that were seen and lie farther than kWallTolerance_m from any mapped one
  double false_wall_m = 0;  ///< the same the other way round
};
/// Wall length is counted in cells times their size. nullopt without any wrong wall.
std::optional<WorstRegion> worstRegion(const world::Plan& plan, const metrics::SeenMask& seen,
                                       const world::CellMap& map, const core::Pose2& T_world_map,
                                       const FailureLimits& limits = {});

/// Where and why a run failed.
struct FailureReport {
  std::optional<Divergence> divergence;
  std::vector<WrongLoop> wrong_loops;  ///< of the whole run
  /// What journal, collisions and odometry say around the divergence, one entry per kind of event in the
  /// order of time: "degenerate 12 times, 83.1 to 85.0 s".
  std::vector<std::string> around;
  /// The gravest of these: kidnapped | false loop closure | collision | slip (the odometry was wrong, or
  /// distrusted) | lost | degenerate | unknown; "" where nothing diverged.
  std::string suspect;
  std::optional<WorstRegion> region;  ///< where a plan is known and something diverged
};
/// What there is to explain it with; what is empty says nothing.
struct FailureEvidence {
  std::vector<core::JournalLine> journal;
  std::vector<sim::Collision> collisions;  ///< of the recording
  std::vector<sim::Carry> carries;         ///< likewise
  core::Trajectory odometry;               ///< dead reckoning from the first scan on
};
FailureReport explainFailure(const results::RunFolder& run, const Truth& truth,
                             const FailureEvidence& evidence, const FailureLimits& limits = {});
/// The run's journal.csv, the collisions and carries beside the truth, and the odometry of the log ("" for
/// none), where they are. Errors: InputError.
FailureEvidence readEvidence(const results::RunFolder& run, const std::string& truth_path,
                             const std::string& log_path);

/// For people and machines: two columns, what and value.
table::Table failureTable(const FailureReport& report, const std::string& method);

/// A report with a divergence as a file, and back. Errors: InputError with the path.
std::string failureJson(const FailureReport& report);
FailureReport readFailure(const std::string& path);

}  // namespace slam::score

#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/posegraph/optimize.h"
#include "libslam/posegraph/pose_graph.h"
#include "libslam/robot/scan.h"
#include "libslam/scanmatch/correlative_search.h"
#include "libslam/scanmatch/surfel_matcher.h"

namespace slam::mapping {

struct GraphSlamOptions {
  scanmatch::ScanPointOptions points;
  double fine_cell_m = 0.1, fine_blur_m = 0.03;
  double middle_cell_m = 0.2, middle_blur_m = 0.05;
  double coarse_cell_m = 0.4, coarse_blur_m = 0.1;
  double kernel = 3, information_scale = 0.2;
  double keyframe_distance_m = 0.3, keyframe_angle_rad = 0.3, keyframe_score = 0.75;
  double map_radius_m = 8, map_reach_m = 30, map_path_m = 25;
  int map_keyframes = 40;
  double odometry_xy_m = 0.02, odometry_xy_per_m = 0.1, odometry_turn_rad = 0.01, odometry_turn_per_rad = 0.2;
  double edge_xy_m = 0.02, edge_xy_per_m = 0.1, edge_turn_rad = 0.01, edge_turn_per_rad = 0.2;
  double odometry_kernel = 2;
  double distrust_gain = 0.1;   ///< another start must explain this much more of the scan
  double recover_score = 0.65;
  int edges_per_keyframe = 8;
  // loops
  bool loops = true;
  double loop_every_m = 0.5, loop_base_m = 1.5, loop_per_m = 0.03, loop_most_m = 25;
  double loop_query_m = 4, loop_cell_m = 0.1;
  double loop_search_score = 0.5, loop_score = 0.6, loop_track_score = 0.6;
  int loop_confirmations = 3;
  double loop_confirm_m = 1.0;
  double link_conflict = 0.2, link_agreed = 0.3;
  double loop_conflict = 0.1;
  double loop_chi2_per_m = 20;
  // end
  bool final_loops = true;
  int refine_rounds = 0;
  bool refine_scans = false;
};

class GraphSlam {
 public:
  explicit GraphSlam(const GraphSlamOptions& options);

  struct Step {
    core::Pose2 T_map_robot;
    double score = 0;
    bool is_keyframe = false, odometry_distrusted = false, recovered = false;
  };
  Step process(const robot::Scan& scan, const core::Pose2& T_previous_robot, bool has_odometry);
  /// Joint refinement of all poses. The poses given so far do not change; trajectory() does.
  void finish();
  /// A pose for every scan so far, corrected by everything known now.
  std::vector<core::Pose2> poses() const;
  size_t keyframeCount() const { return keyframes_.size(); }

  struct Counts {
    int searches = 0, found = 0, confirmed = 0, dropped = 0, optimisations = 0, rejected = 0, recoveries = 0,
        distrusted = 0;
  } counts;
  struct Times {
    double points = 0, match = 0, map = 0, loops = 0, optimise = 0, finish = 0, final_loops = 0;
  } times;
  bool verbose = false;

 private:
  struct Keyframe {
    int scan;
    std::vector<scanmatch::SurfacePoint> points;
    std::vector<float> ranges_m;
    double path_m;
  };
  struct Record {
    int keyframe;
    core::Pose2 T_keyframe_robot;
    std::vector<core::Point2> points;
  };
  struct Hypothesis {
    int first;            ///< keyframe that it began with
    int old_keyframe;     ///< where it leads
    core::Pose2 T_map_first;  ///< the first's pose, seen from the old keyframes' poses
    struct Match {
      int keyframe, old_keyframe;
      core::Pose2 T_old_keyframe;
      Eigen::Matrix3d information;  ///< body frame of `keyframe`
    };
    std::vector<Match> matches;
    int failures = 0;
    double begun_m;
  };
  struct LevelMaps {
    scanmatch::SurfelMap coarse, middle, fine;
    explicit LevelMaps(const GraphSlamOptions& o)
        : coarse(o.coarse_cell_m, o.coarse_blur_m), middle(o.middle_cell_m, o.middle_blur_m), fine(o.fine_cell_m, o.fine_blur_m) {}
  };

  const core::Pose2& poseOf(int keyframe) const { return graph_.pose(keyframe); }
  scanmatch::MatchResult match(const std::vector<scanmatch::SurfacePoint>& points, const LevelMaps& maps,
                               const core::Pose2& T_start, const scanmatch::PosePrior& prior, bool with_coarse) const;
  std::vector<int> keyframesAround(int start, const core::Point2& centre, double path_m, double radius_m) const;
  std::vector<int> localKeyframes(int keyframe) const;
  void rebuildMap(const core::Pose2& T);
  void fill(LevelMaps& maps, const std::vector<int>& keyframes, const core::Point2& centre) const;
  void addKeyframe(const robot::Scan& scan, std::vector<scanmatch::SurfacePoint> points, const core::Pose2& T,
                   const Eigen::Matrix3d& information, bool distrusted);
  void addMatchEdges(int keyframe, const std::vector<int>& others, const core::Pose2& T_matched,
                     const Eigen::Matrix3d& information, int most, posegraph::EdgeKind kind);
  void link(int a, int b);
  std::vector<double> pathTo(int keyframe) const;
  std::optional<Hypothesis> findLoop(int keyframe, int query_first, int query_last);
  void searchLoop();
  void searchRemainingLoops();
  void followHypotheses();
  bool confirm(Hypothesis& hypothesis, int keyframe);
  bool accept(const Hypothesis& hypothesis);
  double optimiseGraph();
  struct View {
    int agreed = 0, passed = 0, points = 0;
    double conflict() const { return agreed + passed == 0 ? 0 : static_cast<double>(passed) / (agreed + passed); }
  };
  View view(int viewer, const core::Pose2& T_viewer_points, const std::vector<scanmatch::SurfacePoint>& points) const;

  GraphSlamOptions o_;
  posegraph::PoseGraph graph_;
  std::vector<Keyframe> keyframes_;
  struct Link {
    int to;
    double length_m;
  };
  std::vector<std::vector<Link>> neighbours_;
  std::vector<Record> records_;
  LevelMaps maps_;
  std::vector<int> map_keyframes_;
  robot::Scan geometry_;
  core::Pose2 T_keyframe_robot_, velocity_, T_odom_since_keyframe_;
  double path_m_ = 0, last_loop_m_ = 0, last_search_m_ = -1e9;
  bool distrusted_since_keyframe_ = false;
  std::vector<Hypothesis> hypotheses_;
  std::vector<std::pair<int, int>> closures_;
  // Scratch of keyframesAround().
  mutable std::vector<double> reached_;
  mutable std::vector<int> touched_;
  mutable std::vector<std::pair<double, int>> queue_;
  std::unordered_map<std::int64_t, std::vector<int>> places_;
};

}  // namespace slam::mapping

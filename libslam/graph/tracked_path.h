#pragma once
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "libslam/core/journal.h"
#include "libslam/core/pose2.h"
#include "libslam/graph/graph_options.h"
#include "libslam/robot/scan.h"

namespace slam::graph {

class KeyframeMap;
class LoopCloser;

/// The past of a robot that something else tracks, a particle filter say, as keyframes of a pose graph. Its
/// loops are looked for, followed, judged and closed as GraphSlam's are: the keyframes move, and whoever
/// tracks the robot has to follow them.
///
/// Keyframes are numbered from 0. Frames: map is any that the tracker keeps to; the first keyframe stays.
/// Journal: `searched`, `found`, `dropped`, `confirmed`, `rejected`, `accepted` and `optimised`, as
/// GraphSlam's. Cost: some 10 kB a keyframe; a search now and then, some milliseconds; when a loop is closed,
/// all poses anew.
class TrackedPath {
 public:
  explicit TrackedPath(const GraphOptions& options);
  ~TrackedPath();

  /// What is known of a keyframe's pose when it comes.
  struct Placed {
    core::Pose2 T_map_robot;
    core::Pose2 T_before_robot;           ///< since the keyframe before, by odometry
    Eigen::Matrix3d odometry_covariance;  ///< of that; in the frame of the keyframe before
    Eigen::Matrix3d match_information;    ///< of its match to the map, map frame; zero: it was not matched
    int hangs_on = -1;                    ///< the keyframe whose error it shares; -1: the first
    Eigen::Matrix3d covariance_since;     ///< of what it errs by beyond that, map frame
    Eigen::Matrix3d covariance;           ///< of its pose in the map
  };
  /// The next scan; it was taken so far from the one before. Journal entries refer to scans, counted from 0.
  void nextScan(double moved_m);
  /// Of all lidars at this scan, the first one's beams judge loops. True when a loop was closed, and the
  /// keyframes have moved. REQUIRES finite numbers, and nextScan() before (ContractError).
  bool addKeyframe(const std::vector<robot::Scan>& seen, const Placed& placed);
  /// Loops that are found with all of the path known. True when the keyframes have moved.
  bool finish();

  int size() const;
  int scan(int keyframe) const;
  const core::Pose2& pose(int keyframe) const;
  const Eigen::Matrix3d& covariance(int keyframe) const;  ///< map frame
  std::vector<core::Pose2> poses() const;
  /// The tracker has changed its mind: what was matched to other keyframes was matched from here. For
  /// keyframes since the last loop.
  void setPose(int keyframe, const core::Pose2& T_map_robot);
  const std::vector<core::JournalEntry>& journal() const;

 private:
  void addOdometryEdge(int keyframe, const Placed& placed);
  void addMatchEdges(int keyframe, const Placed& placed);

  std::unique_ptr<KeyframeMap> map_;
  std::unique_ptr<LoopCloser> loops_;
  bool has_begun_ = false;
};

}  // namespace slam::graph

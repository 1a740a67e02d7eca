#pragma once
#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "libslam/core/journal.h"
#include "libslam/core/pose2.h"
#include "libslam/keyframes/graph_options.h"
#include "libslam/lidar/scan.h"
#include "libslam/scanmatch/surfel_map.h"
#include "libslam/scanmatch/surfel_matcher.h"

namespace slam::keyframes {
class KeyframeMap;
struct Keyframe;
}  // namespace slam::keyframes
namespace slam::uncertainty {
struct HungScan;
}  // namespace slam::uncertainty

namespace slam::loops {

class LoopCloser;

/// The past of a robot that something else tracks, a particle filter say, as keyframes of a pose graph. Its
/// loops are looked for, followed, judged and closed as GraphSlam's are: the keyframes move, and whoever
/// tracks the robot has to follow them.
///
/// Keyframes are numbered from 0. Frames: map is any that the tracker keeps to; the first keyframe stays.
/// Journal: `searched`, `found`, `dropped`, `confirmed`, `rejected`, `accepted` and `optimised`, as
/// GraphSlam's. Cost: some 10 kB a keyframe, of which there are the more the larger the area is; a search now
/// and then, some milliseconds; when a loop is closed, all poses anew, at once.
class TrackedPath {
 public:
  explicit TrackedPath(const keyframes::GraphOptions& options);
  ~TrackedPath();

  /// Where a keyframe is when it comes.
  struct Placed {
    core::Pose2 T_map_robot;
    core::Pose2 T_before_robot;           ///< since the last call, by odometry
    Eigen::Matrix3d odometry_covariance;  ///< of that, in the frame of the robot before; positive definite
    bool is_matched;                      ///< to what the keyframes around it have drawn
    bool is_explained;                    ///< they explain it
    std::optional<core::Point2> open;     ///< unit vector in the map: the match said nothing along it
    std::optional<Eigen::Matrix3d> noise = {};  ///< of the pose against the map, where more than matches tell
  };
  /// The next scan; it was taken so far from the one before. Journal entries refer to scans, counted from 0.
  void nextScan(double moved_m);
  /// A keyframe of what all lidars see at this scan, of which the first one's beams judge loops; or, where
  /// enough keyframes see the same, none: the path goes on from the nearest of them. True when a loop was
  /// closed, and the keyframes have moved. REQUIRES finite numbers, and nextScan() before (ContractError).
  bool addKeyframe(const std::vector<lidar::Scan>& seen, const Placed& placed);
  /// Loops that are found with all of the path known. True when the keyframes have moved.
  bool finish();

  int size() const;
  /// The keyframe that the path goes on from; -1: there is none yet.
  int anchor() const { return anchor_; }
  int scan(int keyframe) const;  ///< at which it came
  const core::Pose2& pose(int keyframe) const;
  /// Of its pose in the map, map frame, as it was known when it came or when the last loop was closed.
  Eigen::Matrix3d covariance(int keyframe) const;
  std::vector<core::Pose2> poses() const;
  /// Of all poses, by all that is known now.
  std::vector<Eigen::Matrix3d> covariances() const;
  /// How sure scans that hang on keyframes are of one another, see uncertainty::RelativeError: of each pair's
  /// second one in the frame of the first. REQUIRES a keyframe, or no pair.
  std::vector<Eigen::Matrix3d> relativeCovariances(
      const std::vector<std::pair<uncertainty::HungScan, uncertainty::HungScan>>& scans) const;
  /// By all lidars.
  std::vector<lidar::Scan> seen(int keyframe) const;
  /// The tracker has changed its mind: what was matched to other keyframes was matched from here. For
  /// keyframes since the last loop.
  void setPose(int keyframe, const core::Pose2& T_map_robot);
  const std::vector<core::JournalEntry>& journal() const;
  /// What the keyframes have seen; for the rooms of SLAM methods only.
  const keyframes::KeyframeMap& map() const { return *map_; }

 private:
  scanmatch::MatchEvidence evidenceFrom(const std::vector<int>& near,
                                        const std::vector<scanmatch::PatchPoint>& points,
                                        const Placed& placed);
  bool isKnownGround(const lidar::Scan& scan, const core::Pose2& T_map_robot,
                     const std::vector<int>& near) const;
  void insert(const std::vector<lidar::Scan>& seen, const Placed& placed, const std::vector<int>& near);
  void follow(const scanmatch::MatchEvidence& evidence, const Placed& placed, keyframes::Keyframe& next);
  void addOdometryEdge(int keyframe, const Placed& placed);

  std::unique_ptr<keyframes::KeyframeMap> map_;
  std::unique_ptr<LoopCloser> loops_;
  std::map<int, std::vector<lidar::Scan>> others_;  ///< what other lidars than the first saw
  scanmatch::SurfelMap here_;                       ///< of the keyframes around the newest one
  int anchor_ = -1;
  core::Pose2 T_anchor_robot_;  ///< at the last call
  bool has_begun_ = false;
};

}  // namespace slam::loops

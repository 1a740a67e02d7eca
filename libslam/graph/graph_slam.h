#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libslam/core/journal.h"
#include "libslam/core/pose2.h"
#include "libslam/core/progress.h"
#include "libslam/graph/known_ground.h"
#include "libslam/graph/lost_detector.h"
#include "libslam/keyframes/graph_options.h"
#include "libslam/keyframes/keyframe_map.h"
#include "libslam/keyframes/types.h"
#include "libslam/lidar/scan.h"
#include "libslam/loops/loop_closer.h"
#include "libslam/loops/part_finder.h"
#include "libslam/loops/part_place.h"
#include "libslam/posegraph/pose_graph.h"
#include "libslam/tracking/pose_uncertainty.h"
#include "libslam/tracking/tracker.h"

namespace slam::graph {

/// Graph SLAM with a planar lidar: every scan is matched to the keyframes around it, keyframes are tied to
/// those that they share a view with, and places that are seen again are recognised. Map frame: the robot's
/// pose at the first scan.
///
/// Every scan: the surfel map of the keyframes near the robot is matched from the best of several starts
/// (odometry, the last motion, odometry with its metres backwards, turned a little); odometry holds the match
/// as a robust prior, and is let go where another start explains so much more of the scan that its error, of
/// which long tails are expected, is the likelier. Until scans are explained again, where odometry has the
/// robot remains one of the starts, and no scan is matched to keyframes made since. A match that explains too
/// little is searched for on a lattice.
/// The keyframes near are those that chains of links of `map_path_m` reach, so that a place seen again is not
/// mixed in before its loop is closed.
/// Every keyframe gets edges to the keyframes it was matched to, weighed with the match's information,
/// provided that their beams agree with its points; and a weak one from odometry. Those of an earlier pass
/// through the place are matched by themselves: an edge says what was measured between its ends.
/// Loops: the last metres of the path are searched for, by branch and bound, around every place that drift
/// could have carried apart, a piece with every scan (`loop_work`); what is found is followed for some
/// keyframes, each of which must fit the old map by itself, and accepted together, unless the way between
/// rules it out or another place is nearly as good. All poses are then found anew, a piece with every scan,
/// too; until they are, the robot is tracked in the map as it was.
///
/// A scan that was deskewed is skewed by what odometry errs by: pose and step are found together, and the
/// scan is set right (tracking::Tracker::unskew()).
///
/// Without odometry the last motion stands in for it, as long as the step takes. Where there is no odometry,
/// or it is contradicted, the motion that two scans alone give (odometry::ScanOdometry, correlation) is one
/// of the starts, too; without odometry every place that the robot may have come to is, with its heading.
/// Leaps that no robot drives are no odometry (wheels::Leaps), nor are wheels that have never moved
/// (wheels::Silence). Odometry's noise grows with the root of time, with the metres and with the angle; how
/// long its metres are, how it turns where the robot does not and how far its turns scatter is learnt while
/// driving (wheels::WheelCalibration), and whether it tells forwards from backwards (wheels::WaySign). Steps
/// are timed by the mean of the stamps of late. Each of several lidars is known by its mounting.
///
/// The kidnapped robot (see LostDetector): a scan that breaks with the one before and contradicts the map is
/// held back for half a second. If that goes on, the robot maps on by itself, while it is still tracked in
/// the map from before. Either that map explains the scans again, and goes on; or the evidence decides (by
/// less where the robot leaves what is known first, or no more scans come), and a new part of the map begins
/// where the doubt began.
/// A part is searched for all over the rest, one place and heading at a time; places that may be right are
/// followed along the whole part, forth and back, a few steps per scan. It is joined at the best of them,
/// once all of the map was looked at, and all other places that might hold it are behind, being contradicted
/// or explaining less. Or it was no kidnapping: near where odometry has the robot the part is searched for as
/// loops are, and joined like one. Any number of parts may be open. In a finished map the robot is found as
/// in any other part.
///
/// The two faces of a thin wall are kept apart in the finest map (scanmatch::SurfelMap), so that rooms on
/// both sides do not pull it into its middle.
///
/// Ground that `known_views` keyframes see from nearby gets no more of them: the robot hangs on those that
/// are there; cost grows with the area, not with the years. What has stood somewhere for a while makes a
/// keyframe, in place of the oldest there; what has gone is taken out.
///
/// Journal: core::journalEventInfos().
/// Deterministic: the same scans give the same bytes. Cost and memory: benchmarks/results/relations_ours.txt,
/// scaling.txt.
/// Sources: Biber and Strasser, IROS 2003 (surfels); Olson, ICRA 2009, and Hess et al., ICRA 2016 (search);
/// Grisetti et al., IEEE ITS Magazine 2(4), 2010 (graph). Following a loop before closing it, links by common
/// view, and the choice among starts are ours.
class GraphSlam {
 public:
  explicit GraphSlam(const keyframes::GraphOptions& options);
  /// 2 or more: loops are searched for, and poses found anew, by another thread while scans are tracked.
  /// Poses, map and journal are the same, to the byte.
  void useThreads(int threads);
  /// CPU time of the other thread, so far.
  double threadSeconds() const { return loops_.threadSeconds(); }

  struct Step {
    core::Pose2 T_map_robot;
    /// Map frame: x, y (m), phi (rad). Of the pose in the map; and against the keyframe that it hangs on.
    Eigen::Matrix3d pose_covariance = Eigen::Matrix3d::Zero(), drift_covariance = Eigen::Matrix3d::Zero();
    double score = 1;  ///< share of the scan that the map explains
    bool is_keyframe = false;
  };
  /// REQUIRES at least 2 beams. T_previous_robot is read when has_odometry.
  Step process(const lidar::Scan& scan, const core::Pose2& T_previous_robot, bool has_odometry);
  /// The same without changing the map: where the robot is in what is known. REQUIRES a keyframe.
  Step localise(const lidar::Scan& scan, const core::Pose2& T_previous_robot, bool has_odometry);

  /// Looks for the loops that are left, now that the whole path is known, sets all odometry right by what the
  /// drive has shown of the wheels, finds all poses anew by what later passes through a place measured, and
  /// refines them jointly (`refine_rounds`). What process() gave stays;
  /// poses() changes. Errors: what `progress` throws; the map is whole then, with the loops found so far.
  void finish(core::Progress& progress = core::silentProgress());

  /// One per process(), as everything known now has it.
  std::vector<core::Pose2> poses() const;
  /// How sure poses() are: one each, map frame.
  std::vector<Eigen::Matrix3d> covariances() const;
  /// How sure they are of one another: of x (m), y (m), phi (rad) of the second pose in the first one's
  /// frame, for pairs of scans, counted as poses() are. What two scans that hang on one keyframe err by is
  /// taken as independent. Cost: that of covariances(), and two chains of the elimination tree for each pair.
  std::vector<Eigen::Matrix3d> relativeCovariances(const std::vector<std::pair<int, int>>& scans) const;

  /// Without beams where all that it saw was seen anew since.
  const lidar::Scan& keyframeScan(int keyframe) const { return map_->keyframe(keyframe).seen; }
  int keyframeCount() const { return map_->size(); }
  const core::Pose2& keyframePose(int keyframe) const { return map_->pose(keyframe); }
  /// Grows when keyframes that were there before have moved.
  int revision() const { return map_->revision(); }
  const posegraph::PoseGraph& graph() const { return map_->graph(); }
  const std::vector<core::JournalEntry>& journal() const { return map_->journal(); }

  /// A keyframe of a map that is continued, at a known pose, tied to the one before. Before the first scan
  /// only.
  void addKnownKeyframe(const lidar::Scan& scan, const core::Pose2& T_map_robot);
  /// The known keyframes to come are those of a map of its own, in its own frame: nobody knows where it lies
  /// in what was known before. REQUIRES a keyframe, and no scan.
  void beginKnownPart();
  /// Looks for the place of every known part in the rest of the map: held against all of the part, unlike
  /// those of a kidnapped robot. Then for the loops that are left, and refines all poses jointly. One for
  /// each beginKnownPart(); a part of which no place is proved stays far away. REQUIRES options.loops, a
  /// keyframe in each part. Errors: what `progress` throws.
  std::vector<loops::PartPlace> joinParts(core::Progress& progress);
  /// Where the robot is now in what is known: after known keyframes, or wherever it was put. Nothing is taken
  /// as measured between there and where it was before. REQUIRES a keyframe.
  void startAt(const core::Pose2& T_map_robot);
  /// The same where nobody knows: it is lost until it is found. For localise().
  void startAnywhere();

 private:
  using Points = std::vector<scanmatch::PatchPoint>;
  // graph_slam.cpp: keyframes and their edges
  void addKeyframe(const lidar::Scan& scan, Points points, const core::Pose2& T_map_robot,
                   const Eigen::Matrix3d& information);
  int addOdometryEdge(int keyframe);
  void setOdometryRight();
  core::Pose2 currentPose() const;
  // passes.cpp: what a keyframe measures of others
  void addMatchEdges(int keyframe, const core::Pose2& T_map_robot, const Eigen::Matrix3d& information);
  std::optional<scanmatch::MatchResult> matchToPass(int keyframe, const std::vector<int>& pass,
                                                    const core::Pose2& T_map_robot);
  // next_keyframe.cpp: which scan becomes one
  bool needsKeyframe(const lidar::Scan& scan, const Points& points, const Step& step);
  bool isKnownGround(const lidar::Scan& scan, const core::Pose2& T_map_robot) const;
  bool hasGoneOn(double share) const;
  void hangOn(int keyframe, const core::Pose2& T_map_robot);

  // track.cpp: a scan and the map around
  Step track(lidar::Scan& scan, const core::Pose2& T_previous_robot, bool has_odometry, Points& points,
             Eigen::Matrix3d& information);
  void learnWheels(const tracking::Expected& expected, const core::Pose2& T_previous_matched,
                   const Eigen::Matrix3d& information, const Eigen::Matrix3d& posterior_information,
                   bool is_believed);
  void keepTo(const core::Pose2& predicted, const core::Pose2& increment, Step& step);
  void setMapHere();
  tracking::Motion& motion() { return tracker_.motion(); }
  const tracking::Motion& motion() const { return tracker_.motion(); }
  tracking::LocalMap& around() { return tracker_.around(); }
  const tracking::LocalMap& around() const { return tracker_.around(); }

  // doubt.cpp: whether the robot was kidnapped
  keyframes::Break breakBefore(const lidar::Scan& scan, const Points& points, const core::Pose2& T_before,
                               const core::Pose2& T_previous_robot, const core::Pose2& T_previous_matched,
                               bool has_odometry) const;
  keyframes::Told trackBefore(const lidar::Scan& scan, const Points& points, const core::Pose2& increment,
                              bool has_odometry, double& explained);
  void comeBack(const lidar::Scan& scan, Points points, Step& step);
  void lookWhetherLost(const lidar::Scan& scan, const Points& points, const Step& step,
                       const core::Pose2& increment, double broken, bool has_odometry);
  void learnWrongPlace(const lidar::Scan& scan, const Points& points, const core::Pose2& T_map_robot);
  std::vector<int> keyframesBeforeDoubt(const core::Pose2& T_map_robot) const;
  bool isKnownBefore(std::size_t points) const;
  keyframes::Trust weighDoubt(const core::Pose2& T_before, const keyframes::Break& seam, std::size_t points,
                              Step& step);
  void beginOwnMap();
  void endDoubt();
  void settleDoubt();
  void startElsewhere(double score);
  void loosen(int keyframe);
  void moveHeldBackTo(int keyframe);

  // parts.cpp: loops, and parts of the map that have no known place in one another
  void noteLoop(const loops::LoopCloser::Accepted& loop);
  void haveMoved();
  void completeClosing();
  void beginPart(int keyframe);
  void lookForPart(int first, int last);
  void joinRemainingParts();
  void noteWhatStaysApart();

  // known_parts.cpp: maps of before whose places in one another are not known
  void putApart();
  void judge(size_t part, loops::PartPlace& place) const;
  int endOfPart(size_t part) const;

  // localise.cpp: in a finished map
  bool searchWhileLost(const Points& points, Step& step);
  void beginLocalising();
  void beLost(double score);
  bool fitsMap(const Points& points, const core::Pose2& T_map_robot) const;

  // refine.cpp
  void refine(core::Progress& progress);
  bool isRefined() const { return refined_ == std::pair(map_->size(), map_->revision()); }

  keyframes::GraphOptions options_;
  std::unique_ptr<keyframes::KeyframeMap>
      map_;  ///< stays where it is when this is moved: those below look at it
  loops::LoopCloser loops_;
  loops::PartFinder finder_;
  std::deque<keyframes::Record> records_;  // grows without a copy of all
  tracking::Tracker tracker_;
  tracking::PoseUncertainty uncertainty_;
  KnownGround known_ground_;
  int anchor_ = 0;  ///< the keyframe that the robot hangs on: the last, or one of known ground
  core::Pose2 T_keyframe_robot_;
  core::Pose2 T_keyframe_hung_, T_odometry_;  ///< when it was hung on it; by odometry since then
  core::Pose2 T_wheels_;                      ///< since then, as odometry said it
  bool odometry_holds_ = true;                ///< since then
  /// A way between keyframes of which all is odometry's since the robot was hung on the first.
  struct ByWheels {
    int edge;
    core::Pose2 T_keyframe_hung, T_wheels;
  };
  std::vector<ByWheels> by_wheels_;
  bool is_known_ground_ = false;  ///< under the scan at hand
  LostDetector lost_;
  keyframes::Doubt doubt_;
  int explained_here_ = 0;  ///< scans, by the map of the part, since a doubt by that which was made meanwhile
  int held_back_ = 0;       ///< scans in a row that were not believed
  std::vector<keyframes::KnownPart> known_parts_;  ///< those after the first
  int wrong_places_ = 0;                           ///< that were learnt from
  /// In a finished map.
  bool is_localising_ = false, is_lost_ = false, is_outside_ = false;
  std::pair<int, int> refined_{0, 0};  ///< keyframes and revision of the map that refine() left
};

}  // namespace slam::graph

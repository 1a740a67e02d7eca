#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libslam/core/journal.h"
#include "libslam/core/pose2.h"
#include "libslam/core/progress.h"
#include "libslam/graph/change_marks.h"
#include "libslam/graph/graph_options.h"
#include "libslam/graph/links.h"
#include "libslam/graph/loop_judge.h"
#include "libslam/graph/lost_detector.h"
#include "libslam/graph/part_place.h"
#include "libslam/graph/types.h"
#include "libslam/posegraph/pose_graph.h"
#include "libslam/robot/scan.h"
#include "libslam/scanmatch/correlative_search.h"
#include "libslam/scanmatch/information.h"
#include "libslam/scanmatch/surfel_matcher.h"

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
/// could have carried apart; what is found is followed for some keyframes, each of which must fit the old map
/// by itself, and accepted together, unless the way between rules it out or another place is nearly as good.
///
/// Without odometry the last motion stands in for it, as long as the step takes. Where there is no odometry,
/// or it is contradicted, the motion that two scans alone give (odometry::ScanOdometry, correlation) is one
/// of the starts, too. Odometry's noise grows with the root of time, with the metres and with the angle.
/// Steps are timed by the mean of the stamps of late. Each of several lidars is known by its mounting.
///
/// The kidnapped robot (see LostDetector): a scan that breaks with the one before and contradicts the map is
/// held back for half a second. If that goes on, the robot maps on by itself, while it is still tracked in
/// the map from before. Either that map explains the scans again, and goes on; or the evidence decides, and a
/// new part of the map begins where the doubt began. A part is searched for all over the rest, one place and
/// heading at a time; places that may be right are followed along the whole part, forth and back, a few steps
/// per scan. It is joined at the best of them, once all of the map was looked at and no other place is nearly
/// as good. Or it was no kidnapping: near where odometry has the robot the part is searched for as loops are,
/// and joined like one. Any number of parts may be open. In a finished map the robot is found as in any other
/// part.
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
  explicit GraphSlam(const GraphOptions& options);

  struct Step {
    core::Pose2 T_map_robot;
    /// Map frame: x, y (m), phi (rad). Of the pose in the map; and against the keyframe that it hangs on.
    Eigen::Matrix3d pose_covariance = Eigen::Matrix3d::Zero(), drift_covariance = Eigen::Matrix3d::Zero();
    double score = 1;  ///< share of the scan that the map explains
    bool is_keyframe = false;
  };
  /// REQUIRES at least 2 beams. T_previous_robot is read when has_odometry.
  Step process(const robot::Scan& scan, const core::Pose2& T_previous_robot, bool has_odometry);
  /// The same without changing the map: where the robot is in what is known. REQUIRES a keyframe.
  Step localise(const robot::Scan& scan, const core::Pose2& T_previous_robot, bool has_odometry);

  /// Looks for the loops that are left, now that the whole path is known, and refines all poses jointly
  /// (`refine_rounds`). What process() gave stays; poses() changes.
  void finish();

  /// One per process(), as everything known now has it.
  std::vector<core::Pose2> poses() const;
  /// How sure poses() are: one each, map frame.
  std::vector<Eigen::Matrix3d> covariances() const;

  /// Without beams where all that it saw was seen anew since.
  const robot::Scan& keyframeScan(int keyframe) const {
    return keyframes_[static_cast<size_t>(keyframe)].seen;
  }
  int keyframeCount() const { return graph_.nodeCount(); }
  const core::Pose2& keyframePose(int keyframe) const { return graph_.pose(keyframe); }
  /// Grows when keyframes that were there before have moved.
  int revision() const { return revision_; }
  const posegraph::PoseGraph& graph() const { return graph_; }
  const std::vector<core::JournalEntry>& journal() const { return journal_; }

  /// A keyframe of a map that is continued, at a known pose, tied to the one before. Before the first scan
  /// only.
  void addKnownKeyframe(const robot::Scan& scan, const core::Pose2& T_map_robot);
  /// The known keyframes to come are those of a map of its own, in its own frame: nobody knows where it lies
  /// in what was known before. REQUIRES a keyframe, and no scan.
  void beginKnownPart();
  /// Looks for the place of every known part in the rest of the map: held against all of the part, unlike
  /// those of a kidnapped robot. Then for the loops that are left, and refines all poses jointly. One for
  /// each beginKnownPart(); a part of which no place is proved stays far away. REQUIRES options.loops, a
  /// keyframe in each part. Errors: what `progress` throws.
  std::vector<PartPlace> joinParts(core::Progress& progress);
  /// Where the robot is now in what is known: after known keyframes, or wherever it was put. Nothing is taken
  /// as measured between there and where it was before. REQUIRES a keyframe.
  void startAt(const core::Pose2& T_map_robot);
  /// The same where nobody knows: it is lost until it is found. For localise().
  void startAnywhere();

 private:
  using Points = std::vector<scanmatch::PatchPoint>;
  /// In standard deviations of a surfel: farther points hardly count.
  static constexpr double kKernel = 3;
  /// Poses are compared on every third point.
  static constexpr int kStride = 3;
  /// Keyframes that are asked what of a scan they should have seen.
  static constexpr int kAskedViewers = 4;
  static constexpr int kNoComponent = -1, kAnyComponent = -2;

  // graph_slam.cpp: keyframes and their edges
  void addKeyframe(const robot::Scan& scan, Points points, const core::Pose2& T_map_robot,
                   const Eigen::Matrix3d& information);
  void addMatchEdges(int keyframe, const core::Pose2& T_map_robot, const Eigen::Matrix3d& information);
  std::optional<scanmatch::MatchResult> matchToPass(int keyframe, const std::vector<int>& pass,
                                                    const core::Pose2& T_map_robot);
  int addOdometryEdge(int keyframe);
  std::vector<int> partnersOf(int keyframe, const std::vector<int>& near,
                              const core::Pose2& T_map_robot) const;
  static bool isApart(int keyframe, const std::vector<int>& others);
  void link(int a, int b);
  void note(core::JournalEvent event, double value, int other_keyframe = -1, const std::string& detail = "");
  core::Pose2 currentPose() const;
  const Keyframe& keyframe(int k) const { return keyframes_[static_cast<size_t>(k)]; }
  // known_ground.cpp: where no more keyframes are needed
  bool needsKeyframe(const robot::Scan& scan, const Points& points, const Step& step);
  bool isKnownGround(const robot::Scan& scan, const core::Pose2& T_map_robot) const;
  bool hasGoneOn(double share) const;
  void hangOn(int keyframe, const core::Pose2& T_map_robot);
  int keyframeBefore(int keyframe) const;
  bool hasChanged(const robot::Scan& scan, const Points& points, const core::Pose2& T_map_robot);
  void forgetGone(const robot::Scan& scan, const core::Pose2& T_map_robot);
  void retireOldest(int keyframe);
  bool mayBeMatchedTo(int k) const { return !keyframe(k).unsure && !keyframe(k).is_retired; }

  int lastKeyframe() const { return static_cast<int>(keyframes_.size()) - 1; }

  // motion.cpp: what is known of a step before it is matched
  void noteScan(const robot::Scan& scan, bool has_odometry);
  void keepScan(const robot::Scan& scan);
  const Seen* before() const;
  Prediction predict(const core::Pose2& T_previous_robot, bool has_odometry) const;
  std::optional<core::Pose2> motionFromScans(const robot::Scan& scan) const;

  // track.cpp: a scan and the map around
  static scanmatch::MatchOptions matchOptions(int max_iterations);
  Step track(const robot::Scan& scan, const core::Pose2& T_previous_robot, bool has_odometry, Points& points,
             Eigen::Matrix3d& information);
  Expected expect(const core::Pose2& T_previous_robot, bool has_odometry) const;
  Start bestStart(const robot::Scan& scan, const Points& points, const Expected& expected) const;
  double unlikely(const core::Pose2& T_map_robot, const Expected& expected) const;
  double brokenAt(const core::Pose2& T_map_robot, const Points& points, const Expected& expected) const;
  bool isBetter(const scanmatch::MatchResult& other, const scanmatch::MatchResult& than, double least_gain,
                const Points& points, const Expected& expected) const;
  bool isPoor(const scanmatch::MatchResult& result, const Points& points) const;
  std::pair<scanmatch::MatchResult, bool> bestMatch(const robot::Scan& scan, const Points& points,
                                                    const Expected& expected);
  Points pointsOf(const robot::Scan& scan) const;
  scanmatch::MatchResult match(const Points& points, const LevelMaps& maps, const core::Pose2& T_start,
                               const scanmatch::PosePrior& prior, double prior_kernel,
                               bool with_coarse) const;
  scanmatch::MatchResult matchFreely(const Points& points, const std::vector<int>& keyframes,
                                     const core::Pose2& T_start, bool with_coarse = false) const;
  const LevelMaps& mapOf(const std::vector<int>& keyframes, const core::Point2& centre) const;
  std::optional<scanmatch::MatchResult> recover(const Points& points, const core::Pose2& predicted,
                                                const core::Pose2& matched) const;
  void fill(LevelMaps& maps, const std::vector<int>& keyframes, const core::Point2& centre) const;
  std::vector<int> keyframesAround(int start, const core::Point2& centre, double path_m,
                                   double radius_m) const;
  std::vector<int> keyframesWithin(const core::Point2& centre, double radius_m) const;
  static std::vector<int> firstOf(std::vector<int> keyframes, int most);
  void setMap(const std::vector<int>& near, const core::Point2& centre);
  void setMapHere();
  void setMapNear(const core::Point2& centre);
  double knownShare(const Points& points, const core::Pose2& T_map_robot) const;
  void followWheels(const core::Pose2& T_wheels, bool let_go, bool is_elsewhere, bool is_explained);
  void forgetWheels();
  void keepTo(const core::Pose2& predicted, const core::Pose2& increment, Step& step);

  // views.cpp: what keyframes' beams say of other scans
  static Sight sight(const robot::Scan& seen, const core::Point2& p_lidar);
  Sight sight(int viewer, const core::Point2& p_lidar) const;
  std::vector<core::Pose2> lidarsOf(const std::vector<int>& viewers) const;
  static View view(const robot::Scan& scan, const core::Pose2& T_viewer_points, const Points& points,
                   size_t stride = 1);
  View view(int viewer, const core::Pose2& T_viewer_points, const Points& points) const;
  double meanConflict(const std::vector<int>& viewers, const core::Pose2& T_map_points,
                      const Points& points) const;
  double toldScore(const Points& points, const core::Pose2& T_map_robot) const;
  double gain(const Points& points, const core::Pose2& T_map_robot, const core::Pose2& T_map_other) const;

  // doubt.cpp: whether the robot was kidnapped
  double brokenBy(const Points& points, const core::Pose2& T_previous_robot) const;
  Break breakBefore(const robot::Scan& scan, const Points& points, const core::Pose2& T_previous_robot,
                    const core::Pose2& T_previous_matched, bool has_odometry) const;
  Told toldBy(const std::vector<int>& viewers, const Points& points, const core::Pose2& T_map_robot,
              const robot::Scan* scan = nullptr) const;
  Told trackBefore(const robot::Scan& scan, const Points& points, const core::Pose2& increment,
                   double& explained);
  void comeBack(const robot::Scan& scan, Points points, Step& step);
  void lookWhetherLost(const robot::Scan& scan, const Points& points, const Step& step,
                       const core::Pose2& increment, double broken);
  void learnWrongPlace(const robot::Scan& scan, const Points& points, const core::Pose2& T_map_robot);
  std::vector<int> keyframesBeforeDoubt(const core::Pose2& T_map_robot) const;
  Trust weighDoubt(const core::Pose2& T_before, const Break& seam, Step& step);
  void beginOwnMap();
  void endDoubt();
  void startElsewhere(double score);
  void loosen(int keyframe);
  void moveHeldBackTo(int keyframe);

  // covariance.cpp
  std::vector<Eigen::Matrix3d> keyframeCovariances() const;
  posegraph::PoseGraph witnesses() const;
  void noteEvidence(const Points& points, const core::Pose2& T_map_robot, const scanmatch::SurfelMap& map);
  void noteMatch();
  void estimateCovariance(const Expected& expected, const scanmatch::MatchResult& result);
  Eigen::Matrix3d driftSinceKeyframe() const;

  // loops.cpp: places seen again
  void closeLoops();
  void searchRemainingLoops(int first_searched);
  int gapsBetween(int a, int b) const;
  void confirm(Hypothesis& hypothesis, int keyframe) const;
  void addLoopEdges(std::vector<posegraph::Edge>& edges, const std::vector<int>& around, int keyframe,
                    const scanmatch::MatchResult& matched) const;
  void follow(Hypothesis& found);
  static double distinctness(const Points& points, const LevelMaps& maps,
                             const scanmatch::MatchResult& matched);
  bool accept(const Hypothesis& hypothesis, LoopJudge& judge);
  bool isAllowed(const Hypothesis& hypothesis, LoopJudge& judge);
  void settle();
  std::vector<core::Point2> placeAround(const std::vector<int>& keyframes) const;

  // find_loop.cpp: where a place was seen before
  LoopSearch loopSearch(int keyframe) const;
  void gatherQuery(LoopSearch& search, int first, int last) const;
  double loopReach(const LoopSearch& search, int old) const;
  std::vector<int> loopCandidates(const LoopSearch& search) const;
  std::vector<Hypothesis> findLoop(int keyframe, int query_first, int query_last);
  std::vector<Hypothesis> loopsAt(const LoopSearch& search, int old);
  std::optional<Hypothesis> loopFrom(const LoopSearch& search, int old, const std::vector<int>& around,
                                     const core::Pose2& T_found, bool is_coarse, double least_score);

  // parts.cpp: parts of the map that have no known place in one another
  int componentOf(int keyframe) const;
  bool isCutOff(int keyframe) const { return componentOf(keyframe) != 0; }
  void beginPart(int keyframe);
  void searchAnew();
  void joinComponents(int from, int to);
  const std::vector<int>& placesBeyond(int component);
  std::vector<int> keyframesAtPlace(int place) const;
  std::vector<int> keyframesNear(const core::Point2& centre, int component, int most) const;
  const scanmatch::LikelihoodPyramid& pyramidOf(int place);
  std::optional<scanmatch::MatchResult> matchAtPlace(const Points& query, int place, double heading_rad);
  void noteWhatStaysApart();

  // join.cpp: a trail and the rest of the map
  int trailSize() const;
  const core::Pose2& trailPose(int i) const;
  const Points& trailPoints(int i) const;
  void lookForPart(int first, int last);
  void joinRemainingParts();
  const Join* workOnJoins(int component);
  void lookAtNextPlace(int component);
  void addJoin(int place, const core::Pose2& T_map_robot);
  bool isKnown(const Join& join) const;
  bool isPlausible(const Join& join) const;
  void holdAgainst(Join& join, Cursor& cursor, int next);
  bool isCurrent(const Join& join) const;
  double conflictOf(int trail_point, const std::vector<int>& viewers, const core::Pose2& T_map_robot) const;
  void refute(const Join& join);
  bool isRefuted(const core::Pose2& T_map_robot, const Join& join) const;
  double aheadOf(const Join& join, const Join& other) const;
  bool isReady(const Join& join) const;
  Join* decided();
  std::vector<core::Point2> trailQuery(const Join& join) const;
  bool isProved(Join& join, int component);
  void joinPart(const Join& join);

  // known_parts.cpp: maps of before whose places in one another are not known
  std::optional<PartPlace> placeOfPart(int first, int end, core::Progress& progress);
  void lookFrom(int anchor, std::vector<Overlay>& overlays, const std::function<void()>& tell);
  core::Pose2 placeAt(const Overlay& one, int keyframe) const;
  void overlay(Overlay& one, int first, int end) const;
  void lay(Overlay& one, Cursor& cursor, int keyframe) const;
  bool fitsWell(const Overlay& one) const;
  void judge(size_t part, PartPlace& place) const;
  int endOfPart(size_t part) const;

  // localise.cpp: in a finished map
  bool searchWhileLost(const Points& points, Step& step);
  void beLost(double score);
  bool fitsMap(const Points& points, const core::Pose2& T_map_robot) const;

  std::vector<double> pathTo(int keyframe) const;

  // closing.cpp: all poses found anew, a piece with every scan
  void beginClosing(const Hypothesis& loop, bool is_linked);
  void continueClosing();
  void completeClosing();
  void takeOver();

  // refine.cpp
  void refine();

  GraphOptions options_;
  posegraph::PoseGraph graph_;
  std::vector<Keyframe> keyframes_;
  Links links_;
  std::vector<std::pair<int, int>> closures_;  ///< keyframes that accepted loops join
  std::vector<int> loop_begins_;               ///< first edge of every loop
  std::vector<Hypothesis> hypotheses_;
  std::optional<Closing> closing_;
  std::vector<Record> records_;
  std::vector<core::JournalEntry> journal_;
  LevelMaps maps_;
  std::vector<int> map_keyframes_;
  scanmatch::MatchEvidence evidence_;                     ///< of the scan at hand
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();  ///< of its pose in the map
  Eigen::Matrix3d from_keyframe_ =
      Eigen::Matrix3d::Zero();  ///< of what odometry alone tells since the keyframe
  Eigen::Matrix3d noise_ = Eigen::Matrix3d::Zero(),
                  least_ = Eigen::Matrix3d::Zero();  ///< of one scan: its match, and with odometry
  PointNoise point_noise_;
  int anchor_ = 0;  ///< the keyframe that the robot hangs on: the last, or one of known ground
  core::Pose2 T_keyframe_robot_, T_previous_robot_;
  core::Pose2 T_keyframe_hung_, T_odometry_;  ///< when it was hung on it; by odometry since then
  bool odometry_holds_ = true;                ///< since then
  bool is_known_ground_ = false;              ///< under the scan at hand
  ChangeMarks appeared_, gone_;
  std::optional<core::Pose2> by_wheels_;     ///< map frame: see followWheels()
  int unsure_from_ = 0;                      ///< keyframe; meanwhile
  int explained_ = 0;                        ///< scans in a row
  double let_go_m_ = 0;                      ///< driven then
  std::vector<Seen> seen_;                   ///< one per lidar
  int before_ = -1;                          ///< of these, the one of the scan at hand; -1: its lidar is new
  double previous_time_s_ = 0;               ///< of the last scan of any
  double period_s_ = 0, mean_period_s_ = 0;  ///< from the scan before to the last one
  double path_m_ = 0, searched_m_ = 0;
  double searched_reach_m_ = 0;  ///< window of the last search for loops
  int revision_ = 0;
  LostDetector lost_;
  Doubt doubt_;
  int held_back_ = 0;  ///< scans in a row that were not believed
  std::vector<Part> parts_{{0, 0}};
  std::vector<KnownPart> known_parts_;  ///< those after the first
  std::vector<int> places_;             ///< of placesBeyond()
  int places_known_ = 0, places_component_ = kNoComponent;
  size_t places_tried_ = 0;                               ///< times kHeadings
  std::map<int, scanmatch::LikelihoodPyramid> pyramids_;  ///< of places_
  int wrong_places_ = 0;                                  ///< that were learnt from
  bool is_lost_ = false, is_outside_ = false;             ///< in a finished map
  std::vector<Join> joins_;
  std::vector<Refuted> refuted_;          ///< since searchAnew()
  std::vector<TrailPoint> trail_;         ///< of a robot that is lost in a finished map
  int join_first_ = 0, join_last_ = -1;   ///< keyframes that are the trail else
  mutable LevelMaps scratch_;             ///< of mapOf()
  scanmatch::LikelihoodPyramid pyramid_;  ///< of findLoop()
  scanmatch::SurfelMap pass_map_;         ///< of one pass through a place
};

}  // namespace slam::graph

#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <deque>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/core/symmetric3.h"
#include "libslam/keyframes/error_samples.h"
#include "libslam/keyframes/graph_options.h"
#include "libslam/keyframes/inheritance.h"
#include "libslam/lidar/scan.h"
#include "libslam/posegraph/pose_graph.h"
#include "libslam/scanmatch/surfel_matcher.h"

/// What graph SLAM keeps: keyframes, the places that it follows, and what it thinks of the robot. For
/// the rooms of graph SLAM only.
namespace slam::keyframes {

struct Keyframe {
  int scan;  ///< counted from 0
  lidar::Scan seen;
  std::vector<scanmatch::PatchPoint> points;  ///< robot frame
  core::Point2 view_centre;                   ///< their mean when it was added: where it looks; robot frame
  double path_m;                              ///< driven since the start
  int odometry_edge;                          ///< from the one that it was reached from
  bool unsure = false;                        ///< no scan is matched to it: see tracking::Tracker
  bool is_retired = false;                    ///< nor to this one, for ever; nothing of its scan is kept
  // how sure its pose is: see uncertainty::inheritedErrors()
  Eigen::Matrix3d noise;  ///< of its pose against the map as it was; map frame
  /// What the surfaces that it saw first err by in the map: its pose's error, see KeyframeMap::errorsOf(),
  /// and its noise, which is the same for all that are matched to them.
  ErrorSamples surfaces;
  Inheritance inherited;
};
/// None moves when one more comes.
using Keyframes = std::deque<Keyframe>;
/// Where a scan lies. There is one of every scan.
struct Record {
  int keyframe;
  core::Pose2 T_keyframe_robot;
  core::Symmetric3 drift_covariance;  ///< since the keyframe; map frame, as it was
};
/// Surfels of the same points with cells of one, two and four times cell_m. `for_tracking`: the finest keep
/// the faces of thin walls apart, and all widen where points are few; not for a robot whose place is looked
/// for.
struct LevelMaps {
  scanmatch::SurfelMap fine, middle, coarse;
  LevelMaps(const GraphOptions& options, bool for_tracking);
};
/// What is searched for when loops are: the newest keyframes' points, in the frame of the last of them.
struct LoopSearch {
  int keyframe;
  std::vector<double> way_m;   ///< to each keyframe
  std::vector<char> is_local;  ///< of each keyframe: the newest are matched to it anyway
  std::vector<core::Point2> points;
  std::vector<scanmatch::PatchPoint> match_points;
  double view_m;  ///< how far `points` reach
};
/// What a scan says for a place, in nats, and the share of it about which the map says nothing there.
struct Said {
  double nats, unknown;
};
/// A place that may have been recognised, while it is followed.
struct Hypothesis {
  int keyframe;             ///< that it has come to
  int old_keyframe;         ///< nearest of the old ones there
  core::Pose2 T_map_robot;  ///< of `keyframe`, as the old ones have it
  double begun_m;
  int confirmations = 0, failures = 0;
  double evidence = 0;       ///< sum of distinctness()
  double innovation = -1;    ///< see LoopJudge; -1: not asked yet
  std::map<int, Said> says;  ///< of every keyframe that was asked
  std::vector<posegraph::Edge> edges;
};
/// An edge that measures a loop, and the share of its information that it tells: a loop counts as much as one
/// match, however many keyframes have confirmed it.
struct LoopEdge {
  size_t edge;
  double share;
};
/// All keyframes' poses, found anew, and what they err by; or nothing of that.
struct Settled {
  double chi2 = 0;  ///< of the graph
  std::vector<core::Pose2> poses;
  std::vector<ErrorSamples> errors;
};
/// Of a point's residual, in surfels' variances, as all scans so far have it.
class PointNoise {
 public:
  void add(const scanmatch::MatchEvidence& evidence);
  double variance() const;
  /// And of its pull on a match, which is the residual times the robust weight.
  double varianceOfPull() const;

 private:
  double shared() const;
  double squared_ = 0, pulled_ = 0, dimensions_ = 0;
  std::array<double, scanmatch::MatchEvidence::kLags> lagged_{};
};
/// Keyframes from `begin` to the next part's; parts of one component have known places in one another.
struct Part {
  int begin, component;
};
/// A part that was given, not driven: the frame it was given in, as it was laid out, and its first keyframe
/// there.
struct KnownPart {
  core::Pose2 T_map_given, T_given_first;
};
/// What a part of the map, or a robot that is lost in a finished map, has seen in a row: poses among
/// themselves.
struct TrailPoint {
  core::Pose2 T_trail_robot;
  std::vector<scanmatch::PatchPoint> points;
};
/// Where a trail is on its way through another map.
struct Cursor {
  int at;  ///< in the trail
  core::Pose2 T_map_robot;
};
struct Box {
  core::Point2 least{1e300, 1e300}, most{-1e300, -1e300};  ///< map frame; at first empty
  void add(const core::Point2& p) {
    least = {std::min(least.x, p.x), std::min(least.y, p.y)};
    most = {std::max(most.x, p.x), std::max(most.y, p.y)};
  }
  double diagonal_m() const { return least.x > most.x ? 0 : core::distance(least, most); }
};
/// What a map says of one point of a trail at a place: the share of what is seen there that it explains, that
/// it contradicts (of what it says anything of), and of which it says nothing.
struct Answer {
  double explained, contradicted, unknown;
};
/// A place of a trail in another part of the map, while the rest of the trail is held against it, to both
/// sides.
struct Join {
  int place;  ///< keyframe where it was found
  Cursor forth, back;
  int back_to;  ///< the trail is not asked farther back
  int asked = 0, told = 0, fitting = 0, failures = 0;
  double evidence = 0, distinct = 0;  ///< nats; sum of distinctness()
  std::map<int, Answer> says;         ///< of every point of the trail that was asked
  /// Contradicted shares of all that were told, by the map there and by the rest of the trail.
  double against = 0, against_itself = 0;
  std::vector<Cursor> placed;      ///< points of the trail that fit
  Box fits, followed;              ///< where the trail fits, and where nothing contradicts it
  int proved = 0;                  ///< places, times kHeadings, that were shown not to be as good
  std::vector<core::Pose2> twins;  ///< T_map_trail of places that hold the trail nearly as well
  int old_keyframe = 0;            ///< nearest at `forth`
  int places_left = 0;             ///< of the whole map, not looked at yet since it was found
  double score = 0;
  std::vector<posegraph::Edge> edges;
};
/// Where a known part may lie, by one of its keyframes; and what the rest of it says of that.
struct Overlay {
  int anchor, place;               ///< keyframes: of the part, and where it was found
  core::Pose2 T_map_robot;         ///< of the anchor
  int votes = 1, last_voter = -1;  ///< anchors that say so
  bool is_judged = false;
  int told = 0, fitting = 0;  ///< keyframes of which the map says anything; those of them that fit
  double nats = 0, distinct = 0;
  std::vector<Cursor> placed;  ///< those that fit and are well seen
  Box fits;
  std::vector<posegraph::Edge> edges;
};
/// What a keyframe's beams say of a point: one ended there; they went on behind it; or neither.
enum class Sight { kAgreed, kPassed, kUnseen };
/// The same of another keyframe's points.
struct View {
  int agreed = 0, passed = 0;  ///< seen too; beams went on behind the point
  double conflict() const;
};

/// How a scan joins the last one of its lidar.
struct Break {
  core::Pose2 T_previous_robot;
  double contradicted;  ///< see tracking::Motion::brokenBy(); NaN: there is nothing to compare
};
/// Since scans speak for kidnapping.
struct Doubt {
  int begins = -1;  ///< first keyframe of the map that is made meanwhile; before there is one: -1
  double held_s = 0, held_m = 0, untold_m = 0;
  int explained_before = 0;  ///< scans, by the map from before
  double explained = 0;      ///< of the last scan, by the map at hand
  /// Where the robot is if all is well, and the map from before.
  core::Pose2 T_map_robot;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  std::shared_ptr<const LevelMaps> maps;
};
/// kOwnMap: a map of its own begins; kBack: it ends well.
enum class Trust { kWell, kHeldBack, kOwnMap, kBack };
/// What keyframes say of a scan: the share of its points about which they say anything, and of these, those
/// in whose place there was nothing.
struct Told {
  double contradicted = 0, telling = 0;
  double against(double explained) const;
};

}  // namespace slam::keyframes

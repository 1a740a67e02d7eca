#pragma once
#include <functional>
#include <list>
#include <map>
#include <optional>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/keyframes/keyframe_map.h"
#include "libslam/loops/part_place.h"
#include "libslam/scanmatch/correlative_search.h"

namespace slam::loops {

/// Finds the place of what hangs together, a trail, in the rest of a KeyframeMap, when nothing is known of
/// it: a part that a kidnapped robot has mapped, a map of before, or what a robot has seen that is lost in a
/// finished map. For the rooms of graph SLAM only.
class PartFinder {
 public:
  /// The map has to stay where it is.
  explicit PartFinder(keyframes::KeyframeMap& map) : map_(&map), options_(&map.options()) {}

  /// One scan's share of the search for the keyframes [first, last]: the loop that joins them to the rest,
  /// when that is decided.
  std::optional<keyframes::Hypothesis> lookForPart(int first, int last);
  /// Shares after which all places were looked at and followed.
  size_t mostShares(int component);
  /// Forgets every place that was followed.
  void searchAnew();
  /// After parts were joined: the rest is another.
  void forgetPlaces();

  // Of a robot that is lost in a finished map.
  void beginTrail();
  void endTrail();
  struct Found {
    core::Pose2 T_map_robot;
    double score;
  };
  /// `here`, by its wheels since beginTrail(), it sees these points: one scan's share of the search.
  std::optional<Found> lookForRobot(const core::Pose2& here,
                                    const std::vector<scanmatch::PatchPoint>& points);

  // overlay.cpp
  struct PlacedPart {
    keyframes::Hypothesis loop;
    PartPlace place;
  };
  /// Looks for the keyframes [first, end) from some of them in all of the map that is not joined to them.
  /// Every place that is found holds for the whole part: the places that several of them agree on are held
  /// against all of it, and the part is joined where it fits over a large extent and no other place is nearly
  /// as good.
  std::optional<PlacedPart> placeOfPart(int first, int end, core::Progress& progress);

 private:
  using Points = std::vector<scanmatch::PatchPoint>;
  /// At the right place the map contradicts the trail about as often as the trail itself does, since people
  /// walk and lidars err: on logs of real buildings 0.8 to 3 times as often, in simulated ones by up to 0.012
  /// more (in one of 90 by 0.03); at wrong places by 0.012 to 0.1 more, mostly by 0.02 and more.
  static constexpr double kAsItself = 3, kMoreThanItself = 0.0125;
  static constexpr int kNoComponent = -1, kAnyComponent = -2;

  // part_places.cpp: places of the map beyond the trail
  const std::vector<int>& placesBeyond(int component);
  const scanmatch::LikelihoodPyramid& pyramidOf(int place);
  std::optional<scanmatch::MatchResult> matchAtPlace(const Points& query, int place, double heading_rad);

  // part_finder.cpp: a trail, and places that it is followed through
  int trailSize() const;
  const core::Pose2& trailPose(int i) const;
  const Points& trailPoints(int i) const;
  const keyframes::Join* workOnJoins(int component);
  void lookAtNextPlace(int component);
  enum class Added { kNew, kKnown, kContradicted, kFitsNot };
  Added addJoin(int place, const keyframes::Cursor& found, const keyframes::Join* kept = nullptr);
  bool isKnown(const keyframes::Join& join) const;
  bool isPlausible(const keyframes::Join& join) const;
  void holdAgainst(keyframes::Join& join, keyframes::Cursor& cursor, int next);
  bool isCurrent(const keyframes::Join& join) const;
  double conflictOf(int trail_point, const std::vector<int>& viewers, const core::Pose2& T_map_robot) const;
  double contradictsItself(int trail_point);

  // part_verdict.cpp: which of the places is the right one
  bool areSame(const core::Pose2& T_map_trail, const core::Pose2& T_map_other) const;
  double aheadOf(const keyframes::Join& join, const keyframes::Join& other) const;
  bool isContradicted(const keyframes::Join& join) const;
  bool isReady(const keyframes::Join& join) const;
  keyframes::Join* decided();
  Points whatFits(const keyframes::Join& join) const;
  void followTwin(const keyframes::Join& join, int place, const core::Pose2& T_map_robot);
  bool isProved(keyframes::Join& join, int component);

  void lookFrom(int anchor, std::vector<keyframes::Overlay>& overlays, const std::function<void()>& tell);
  core::Pose2 placeAt(const keyframes::Overlay& one, int keyframe) const;
  void overlay(keyframes::Overlay& one, int first, int end) const;
  void lay(keyframes::Overlay& one, keyframes::Cursor& cursor, int keyframe) const;
  bool fitsWell(const keyframes::Overlay& one) const;

  keyframes::KeyframeMap* map_;
  const keyframes::GraphOptions* options_;
  std::vector<int> places_;  ///< of placesBeyond()
  int places_known_ = 0, places_component_ = kNoComponent;
  size_t places_tried_ = 0;                               ///< times kHeadings
  std::map<int, scanmatch::LikelihoodPyramid> pyramids_;  ///< of places_
  std::list<keyframes::Join> joins_;
  std::map<int, double> itself_;  ///< contradictsItself(), of those that were asked since then
  bool is_lost_ = false;          ///< the trail is that of a robot
  std::vector<keyframes::TrailPoint> trail_;
  int join_first_ = 0, join_last_ = -1;  ///< keyframes that are the trail else
};

}  // namespace slam::loops

#pragma once
#include <utility>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/keyframes/keyframe_map.h"

namespace slam::tracking {

/// The map around the robot, of keyframes near it: what the next scan is matched to, and what it says of
/// that. For the rooms of SLAM methods only.
class LocalMap {
 public:
  using Points = std::vector<scanmatch::PatchPoint>;
  /// `map` has to stay where it is.
  explicit LocalMap(const keyframes::KeyframeMap& map);

  /// Made anew of the keyframes around a robot that are linked with one of them and see what it sees: see
  /// keyframes::KeyframeMap::keyframesLookingAlike().
  void fillAround(int keyframe, const core::Pose2& T_map_robot);
  /// Of all around a place, however they are linked: of a map that is finished.
  void fillNear(const core::Point2& centre);
  /// The nearest first, see fillAround().
  const std::vector<int>& keyframes() const { return keyframes_; }
  const keyframes::LevelMaps& maps() const { return maps_; }
  /// Which keyframes the next one is tied to, whatever the maps were made of; until they are made anew.
  void setKeyframes(std::vector<int> keyframes) { keyframes_ = std::move(keyframes); }
  /// Memory for another map, until this one is made anew.
  scanmatch::SurfelMap& lentMap() { return maps_.fine; }

  /// The share that is explained at a pose of those points of which the map says something: that fall on a
  /// surface, or where beams of the keyframes nearest have passed. Points beyond what was seen, and between
  /// two beams far apart, are left out, as long as there are others enough.
  double toldScore(const Points& points, const core::Pose2& T_map_robot) const;
  /// By how much more of the scan a pose explains than another, by the points of which both say something:
  /// those that fall on a surface, and those that beams have gone through. What falls into the unknown, or
  /// between two beams of a keyframe far along a wall, says nothing against a pose.
  double gain(const Points& points, const core::Pose2& T_map_robot, const core::Pose2& T_map_other) const;
  /// Whether a match explains too little of a scan, by all points and by those of which the map says
  /// something.
  bool isPoor(const scanmatch::MatchResult& result, const Points& points) const;
  /// Share of a scan's points that fall on a mapped surface, or near one.
  double knownShare(const Points& points, const core::Pose2& T_map_robot) const;

 private:
  const keyframes::KeyframeMap* map_;
  const keyframes::GraphOptions* options_;
  keyframes::LevelMaps maps_;
  std::vector<int> keyframes_;
};

}  // namespace slam::tracking

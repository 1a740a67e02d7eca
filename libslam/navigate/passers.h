#pragma once
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/paths/free_space.h"

namespace slam::navigate {

/// People who pass, as a map made meanwhile shows them: as walls, until the robot looks there again. Who has
/// come into free space, and is not seen now, is taken to have gone; once that leaves nothing to do, so is
/// whatever is no larger than a person. While nobody is about nothing is taken out of any map.
class Passers {
 public:
  /// The newest scan's returns, map frame, in its order, with the map as it was known before. What stands
  /// amid free space, is no larger than a person, and hangs together with nothing else is one: where the map
  /// and the pose err, whole walls stand there.
  void see(const std::vector<core::Point2>& points_map, const paths::FreeSpace& space);
  /// Where the people of the newest scan may reach, map frame: a lidar sees legs, and bodies are wider.
  const std::vector<core::Point2>& bodies() const { return bodies_; }
  /// In one scan of ten and more: where a map errs, something else may seldom be taken for them.
  bool areAbout() const { return !passed_.empty() && 10 * scans_with_people_ >= scans_; }
  /// From now on small things that are not seen now are taken for people.
  void suspectSmallThings() { are_small_things_suspected_ = true; }
  bool areSmallThingsSuspected() const { return are_small_things_suspected_; }
  /// Makes free what they have left behind.
  void takeOutOf(paths::FreeSpace& space) const;

 private:
  using Place = std::int64_t;
  static Place placeOf(const core::Point2& p_map, double cell_m);
  static void mark(const core::Point2& p_map, double cell_m, std::unordered_set<Place>& places);
  void takeOutSmallThings(paths::FreeSpace& space) const;

  std::unordered_set<Place> passed_;    ///< cells in or beside which somebody was
  std::unordered_set<Place> seen_now_;  ///< in or beside which the newest scan has a return
  std::vector<core::Point2> bodies_;
  bool are_small_things_suspected_ = false;
  int scans_ = 0, scans_with_people_ = 0;
};

}  // namespace slam::navigate

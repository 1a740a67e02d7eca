#pragma once
#include <cstddef>
#include <utility>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/paths/expected_gain.h"
#include "libslam/paths/free_space.h"
#include "libslam/paths/frontier.h"

namespace slam::choices {

/// How deep the unknown behind each frontier cell is expected to be.
///
/// A frontier narrower than a door opens into no room: it is the edge of a shadow behind furniture, or a gap
/// between two beams, and what lies there is about as deep as it is wide (kDepthPerWidth). A wider one is
/// expected to go on for deepest_m. Behind a frontier that was looked at for nothing there is nothing.
class Openings {
 public:
  /// `frontiers`: all of them, however short. door_m: a robot fits through openings from there on.
  Openings(const paths::FreeSpace& space, const std::vector<paths::Frontier>& frontiers, double door_m,
           double deepest_m);
  /// Nothing is behind this cell. REQUIRES a cell of a frontier.
  void shut(std::size_t cell);
  /// deepest_m for cells of no frontier.
  double depth_m(std::size_t cell) const;
  double deepest_m() const { return deepest_m_; }

 private:
  std::vector<std::pair<std::size_t, float>> depth_m_;  ///< by cell
  double deepest_m_;
};

/// What a look all round from a place is expected to show.
struct Look {
  std::size_t place = 0;  ///< the caller's number of it
  paths::GainProfile profile;
  /// (cell, expected area in m^2), a cell once per ray that crosses it.
  std::vector<std::pair<std::size_t, float>> cells;
  double area_m2 = 0;  ///< their sum; after coveringLooks() only what no earlier look of the cover shows
};

/// As paths::expectedGain(), but the damping in the unknown is that of the opening by which a ray enters it.
Look lookAround(const paths::FreeSpace& space, const Openings& openings, const core::Point2& p_map,
                double max_range_m);

/// Few looks that together show what all of them do, but for what is less than least_m2 for each: greedily
/// the one that adds most, at most `most` of them. Nothing when no look shows least_m2.
std::vector<Look> coveringLooks(std::vector<Look> looks, std::size_t cells, double least_m2,
                                std::size_t most);

}  // namespace slam::choices

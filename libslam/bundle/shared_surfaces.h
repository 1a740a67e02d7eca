#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "libslam/bundle/points_by_cell.h"
#include "libslam/keyframes/keyframe_map.h"

namespace slam::bundle {

/// A line, or one direction of something round, that more than one keyframe has seen. All but the centre from
/// there, m and m^2.
struct SharedSurface {
  std::vector<const PointsInCell*> seen;  ///< all of one cell
  core::Point2 centre;                    ///< of that cell, map frame
  core::Point2 direction;                 ///< of the line, of length 1
  core::Point2 mean;
  double variance;  ///< of points across the direction
};

/// What keyframes of a map have seen of the same walls: points of linked ones (see keyframes::Links) that
/// fall into one cell, from one side. The map is gone through in bands of rows, so that memory is that of a
/// band: 72 bytes for each keyframe and cell in it.
class SharedSurfaces {
 public:
  /// REQUIRES a map that outlives this, and keeps its keyframes. Their poses may change.
  explicit SharedSurfaces(const keyframes::KeyframeMap& map);
  /// Each surface as the poses stand, in one order whatever they are; what it points to lives for the call.
  void forEach(const std::function<void(const SharedSurface&)>& visit) const;

 private:
  using Visit = std::function<void(const SharedSurface&)>;
  using Rows = std::pair<std::int64_t, std::int64_t>;  ///< the first, and the one after the last
  /// Points of a cell that are seen from one side, by keyframes that hang together.
  struct Group {
    std::vector<const PointsInCell*> points;
    std::vector<int> stretches;  ///< of those
    void add(const PointsInCell& one, int stretch);
    void takeOver(Group& other);
  };
  /// The memory of groups is kept.
  struct Groups {
    std::vector<Group> groups;
    std::size_t count = 0;
    SharedSurface surface;
  };
  void divideWay();
  int stretchOf(const PointsInCell& one) const { return stretch_[static_cast<std::size_t>(one.keyframe)]; }
  bool areLinked(int from, int to) const;
  std::vector<Rows> rowsOfKeyframes() const;
  void collect(const Rows& rows, const std::vector<Rows>& of_keyframes, PointsByCell& points) const;
  void gatherWalls(PointsByCell& points) const;
  void findWalls(PointsByCell& points, std::int8_t reach, double most, std::vector<double>& thickness2) const;
  bool findWall(PointsByCell& points, const PointsByCell::Cell& cell, std::size_t i, std::int8_t reach,
                double most, std::vector<double>& thickness2) const;
  void join(const PointsInCell& one, Groups& groups) const;
  void visitCell(const PointsByCell& points, const PointsByCell::Cell& cell, Groups& groups,
                 const Visit& visit) const;
  void visitGroup(const PointsByCell& points, const PointsByCell::Cell& cell, SharedSurface& surface,
                  const Visit& visit) const;

  const keyframes::KeyframeMap& map_;
  double cell_m_, blur2_;
  std::vector<int> stretch_;              ///< of the way, by keyframe: those in a row are asked for together
  std::vector<std::vector<int>> linked_;  ///< stretches, by stretch, ascending
};

}  // namespace slam::bundle

#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "libslam/keyframes/keyframe_map.h"

namespace slam::bundle {

/// Of a keyframe's points in a cell those that are seen from one side: sums from the cell's centre, as
/// scanmatch::ScanInCells has them.
struct PointsInCell {
  std::int32_t row, column, keyframe;
  float n, x, y, xx, xy, yy, nx, ny;
  std::int8_t reach;  ///< cells around that show that they are of a wall; 0: they are not
};

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
/// band: 52 bytes for each keyframe and cell in it.
class SharedSurfaces {
 public:
  /// REQUIRES a map that outlives this, and keeps its keyframes. Their poses may change.
  explicit SharedSurfaces(const keyframes::KeyframeMap& map);
  /// Each surface as the poses stand, in one order whatever they are; what it points to lives for the call.
  void forEach(const std::function<void(const SharedSurface&)>& visit) const;

 private:
  using Group = std::vector<const PointsInCell*>;
  using Visit = std::function<void(const SharedSurface&)>;
  /// Where points lie, as they were seen from one side; from the centre of a cell.
  struct Spread {
    double n = 0;
    core::Point2 mean;
    core::Point2 direction;  ///< of most spread
    double along = 0, across = 0;
    bool isFlat() const;
  };
  using Rows = std::pair<std::int64_t, std::int64_t>;  ///< the first, and the one after the last
  void divideWay();
  bool areLinked(const PointsInCell& a, const PointsInCell& b) const;
  static std::pair<std::int32_t, std::int32_t> cellOf(const PointsInCell& one);
  static std::size_t endOfCell(const std::vector<PointsInCell>& all, std::size_t begin);
  std::vector<Rows> rowsOfKeyframes() const;
  std::vector<PointsInCell> pointsIn(const Rows& rows, const std::vector<Rows>& of_keyframes) const;
  static void sumUpByCell(std::vector<PointsInCell>& all);
  void gatherWalls(std::vector<PointsInCell>& all) const;
  /// Of points in a cell: the cell that the middle of their wall is in, and PointsInCell::reach.
  struct Way {
    std::int8_t columns = 0, rows = 0, reach = 0;
  };
  void findWalls(const std::vector<PointsInCell>& all, std::int8_t reach, double most, std::vector<Way>& ways,
                 std::vector<double>& thickness2) const;
  static Group neighbourhood(const std::vector<PointsInCell>& all, const PointsInCell& one,
                             std::int32_t reach);
  void visitCell(const std::vector<PointsInCell>& all, std::size_t begin, std::size_t end,
                 const Visit& visit) const;
  void visitGroup(Group group, const Group& around, const Visit& visit) const;
  Spread spreadOf(const Group& group, const PointsInCell& first) const;

  const keyframes::KeyframeMap& map_;
  double cell_m_, blur2_;
  std::vector<int> stretch_;              ///< of the way, by keyframe: those in a row are asked for together
  std::vector<std::vector<int>> linked_;  ///< stretches, by stretch, ascending
};

}  // namespace slam::bundle

#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/core/random.h"
#include "libslam/world/plan.h"

namespace slam::movers {

/// Where people of one radius can stand in a plan, places worth walking to, and the ways between them. All in
/// the plan frame, in metres. Only whole cells are told apart: a point can be stood on when the person fits
/// wherever it is in that cell, so up to 0.7 of a cell beside a wall is given away, and no rounding puts
/// anybody into a wall.
///
/// Everything here is +, -, *, / and sqrt or whole numbers, which every machine rounds alike.
class Walkways {
 public:
  /// `p_start`: people live in the part of the plan that they could reach from there; in the largest part
  /// when nobody could stand within 1 m of it. Places are drawn from (seed, "places"): one per 12 m2, 6 to
  /// 256 of them, where there is room for others to pass. Doors count as open. Memory: 4 bytes per cell.
  Walkways(const world::Plan& plan, double radius_m, std::uint64_t seed, const core::Point2& p_start);

  /// Looks at the plan's cells x0 .. x1-1 by y0 .. y1-1 again: from now on they are what canStand() and
  /// freeDistance() know. Ways go on leading through.
  void update(const world::Plan& plan, int x0, int y0, int x1, int y1);

  /// False outside the plan, too.
  bool canStand(const core::Point2& p) const { return test(now_, p); }
  /// How far one can walk along a unit vector, at most limit_m; to a cell.
  double freeDistance(const core::Point2& p, const core::Point2& direction, double limit_m) const;
  /// True when the straight line can be walked while all doors are open.
  bool isClear(const core::Point2& a, const core::Point2& b) const;

  /// 0 when there is no room for anybody.
  size_t places() const { return places_.size(); }

  struct Way {
    size_t to;                          ///< the place
    std::vector<core::Point2> corners;  ///< from place to place, both included; straight and clear between
  };
  /// Ways to a few other places within a walk of 30 m, found when first asked for; never empty, but a plan
  /// with one place has the way to itself.
  const std::vector<Way>& waysFrom(size_t place);

 private:
  using Mask = std::vector<std::uint8_t>;

  bool test(const Mask& mask, const core::Point2& p) const {
    const double column = p.x * cells_per_metre_, row = p.y * cells_per_metre_;
    if (!(column >= 0 && row >= 0 && column < columns_ && row < rows_)) return false;
    return mask[static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column)] != 0;
  }
  core::Point2 centreOf(size_t cell) const;
  void fill(const world::Plan& plan, int x0, int y0, int x1, int y1, Mask& mask) const;
  std::vector<std::uint32_t> regionFrom(const core::Point2& p_start) const;
  void drawPlaces(const world::Plan& plan, const std::vector<std::uint32_t>& region, double radius_m,
                  core::RandomStream random);
  void flood(size_t from, std::vector<size_t>& reached);
  std::vector<core::Point2> descend(size_t cell) const;

  int columns_, rows_;
  double resolution_m_, cells_per_metre_, reach_;  ///< reach: of walls round a cell's centre, in cells
  Mask open_, now_;             ///< 1 where one can stand: with all doors open, and at present
  std::vector<size_t> places_;  ///< cells
  std::vector<std::uint16_t> cost_;
  std::uint64_t seed_;
  std::map<size_t, std::vector<Way>> ways_;
};

}  // namespace slam::movers

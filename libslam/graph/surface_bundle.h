#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "libslam/keyframes/keyframe_map.h"

namespace slam::graph {

/// Bundle adjustment of a map's scans: points of linked keyframes (see keyframes::Links) that fall into one
/// cell, seen from one side, lie on one line, or round one point. What they have in common is eliminated, as
/// planes are by Liu and Zhang (BALM, IEEE RA-L 6(2), 2021): the poses alone are left. Odometry and loops
/// count beside them. While the robot is tracked, a keyframe is matched to those before it, and its match's
/// noise goes on to all that come after; here it is averaged over all that see the same walls.
///
/// The equations tie every keyframe to all within its view, too many to be factorised. They are solved by
/// conjugate gradients, with the graph's own edges as the preconditioner. Memory: 36 bytes for each keyframe
/// and cell that it saw, and 90 more while it is made. For GraphSlam only.
class SurfaceBundle {
 public:
  /// The map as it stands, which has to stay so. REQUIRES a keyframe.
  explicit SurfaceBundle(const keyframes::KeyframeMap& map);
  /// What moves the poses of all keyframes, x, y (m), phi (rad), map frame: one step of Gauss and Newton.
  /// Zero for the first, and for the first of a part that has no known place. Empty when rounding leaves no
  /// factor.
  std::vector<Eigen::Vector3d> step() const;
  /// What moves the map around each keyframe then: other scans there were matched to that, and to the
  /// keyframe only where odometry held them.
  std::vector<Eigen::Vector3d> stepAround(const std::vector<Eigen::Vector3d>& step) const;
  /// Squares of what points and measured ways are off by, in standard deviations, as the poses stand.
  double chi2() const { return chi2_; }

 private:
  using Vectors = std::vector<Eigen::Vector3d>;
  /// A keyframe's points in a cell: how its pose moves their middle across a direction, what they weigh
  /// (1/m^2), where along it they are and how far they spread (m^2), how far they are off, and how they run.
  struct Seen {
    int keyframe;
    float x, y, phi = 0, weight = 0, along_m = 0, spread2 = 0, off_m = 0, slope = 0;
  };
  /// Those of one cell, one side and one direction.
  struct Surface {
    std::size_t begin, end;
    double weight, lever;  ///< what holds a line in its place, and in its direction
  };
  struct Line {
    double off_m, slope;
  };
  /// A way between keyframes: how far the second is off, and the first's error there; map frame.
  struct Tie {
    int from, to;
    Eigen::Matrix3d J, information;
    Eigen::Vector3d off;
    bool is_measured;  ///< otherwise by a match, of which the surfaces tell more
  };
  struct InCell;
  struct Spread;
  using Group = std::vector<const InCell*>;
  using Linked = std::vector<std::vector<int>>;  ///< by keyframe, ascending
  void collectSurfaces();
  static std::pair<std::int32_t, std::int32_t> cellOf(const InCell& one);
  static void sortByCell(std::vector<InCell>& all);
  void gatherWalls(std::vector<InCell>& all) const;
  static Group neighbourhood(const std::vector<InCell>& all, const InCell& one);
  void addCell(const std::vector<InCell>& all, std::size_t begin, std::size_t end, const Linked& linked);
  Spread spreadOf(const Group& group, const InCell& first) const;
  void addSurfaces(const Group& group, const Group& around);
  void addSurface(const Group& group, const core::Point2& direction, const core::Point2& mean,
                  double variance);
  /// The line that fits best what each says of where it is, and how it runs.
  template <class LineOf>
  Line lineOf(const Surface& surface, const LineOf& of_one) const {
    Line sums{0, 0};
    for (std::size_t i = surface.begin; i < surface.end; ++i) {
      const Seen& seen = seen_[i];
      const Line line = of_one(seen);
      sums.off_m += seen.weight * line.off_m;
      sums.slope += seen.weight * (seen.along_m * line.off_m + seen.spread2 * line.slope);
    }
    return {sums.off_m / surface.weight, surface.lever > 0 ? sums.slope / surface.lever : 0};
  }
  static Eigen::Vector3d pullOf(const Seen& seen, const Line& off);
  void collectTies();
  void addTie(const posegraph::Edge& edge, double share, bool is_measured);
  void weighOdometry();
  std::vector<Eigen::Matrix3d> toldBySurfaces() const;
  void hold(Vectors& v) const;
  Vectors rightSide() const;
  void addSurfacesTimes(const Vectors& v, Vectors& result) const;
  void addTiesTimes(const Vectors& v, Vectors& result) const;
  static Eigen::Vector3d& of(Vectors& v, int keyframe) { return v[static_cast<std::size_t>(keyframe)]; }
  static const Eigen::Vector3d& of(const Vectors& v, int keyframe) {
    return v[static_cast<std::size_t>(keyframe)];
  }

  const keyframes::KeyframeMap& map_;
  double cell_m_, blur2_, point_variance_, chi2_ = 0;
  std::vector<Seen> seen_;
  std::vector<Surface> surfaces_;
  std::vector<Tie> ties_;
  std::vector<int> held_;  ///< first keyframes of parts that have no known place in one another
  /// What held each keyframe besides surfaces when it was matched, in units of what those tell.
  std::vector<Eigen::Matrix3d> by_odometry_;
};

}  // namespace slam::graph

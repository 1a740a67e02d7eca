#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "libslam/bundle/shared_surfaces.h"
#include "libslam/keyframes/keyframe_map.h"

namespace slam::bundle {

/// Bundle adjustment of a map's scans: points of linked keyframes that lie on one line, or round one point,
/// see SharedSurfaces. What they have in common is eliminated, as planes are by Liu and Zhang (BALM, IEEE
/// RA-L 6(2), 2021): the poses alone are left. Odometry and loops count beside them. While the robot is
/// tracked, a keyframe is matched to those before it, and its match's noise goes on to all that come after;
/// here it is averaged over all that see the same walls.
///
/// The equations tie every keyframe to all within its view, too many to be factorised. They are solved by
/// conjugate gradients, with the graph's own edges as the preconditioner. Memory: 16 bytes for each keyframe
/// and cell that it saw.
class SurfaceBundle {
 public:
  /// The map as it stands, which has to stay so. REQUIRES a keyframe, and what this map's keyframes share.
  /// `often` is called while this is made and by step(), and may throw to end them.
  SurfaceBundle(
      const keyframes::KeyframeMap& map, const SharedSurfaces& shared, std::function<void()> often = [] {});
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
  /// A keyframe's points in a cell: what they weigh (1/m^2), where along the surface they are (m), and how
  /// far they spread there (m^2).
  struct Seen {
    int keyframe;
    float weight, along_m, spread2;
  };
  /// Those of one cell, one side and one direction. Poses move them across it about the map's origin, so that
  /// all turn them by one lever: see aboutOrigin().
  struct Surface {
    std::size_t begin, end;  ///< in its piece
    Eigen::Vector2d across;
    double lever_m;  ///< of where points are along it on average
    /// One by what holds a line in its place, and in its direction; 0: nothing does.
    double by_weight, by_rotation;
  };
  /// So many that no memory is left over, nor copied while there come more.
  struct Piece {
    std::vector<Seen> seen;
    std::vector<Surface> surfaces;
  };
  /// Where a keyframe's points lie across a surface, and how they run.
  struct Line {
    double off_m, slope;
  };
  /// A line that was moved, what it weighs, where it is along the surface, and how fast it holds its slope.
  struct Moved {
    double off_m, slope, weight, along_m, hold;
  };
  /// A way between keyframes: how far the second is off; map frame.
  struct Tie {
    int from, to;
    Eigen::Matrix3d information;
    Eigen::Vector3d off;
  };
  /// What surfaces tell of a keyframe as if all others stood, about the map's origin: the upper triangle.
  struct Told {
    double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, zz = 0;
  };
  void addSurface(const SharedSurface& shared);
  std::pair<double, double> addSeen(const SharedSurface& shared, Piece& piece);
  void pull(const Surface& surface, const Piece& piece);
  Piece& pieceFor(std::size_t seen);
  void collectTies();
  void addTie(const posegraph::Edge& edge, double share);
  void weighOdometry();
  std::vector<Eigen::Matrix3d> toldBySurfaces() const;
  void hold(Vectors& v) const;
  Vectors rightSide() const;
  Eigen::Matrix3d aboutOrigin(int keyframe) const;
  Eigen::Matrix3d movedToEnd(const Tie& tie) const;
  Vectors toPoses(Vectors about_origin) const;
  Vectors surfacesTimes(const Vectors& v) const;
  static void pullBack(const Surface& surface, const Seen* seen, const Vectors& moved, Moved* lines,
                       Vectors& pulls);
  void addTiesTimes(const Vectors& v, Vectors& result) const;
  static Eigen::Vector3d& of(Vectors& v, int keyframe) { return v[static_cast<std::size_t>(keyframe)]; }
  static const Eigen::Vector3d& of(const Vectors& v, int keyframe) {
    return v[static_cast<std::size_t>(keyframe)];
  }

  const keyframes::KeyframeMap& map_;
  std::function<void()> often_;
  double point_variance_, chi2_ = 0;
  std::vector<Piece> pieces_;
  Vectors pulls_;  ///< of surfaces on keyframes, about the map's origin
  std::vector<Told> told_;
  std::vector<double> point_weights_;  ///< by keyframe: one by its points' variance, in that of surfaces
  std::vector<Line> lines_;            ///< of the surface that is added
  std::vector<Tie> ties_;              ///< those that are measured come first
  std::size_t measured_ = 0;
  std::vector<int> held_;  ///< first keyframes of parts that have no known place in one another
  /// What held each keyframe besides surfaces when it was matched, in units of what those tell.
  std::vector<Eigen::Matrix3d> by_odometry_;
};

}  // namespace slam::bundle

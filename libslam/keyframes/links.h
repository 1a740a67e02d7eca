#pragma once
#include <utility>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::keyframes {

/// Which keyframes hang together: each with the one before, and with those that it shares a view with.
class Links {
 public:
  /// The next keyframe, so far without links.
  void addKeyframe() { links_.emplace_back(); }
  /// REQUIRES keyframes that were added.
  void join(int a, int b, double length_m);
  /// Takes a keyframe out of all chains; what it held together stays so by the nearest of those that it had
  /// links to.
  void remove(int keyframe);
  /// Takes every length anew, after keyframes have moved. REQUIRES one pose for each.
  void measure(const std::vector<core::Pose2>& poses);
  /// Keyframes that chains of links of at most path_m connect with `start`, within radius_m of the centre;
  /// squared distances from there, the nearest first. Chains do not lead far outside of the circle.
  std::vector<std::pair<double, int>> around(const std::vector<core::Pose2>& poses, int start,
                                             const core::Point2& centre, double path_m,
                                             double radius_m) const;
  /// `start` and all that chains of at most path_m connect with it, wherever they are; in no order.
  std::vector<int> linkedWith(int start, double path_m) const;

 private:
  struct Link {
    int to;
    double length_m;
  };
  template <class IsNear>
  void reach(int start, double path_m, const IsNear& isNear) const;
  std::vector<std::vector<Link>> links_;
  // Scratch of reach().
  mutable std::vector<double> reached_;
  mutable std::vector<int> touched_;                                  ///< what was reached last
  mutable std::vector<std::vector<std::pair<double, int>>> buckets_;  ///< by length, to each keyframe
};

/// Length of the shortest way from keyframe `from` to every one before it, along the path driven and through
/// `closures`, pairs of keyframes that lie in one place. path_m: driven up to each keyframe, ascending.
std::vector<double> shortestWays(const std::vector<double>& path_m,
                                 const std::vector<std::pair<int, int>>& closures, int from);

}  // namespace slam::keyframes

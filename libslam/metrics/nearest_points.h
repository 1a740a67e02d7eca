#pragma once
#include <cstddef>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::metrics {

/// Exact distances to the nearest of a fixed set of points: a k-d tree (Bentley, CACM 18(9), 1975) kept as a
/// sorted array. Building: O(n log n); a query: O(log n) for points near the set.
class NearestPoints {
 public:
  explicit NearestPoints(std::vector<core::Point2> points);
  /// Metres; +infinity for an empty set.
  double distance(const core::Point2& p) const;

 private:
  void sort(size_t begin, size_t end, bool by_x);
  void search(size_t begin, size_t end, bool by_x, const core::Point2& p, double& best_squared) const;

  std::vector<core::Point2> points_;  ///< of every range the middle one splits the others
};

}  // namespace slam::metrics

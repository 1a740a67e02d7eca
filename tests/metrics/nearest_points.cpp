#include "libslam/metrics/nearest_points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libslam/core/random.h"

namespace slam::metrics {
namespace {

double bruteForce(const std::vector<core::Point2>& points, const core::Point2& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& q : points) best = std::min(best, (q.x - p.x) * (q.x - p.x) + (q.y - p.y) * (q.y - p.y));
  return std::sqrt(best);
}

TEST(NearestPoints, EqualsTheBruteForceSearchBitForBit) {
  core::RandomStream random(3, "points");
  for (const int count : {1, 2, 3, 10, 500}) {
    std::vector<core::Point2> points;
    points.reserve(static_cast<size_t>(count));
    // On a coarse lattice, so that equal coordinates and equal points are common.
    for (int i = 0; i < count; ++i) points.push_back({double(random.below(20)), double(random.below(20))});
    const NearestPoints nearest(points);
    for (int i = 0; i < 500; ++i) {
      const core::Point2 p{random.uniform(-10, 30), std::floor(random.uniform(-10, 30))};
      ASSERT_EQ(nearest.distance(p), bruteForce(points, p));
    }
  }
}

TEST(NearestPoints, AnswersInfinityForNoPoints) {
  EXPECT_EQ(NearestPoints({}).distance({1, 2}), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace slam::metrics

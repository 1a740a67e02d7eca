#include "libslam/movers/disc.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libslam/core/random.h"

namespace slam::movers {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

TEST(DiscRay, EndsOnTheRimAndNotBehindIt) {
  core::RandomStream random(1, "discs");
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Disc disc{{random.uniform(-3, 3), random.uniform(-3, 3)}, random.uniform(0.05, 1)};
    const core::Point2 origin{random.uniform(-3, 3), random.uniform(-3, 3)};
    const double angle = random.uniform(-core::kPi, core::kPi);
    const core::Point2 direction{std::cos(angle), std::sin(angle)};
    const auto gapAt = [&](double s) {
      return core::distance({origin.x + s * direction.x, origin.y + s * direction.y}, disc.p) - disc.radius_m;
    };
    const double range = castRay(disc, origin, direction);
    if (gapAt(0) <= 0) {
      ASSERT_EQ(range, 0);
      continue;
    }
    // 2000 steps of 4.5 mm along the ray: none lies in the disc before the hit, nor anywhere without one.
    double nearest = 9;
    for (double s = 0; s < std::min(range, 9.0); s += 0.0045) nearest = std::min(nearest, gapAt(s));
    ASSERT_GT(nearest, -1e-12);  // one rounding of numbers up to 10
    if (!std::isfinite(range)) continue;
    ++hits;
    // The root of a grazing ray loses half the digits: 1e-8 along the ray, but on the rim to its square.
    ASSERT_NEAR(gapAt(range), 0, 1e-12);
  }
  EXPECT_GT(hits, 1000);
}

TEST(DiscRay, GrazesMissesAndLooksAway) {
  const Disc disc{{2, 1}, 1};
  EXPECT_EQ(castRay(disc, {0, 0}, {1, 0}), 2);  // touches it from below
  EXPECT_EQ(castRay(disc, {0, -1e-9}, {1, 0}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(castRay(disc, {0, 1}, {1, 0}), 1);
  EXPECT_EQ(castRay(disc, {4, 1}, {1, 0}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(castRay(disc, {3, 1}, {1, 0}), 0);  // on the rim
}

/// Every beam against every disc, without a look at bearings.
std::vector<float> bruteForce(const std::vector<Disc>& discs, const core::Pose2& pose, double first,
                              double step, double limit_m, std::vector<float> ranges) {
  for (size_t i = 0; i < ranges.size(); ++i) {
    const double angle = pose.phi + first + static_cast<double>(i) * step;
    for (const auto& disc : discs) {
      const double range = castRay(disc, core::position(pose), {std::cos(angle), std::sin(angle)});
      if (limit_m <= 0 || range <= limit_m) ranges[i] = std::min(ranges[i], static_cast<float>(range));
    }
  }
  return ranges;
}

TEST(DiscScan, EqualsEveryBeamAgainstEveryDisc) {
  core::RandomStream random(2, "scans");
  for (int i = 0; i < 400; ++i) {
    std::vector<Disc> discs;
    for (auto n = random.below(6); n > 0; --n)
      discs.push_back({{random.uniform(-4, 4), random.uniform(-4, 4)}, random.uniform(0.03, 0.6)});
    const core::Pose2 pose{random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-20, 20)};
    const auto beams = random.below(400);
    // From a single direction to more than a whole turn, to the left and to the right.
    const double step = random.chance(0.1) ? 0 : random.uniform(-0.005, 0.02), first = random.uniform(-7, 7);
    const double limit_m = random.chance(0.3) ? random.uniform(0.1, 4) : 0;
    std::vector<float> ranges(beams, kNothing);
    for (auto& range : ranges)
      if (random.chance(0.5)) range = static_cast<float>(random.uniform(0, 5));
    const auto expected = bruteForce(discs, pose, first, step, limit_m, ranges);
    castScan(discs, pose, first, step, limit_m, ranges);
    ASSERT_EQ(ranges, expected) << "scan " << i;
  }
}

TEST(DiscScan, LeavesAScanAloneThatItCannotSee) {
  std::vector<float> ranges(10, 1.5F), none;
  castScan({{{1, 0}, 0.5}}, {std::nan(""), 0, 0}, 0, 0.1, 0, ranges);
  EXPECT_EQ(ranges, std::vector<float>(10, 1.5F));
  castScan({}, {0, 0, 0}, 0, 0.1, 0, ranges);
  EXPECT_EQ(ranges, std::vector<float>(10, 1.5F));
  castScan({{{1, 0}, 0.5}}, {0, 0, 0}, 0, 0.1, 0, none);
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace slam::movers

#include "libslam/draw/outline.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "libslam/core/random.h"

namespace slam::draw {
namespace {

using core::Point2;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::vector<double> xOf(const std::vector<Point2>& points) {
  std::vector<double> x;
  x.reserve(points.size());
  for (const Point2& p : points) x.push_back(p.x);
  return x;
}

TEST(FewerPoints, KeepEndsAndCornersBeyondTheTolerance) {
  EXPECT_THAT(xOf(fewerPoints({{0, 0}, {1, 0.09}, {2, 0}, {3, 1}}, 0.1)), ::testing::ElementsAre(0, 2, 3));
  EXPECT_THAT(xOf(fewerPoints({{0, 0}, {1, 0.11}, {2, 0}}, 0.1)), ::testing::ElementsAre(0, 1, 2));
  EXPECT_THAT(fewerPoints({}, 1), IsEmpty());
  EXPECT_THAT(fewerPoints({{1, 2}}, 1), SizeIs(1));
  EXPECT_THAT(fewerPoints({{1, 2}, {1, 2}}, 1), SizeIs(2));
}

// Neither on the line through its ends nor beyond them is a turn of the way lost.
TEST(FewerPoints, KeepTheTurnOfAWayThatComesBack) {
  EXPECT_THAT(xOf(fewerPoints({{0, 0}, {5, 0}, {10, 0}, {5, 0}, {1, 0}}, 0.1)),
              ::testing::ElementsAre(0, 10, 1));
  EXPECT_THAT(xOf(fewerPoints({{0, 0}, {5, 0}, {10, 0}, {5, 0}, {0, 0}}, 0.1)),
              ::testing::ElementsAre(0, 10, 0));
  EXPECT_THAT(xOf(fewerPoints({{0, 0}, {-3, 0}, {1, 0}}, 0.1)), ::testing::ElementsAre(0, -3, 1));
}

TEST(FewerPoints, LieNowhereFartherFromTheWholeLineThanTheTolerance) {
  core::RandomStream random(3, "walk");
  std::vector<Point2> walk = {{0, 0}};
  for (int i = 0; i < 2000; ++i)
    walk.push_back({walk.back().x + random.normal(0.05), walk.back().y + random.normal(0.05)});
  const auto few = fewerPoints(walk, 0.2);
  EXPECT_LT(few.size(), walk.size() / 3);
  size_t next = 0;
  for (const Point2& p : walk) {  // in order, and none skipped by more than the tolerance
    if (p.x == few[next].x && p.y == few[next].y) {
      next = std::min(next + 1, few.size() - 1);
      continue;
    }
    const Point2 &a = few[next - 1], &b = few[next];
    const double length = core::distance(a, b);
    const double along =
        std::clamp(((p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y)) / length, 0.0, length);
    EXPECT_LE(core::distance(p, {a.x + along * (b.x - a.x) / length, a.y + along * (b.y - a.y) / length}),
              0.2 + 1e-9);
  }
}

TEST(Outline, BreaksWhereAPointIsNotFinite) {
  const double nan = std::nan("");
  const auto pieces = outline({{nan, 0}, {0, 0}, {1, 0}, {2, 0}, {3, nan}, {4, 0}, {nan, nan}}, 0.1);
  ASSERT_THAT(pieces, SizeIs(2));
  EXPECT_THAT(xOf(pieces[0]), ::testing::ElementsAre(0, 2));
  EXPECT_THAT(xOf(pieces[1]), ::testing::ElementsAre(4));
  EXPECT_THAT(outline({}, 0.1), IsEmpty());
}

}  // namespace
}  // namespace slam::draw

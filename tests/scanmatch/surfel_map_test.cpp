#include "libslam/scanmatch/surfel_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "libslam/scanmatch/scan_points.h"
#include "tests/scanmatch/drawn_rooms.h"
#include "tests/scanmatch/drawn_surfels.h"

namespace slam::scanmatch {
namespace {

using scanmatch_test::aFewPosesAround;
using scanmatch_test::Lidar;
using scanmatch_test::look;
using scanmatch_test::mapOf;
using scanmatch_test::rectangle;
using scanmatch_test::Wall;

TEST(SurfelMap, TellsNothingOfWhereAlongAWallOneStands) {
  const auto map = mapOf(rectangle(-4, -3, 5, 3), aFewPosesAround(0));
  const Surfel* surfel = map.at(1.5 - map.origin().x, 3 - map.origin().y);
  ASSERT_NE(surfel, nullptr);
  EXPECT_NEAR(surfel->y + map.origin().y, 3, 0.02);
  EXPECT_GT(surfel->yy, 300);
  EXPECT_LT(surfel->xx, 1e-2 * surfel->yy);
}

// However little it is turned: that is what a pose graph's matrix is made of.
TEST(SurfelMap, OfAWallNextToParallelToAnAxisHasNoNegativeInformation) {
  for (const bool along_y : {false, true})
    for (double slope = 0.1; slope > 1e-7; slope /= 1.7) {
      std::vector<PatchPoint> wall;
      for (int i = -40; i <= 40; ++i) {
        const double s = 0.025 * i, off = 0.05 + slope * s;
        wall.push_back(along_y ? PatchPoint{static_cast<float>(off), static_cast<float>(s), 0, 0.01F}
                               : PatchPoint{static_cast<float>(s), static_cast<float>(off), 0.01F, 0});
      }
      SurfelMap map(0.1, 0.001);
      map.clear({}, 3);
      map.add(wall, {});
      for (double s = -0.9; s < 0.9; s += 0.1) {
        const double off = 0.05 + slope * s;
        const Surfel* surfel =
            map.at((along_y ? off : s) - map.origin().x, (along_y ? s : off) - map.origin().y);
        ASSERT_NE(surfel, nullptr);
        const double xx = surfel->xx, xy = surfel->xy, yy = surfel->yy;
        ASSERT_GE(xx * yy, xy * xy) << slope << " at " << s;
        // The direction along has what the slope leaves; points are floats.
        const double least = along_y ? yy : xx, most = along_y ? xx : yy;
        if (slope > 1e-4) {
          ASSERT_NEAR(least / most, slope * slope, 0.1 * slope * slope) << slope;
        }
      }
    }
}

TEST(SurfelMap, IsEmptyFarFromSurfacesOutsideAndAfterClear) {
  auto map = mapOf(rectangle(-4, -3, 5, 3), aFewPosesAround(0));
  EXPECT_EQ(map.at(0 - map.origin().x, 0 - map.origin().y), nullptr);
  EXPECT_EQ(map.at(-1, 10), nullptr);
  EXPECT_EQ(map.at(1e300, std::nan("")), nullptr);
  ASSERT_NE(map.at(1.5 - map.origin().x, 3 - map.origin().y), nullptr);
  map.clear({}, 30);
  EXPECT_EQ(map.at(1.5 - map.origin().x, 3 - map.origin().y), nullptr);
}

// On both sides of the plane's origin, where cells are counted from.
TEST(SurfelMap, OfLargerCellsHoldsTheSamePoints) {
  core::RandomStream chance(3, "lidar");
  for (const double centre : {0.0, -50.0, 50.0}) {
    const auto room = rectangle(centre - 4.03, -3.07, centre + 5.02, 3.01);
    SurfelMap fine(0.1, 0.03), larger(0.2, 0.03), direct(0.2, 0.03);
    for (SurfelMap* map : {&fine, &larger, &direct}) map->clear({centre, 0}, 12);
    for (const double phi : {0.0, 1.6, 3.1}) {
      const core::Pose2 T{centre, 0, phi};
      const auto points = patchPoints(look(room, T, {}, chance), {});
      fine.add(points, T);
      direct.add(points, T);
    }
    larger.add(fine);
    int compared = 0;
    for (const double side : {-3.07, 3.01})
      for (double x = centre - 3; x < centre + 4; x += 0.2) {
        const Surfel *a = larger.at(x - larger.origin().x, side - larger.origin().y),
                     *b = direct.at(x - direct.origin().x, side - direct.origin().y);
        ASSERT_EQ(a == nullptr, b == nullptr) << x;
        if (a == nullptr) continue;
        ++compared;
        EXPECT_NEAR(a->x, b->x, 1e-4) << x;
        EXPECT_NEAR(a->y, b->y, 1e-4) << x;
        EXPECT_NEAR(a->yy, b->yy, 1e-3 * b->yy) << x;
        EXPECT_NEAR(a->y + larger.origin().y, side, 0.03) << x;
      }
    EXPECT_GT(compared, 40) << centre;
  }
}

TEST(SurfelMap, KnowsTheFirstOfTheViewsThatSawASurface) {
  core::RandomStream chance(1, "map");
  const auto room = rectangle(-4, -3, 5, 3);
  SurfelMap map(0.1, 0.03, true);
  map.clear({}, 30);
  // Ahead, ahead again, and behind.
  map.add(patchPoints(look(room, {}, {}, chance), {}), {}, 7);
  map.add(patchPoints(look(room, {}, {}, chance), {}), {}, 3);
  const core::Pose2 back{0, 0, core::kPi};
  for (int i = 0; i < 3; ++i) map.add(patchPoints(look(room, back, {}, chance), {}), back, 5);
  const auto firstAt = [&](double x) {
    const Surfel* surfel = map.at(x - map.origin().x, 1 - map.origin().y);
    return surfel ? map.firstViewOf(*surfel) : -1;
  };
  EXPECT_EQ(firstAt(5), 3);
  EXPECT_EQ(firstAt(-4), 5);
}

/// By how much the walls of surfels are turned from a straight one, on average, that a beam struck in every
/// cell; its ranges err by 2 cm. The beams are shared out among so many scans.
double meanTurn_rad(bool widens, size_t scans) {
  const double turned_rad = 0.35, spacing_m = 0.11;
  core::RandomStream chance(7, "sparse wall");
  std::vector<PatchPoint> points;
  for (int i = -60; i <= 60; ++i) {
    const double along = spacing_m * i, across = 0.02 * chance.normal();
    const double c = std::cos(turned_rad), s = std::sin(turned_rad);
    points.push_back(
        {static_cast<float>(c * along - s * across), static_cast<float>(s * along + c * across), 0, 0});
  }
  SurfelMap map(0.1, 0.02, true, widens);
  map.clear({}, 10);
  for (size_t scan = 0; scan < scans; ++scan) {
    std::vector<PatchPoint> seen;
    for (size_t i = scan; i < points.size(); i += scans) seen.push_back(points[i]);
    map.add(seen, {});
  }
  double sum = 0;
  int count = 0;
  for (const auto& point : points)
    if (const Surfel* surfel = map.at(point.x - map.origin().x, point.y - map.origin().y)) {
      // The direction that the information does not hold.
      const double along = 0.5 * std::atan2(-2 * surfel->xy, surfel->yy - surfel->xx);
      sum += std::abs(std::remainder(along - turned_rad, core::kPi)), ++count;
    }
  return sum / count;
}

TEST(SurfelMap, OfFewPointsKnowsWhichWayAWallRunsByAWiderNeighbourhood) {
  EXPECT_LT(meanTurn_rad(true, 2), 0.5 * meanTurn_rad(false, 2));
  EXPECT_LT(meanTurn_rad(true, 2), 0.1);
  // A map of one scan explains wrong places as it is.
  EXPECT_EQ(meanTurn_rad(true, 1), meanTurn_rad(false, 1));
}

// Posts 15 cm apart, each way.
TEST(SurfelMap, OfFewPointsThatAreNoWallIsNotWidened) {
  SurfelMap narrow(0.1, 0.02, true, false), wide(0.1, 0.02, true, true);
  for (SurfelMap* map : {&narrow, &wide}) {
    map->clear({}, 5);
    for (int scan = 0; scan < 2; ++scan) {
      std::vector<PatchPoint> posts;
      for (int x = -8; x < 8; ++x)
        for (int y = -8 + scan; y < 8; y += 2)
          posts.push_back(
              {0.05F + 0.15F * static_cast<float>(x), 0.05F + 0.15F * static_cast<float>(y), 0, 0});
      map->add(posts, {});
    }
  }
  int count = 0;
  for (double x = -0.8; x < 0.8; x += 0.1)
    for (double y = -0.8; y < 0.8; y += 0.1) {
      const Surfel *one = narrow.at(x - narrow.origin().x, y - narrow.origin().y),
                   *other = wide.at(x - wide.origin().x, y - wide.origin().y);
      ASSERT_EQ(one == nullptr, other == nullptr);
      if (one == nullptr) continue;
      EXPECT_EQ(one->xx, other->xx);
      EXPECT_EQ(one->yy, other->yy);
      ++count;
    }
  EXPECT_GT(count, 50);
}

TEST(SurfelMap, LeavesOutPointsBeyondItsReachWithoutHarm) {
  SurfelMap map(0.1, 0.03);
  map.clear({100, -50}, 2);
  std::vector<PatchPoint> points;
  for (int i = -400; i <= 400; ++i) points.push_back({100 + 0.01F * static_cast<float>(i), -50});
  map.add(points, {});
  EXPECT_NE(map.at(101.5 - map.origin().x, -50 - map.origin().y), nullptr);
  EXPECT_EQ(map.at(103.5 - map.origin().x, -50 - map.origin().y), nullptr);
}

}  // namespace
}  // namespace slam::scanmatch

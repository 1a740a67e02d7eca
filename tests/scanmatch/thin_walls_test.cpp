#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "libslam/scanmatch/scan_points.h"
#include "libslam/scanmatch/surfel_matcher.h"
#include "tests/scanmatch/drawn_rooms.h"

namespace slam::scanmatch {
namespace {

using scanmatch_test::aFewPosesAround;
using scanmatch_test::Lidar;
using scanmatch_test::look;
using scanmatch_test::rectangle;
using scanmatch_test::Wall;

/// Two rooms with a wall of 12 cm between them, looked at from both, with 1 cm of noise.
void addTwoRooms(SurfelMap& map, double thickness_m = 0.12, const Lidar& lidar = {}) {
  core::RandomStream chance(1, "map");
  int view = 0;
  const double face = thickness_m / 2;
  const auto left = rectangle(-4, -3, -face, 3), right = rectangle(face, -3, 4, 3);
  for (const double x : {-2.0, 2.0})
    for (const auto& pose : aFewPosesAround(x))
      map.add(patchPoints(look(x < 0 ? left : right, pose, lidar, chance), {}), pose, ++view);
}

SurfelMap mapOfTwoRooms(bool two_sided) {
  SurfelMap map(0.1, 0.03, two_sided);
  map.clear({}, 30);
  addTwoRooms(map);
  return map;
}

TEST(SurfelMap, OfTheCellsOfAFinerOneIsThatOfItsPoints) {
  SurfelMap fine(0.1, 0.03, true), of_points(0.4, 0.1), of_cells(0.4, 0.1);
  for (auto* map : {&fine, &of_points, &of_cells}) map->clear({0.7, -0.3}, 30);
  addTwoRooms(fine), addTwoRooms(of_points);
  of_cells.add(fine);
  ASSERT_DOUBLE_EQ(of_cells.origin().x, of_points.origin().x);
  int surfels = 0;
  for (double x = -5; x < 5; x += 0.2)
    for (double y = -4; y < 4; y += 0.2) {
      const Surfel* expected = of_points.at(x - of_points.origin().x, y - of_points.origin().y);
      const Surfel* found = of_cells.at(x - of_cells.origin().x, y - of_cells.origin().y);
      ASSERT_EQ(found == nullptr, expected == nullptr) << x << " " << y;
      if (expected == nullptr) continue;
      ++surfels;
      EXPECT_NEAR(found->x, expected->x, 1e-5);
      EXPECT_NEAR(found->y, expected->y, 1e-5);
      EXPECT_NEAR(found->xx, expected->xx, 1e-3);
      EXPECT_NEAR(found->xy, expected->xy, 1e-3);
      EXPECT_NEAR(found->yy, expected->yy, 1e-3);
      EXPECT_EQ(of_cells.firstViewOf(*found), of_points.firstViewOf(*expected));
    }
  EXPECT_GT(surfels, 200);
}

TEST(SurfelMap, KeepsTheTwoFacesOfAThinWallApart) {
  const auto map = mapOfTwoRooms(true);
  const auto o = map.origin();
  for (const double x : {-0.06, 0.06}) {
    const Surfel* face = map.facing(x - o.x, 1 - o.y, x, 0).surfel;
    ASSERT_NE(face, nullptr);
    EXPECT_GE(face->back, 0);
    EXPECT_NEAR(face->x + o.x, x, 0.01);
  }
  // Of a wall that was seen from one side alone the other lies about a decimetre behind.
  const Surfel* outer = map.at(-4 - o.x, 1 - o.y);
  ASSERT_NE(outer, nullptr);
  EXPECT_LT(outer->back, 0);
  const auto behind = map.facing(-4 - o.x, 1 - o.y, -1, 0);
  EXPECT_EQ(behind.surfel, outer);
  EXPECT_NEAR(1 / std::sqrt(behind.share * (outer->xx + outer->yy)), 0.1, 0.01);
  // A point that has no normal, or one along the wall, does not lie there.
  for (const auto& [nx, ny] : {std::pair(1.0, 0.0), std::pair(0.0, 0.0), std::pair(-0.1, 1.0)}) {
    const auto facing = map.facing(-4 - o.x, 1 - o.y, nx, ny);
    EXPECT_EQ(facing.surfel, outer);
    EXPECT_EQ(facing.share, 1) << nx << " " << ny;
  }
  // Fused, both lie in the middle.
  const auto fused = mapOfTwoRooms(false);
  const Surfel* middle = fused.facing(-0.06 - o.x, 1 - o.y, -1, 0).surfel;
  ASSERT_NE(middle, nullptr);
  EXPECT_NEAR(middle->x + o.x, 0, 0.03);
}

// Single points of one face often lie beyond the other: their means do not.
TEST(SurfelMap, KeepsTheFacesApartOfAWallThatIsThinForTheNoiseOfRanges) {
  SurfelMap map(0.1, 0.03, true);
  map.clear({}, 30);
  Lidar noisy;
  noisy.noise_m = 0.03;
  addTwoRooms(map, 0.08, noisy);
  const auto o = map.origin();
  for (const double y : {-1.0, 0.0, 1.0})
    for (const double x : {-0.04, 0.04}) {
      const Surfel* face = map.facing(x - o.x, y - o.y, x, 0).surfel;
      ASSERT_NE(face, nullptr);
      EXPECT_NEAR(face->x + o.x, x, 0.02) << y;
    }
}

TEST(SurfelMap, ARoughSurfaceSeenFromAllAroundIsOneThing) {
  // A bush: points all over a disc of 15 cm, with normals to the side from which each was seen, whichever
  // that is.
  core::RandomStream chance(3, "bush");
  SurfelMap map(0.1, 0.03, true);
  map.clear({}, 5);
  std::vector<PatchPoint> points;
  for (int i = 0; i < 400; ++i) {
    const double angle = 2 * core::kPi * chance.uniform();
    points.push_back({static_cast<float>(0.05 * chance.normal()), static_cast<float>(0.05 * chance.normal()),
                      static_cast<float>(0.01 * std::cos(angle)),
                      static_cast<float>(0.01 * std::sin(angle))});
  }
  map.add(points, {});
  const Surfel* surfel = map.at(-map.origin().x, -map.origin().y);
  ASSERT_NE(surfel, nullptr);
  EXPECT_LT(surfel->back, 0);
  for (const double angle : {0.0, 1.5, 3.0, 4.5}) {
    const auto facing = map.facing(-map.origin().x, -map.origin().y, std::cos(angle), std::sin(angle));
    EXPECT_TRUE(facing.surfel == surfel && facing.share == 1) << angle;
  }
}

TEST(SurfelMatcher, IsNotPulledIntoAThinWallByItsOtherFace) {
  // From the narrow end of the left room nothing but the wall between the rooms tells x.
  core::RandomStream chance(9, "query");
  const std::vector<Wall> wall{{{-0.06, -3}, {-0.06, 3}}, {{-4, 3}, {-0.06, 3}}, {{-4, -3}, {-0.06, -3}}};
  const core::Pose2 truth{-1.5, 0.3, 0.2};
  const auto points = patchPoints(look(wall, truth, {}, chance), {});
  PosePrior prior;
  prior.mean = {-1.47, 0.32, 0.21};
  prior.information.diagonal() << 1, 1, 1;
  const auto apart = alignToSurfels(points, mapOfTwoRooms(true), prior.mean, prior, {});
  const auto fused = alignToSurfels(points, mapOfTwoRooms(false), prior.mean, prior, {});
  EXPECT_NEAR(apart.T_map_robot.x, truth.x, 0.006);
  EXPECT_GT(std::abs(fused.T_map_robot.x - truth.x), 0.02) << "nothing to tell: the test is void";
}

// All points on it are off by its thickness alike: however many there are, they do not tell how far off.
TEST(SurfelMatcher, AWallThatWasSeenFromBehindAloneIsNoEvidence) {
  core::RandomStream chance(9, "query");
  SurfelMap map(0.1, 0.03, true);
  map.clear({}, 30);
  for (const auto& pose : aFewPosesAround(-2))
    map.add(patchPoints(look(rectangle(-4, -3, -0.06, 3), pose, {}, chance), {}), pose);
  const core::Pose2 outside{1.5, 0.3, core::kPi}, inside{-1.5, 0.3, 0};
  const std::vector<Wall> from_behind{{{0.06, -3}, {0.06, 3}}}, from_within{{{-0.06, -3}, {-0.06, 3}}};
  const auto evidenceAt = [&](const std::vector<Wall>& wall, const core::Pose2& T) {
    return evidenceOf(patchPoints(look(wall, T, {}, chance), {}), map, T, 4, Walls::kFacing);
  };
  const auto behind = evidenceAt(from_behind, outside), within = evidenceAt(from_within, inside);
  EXPECT_GT(within.information()(0, 0), 1e4);
  EXPECT_LT(behind.information().norm(), 1e-2 * within.information().norm());
  EXPECT_LT(behind.dimensions, 0.1 * within.dimensions) << "nor of how points err";
}

TEST(SurfelMatcher, AWallThatWasSeenFromBehindAlonePullsLittle) {
  // Of the right room the far wall is known, and of the wall between the rooms the left one's side.
  core::RandomStream chance(9, "query");
  const auto left = rectangle(-4, -3, -0.06, 3);
  const std::vector<Wall> far{{{4, -2}, {4, 2}}}, right{{{0.06, -2}, {0.06, 2}}, far[0]};
  const core::Pose2 truth{1.8, 0.3, 1.5};
  const auto points = patchPoints(look(right, truth, {}, chance), {});
  const PosePrior prior{truth, Eigen::Matrix3d::Identity()};
  std::vector<MatchResult> found;
  for (const auto& [two_sided, has_left] : {std::pair(true, true), {false, true}, {true, false}}) {
    SurfelMap map(0.1, 0.03, two_sided);
    map.clear({}, 30);
    for (const auto& pose : aFewPosesAround(-2))
      if (has_left) map.add(patchPoints(look(left, pose, {}, chance), {}), pose);
    for (const auto& pose : aFewPosesAround(2)) map.add(patchPoints(look(far, pose, {}, chance), {}), pose);
    found.push_back(alignToSurfels(points, map, truth, prior, {}));
  }
  EXPECT_NEAR(found[0].T_map_robot.x, truth.x, 0.006);
  EXPECT_LT(found[0].information(0, 0), 1.3 * found[2].information(0, 0));
  EXPECT_GT(std::abs(found[1].T_map_robot.x - truth.x), 0.012) << "nothing pulls: the test is void";
}

}  // namespace
}  // namespace slam::scanmatch

// What keyframes share: which points make a surface, and which do not.
#include "libslam/bundle/shared_surfaces.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/bundle/seen_points.h"

namespace slam::bundle {
namespace {

using namespace test_points;

struct Found {
  std::size_t surfaces = 0;
  std::set<double> rows;
};

Found found(const keyframes::KeyframeMap& map) {
  Found result;
  SharedSurfaces(map).forEach([&](const SharedSurface& surface) {
    ++result.surfaces;
    result.rows.insert(surface.centre.y);
  });
  return result;
}

TEST(SharedSurfaces, LieOnEveryRowOnce) {
  keyframes::KeyframeMap map{keyframes::GraphOptions{}};
  const auto wall = alongY(2.04, -30, 30);
  addSeen(map, {0, 0, 0}, wall, -1);
  addSeen(map, {0, 0, 0}, wall, 0);
  const Found all = found(map);
  EXPECT_EQ(all.surfaces, wall.size()) << "more rows than are looked at at once";
  EXPECT_EQ(all.rows.size(), wall.size());
}

TEST(SharedSurfaces, AreOfMoreThanOneKeyframe) {
  keyframes::KeyframeMap map{keyframes::GraphOptions{}};
  addSeen(map, {0, 0, 0}, alongY(2.04, -3, 0), -1);
  addSeen(map, {0, 0, 0}, alongY(2.04, 1, 4), 0);
  EXPECT_EQ(found(map).surfaces, 0U);
}

// One above the other, as on two floors of a garage: in one place by their poses, and far apart by the way.
TEST(SharedSurfaces, AreOfKeyframesThatHangTogether) {
  keyframes::KeyframeMap map{keyframes::GraphOptions{}};
  const auto wall = alongY(2.04, -3, 3);
  addSeen(map, {0, 0, 0}, wall, -1);
  addSeen(map, {0, 0, 0}, wall, -1);
  EXPECT_EQ(found(map).surfaces, 0U);
  map.link(0, 1);
  EXPECT_EQ(found(map).surfaces, wall.size());
}

TEST(SharedSurfaces, AreSeenFromOneSide) {
  keyframes::KeyframeMap map{keyframes::GraphOptions{}};
  auto wall = alongY(2.04, -3, 3);
  addSeen(map, {0, 0, 0}, wall, -1);
  for (auto& point : wall) point.along_y = -point.along_y;
  addSeen(map, {0, 0, 0}, wall, 0);
  EXPECT_EQ(found(map).surfaces, 0U);
}

// Half of the points in the cells before x = 2, the other half in those behind it.
TEST(SharedSurfaces, TakeAWallsPointsFromAllCellsThatNoisePutsThemIn) {
  keyframes::KeyframeMap map{keyframes::GraphOptions{}};
  auto wall = alongY(1.99, -3, 3);
  addSeen(map, {0, 0, 0}, wall, -1);
  for (auto& point : wall) point.x = 2.02F;
  addSeen(map, {0, 0, 0}, wall, 0);
  EXPECT_EQ(found(map).surfaces, wall.size());
}

TEST(SharedSurfaces, AreFoundWhereverTheyAre) {
  keyframes::KeyframeMap map{keyframes::GraphOptions{}};
  const auto wall = alongY(2.04, -3, 3);
  for (const double y : {-4e6, 0.0, 7e6}) {
    const int first = addSeen(map, {0, y, 0}, wall, map.size() - 1);
    addSeen(map, {0, y, 0}, wall, first);
  }
  EXPECT_EQ(found(map).surfaces, 3 * wall.size());
}

}  // namespace
}  // namespace slam::bundle

// What keyframes share: which points make a surface, and which do not.
#include "libslam/bundle/shared_surfaces.h"

#include <gtest/gtest.h>

#include <array>
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

// A staircase of walls, one for each row of cells.
TEST(SharedSurfaces, AreWholeOnEveryRow) {
  keyframes::KeyframeMap map{keyframes::GraphOptions{}};
  Points before, behind;  // what noise puts into the cells on both sides of a border
  constexpr int kWalls = 300;
  for (int i = 0; i < kWalls; ++i) {
    for (const auto& point : alongX(0.1 * i - 0.01, 1.5 * i, 1.5 * i + 0.95)) before.push_back(point);
    for (const auto& point : alongX(0.1 * i + 0.02, 1.5 * i, 1.5 * i + 0.95)) behind.push_back(point);
  }
  addSeen(map, {0, 0, 0}, before, -1);
  addSeen(map, {0, 0, 0}, behind, 0);
  EXPECT_EQ(found(map).surfaces, before.size());
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

/// A wall along y whose points lie before and behind it by up to so much, by turns.
Points scattered(double x, double by_m, size_t turn) {
  auto wall = alongY(x, -3, 3);
  constexpr std::array<double, 4> kShare{-1, 0.3, -0.3, 1};
  for (size_t i = 0; i < wall.size(); ++i) wall[i].x += static_cast<float>(kShare.at((i + turn) % 4) * by_m);
  return wall;
}

/// Two keyframes that saw one wall with much noise, and another one with so much.
keyframes::KeyframeMap noisy(double others_m) {
  keyframes::KeyframeMap map{keyframes::GraphOptions{}};
  Points first = scattered(2.05, 0.06, 0), second = scattered(2.05, 0.06, 2);
  for (const auto& point : scattered(5.05, others_m, 0)) first.push_back(point);
  for (const auto& point : scattered(5.05, others_m, 2)) second.push_back(point);
  addSeen(map, {0, 0, 0}, first, -1);
  addSeen(map, {0, 0, 0}, second, 0);
  return map;
}

// Three cells beside each other do not tell it from clutter, which would have a surface in every cell and
// hold keyframes along the wall, too.
TEST(SharedSurfaces, AreWallsSeenWithMuchNoise) {
  const auto wall = alongY(2.04, -3, 3);
  EXPECT_EQ(found(noisy(0.02)).surfaces, 2 * wall.size()) << "one for each row of cells";
}

TEST(SharedSurfaces, AreNoWallsMuchThickerThanOthers) {
  const auto wall = alongY(2.04, -3, 3);
  EXPECT_LT(found(noisy(0.002)).surfaces, wall.size() + 10) << "each point is in its own cell";
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

#include "libslam/metrics/map_structure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "libslam/core/random.h"
#include "tests/metrics/drawn.h"

namespace slam::metrics {
namespace {

using core::Point2;
using world::Cell;
using world::CellMap;

CellMap field(double side_m, double resolution_m, Cell cell = Cell::kFree) {
  CellMap map;
  map.resolution_m = resolution_m;
  map.columns = map.rows = static_cast<int>(std::lround(side_m / resolution_m));
  map.cells.assign(static_cast<size_t>(map.columns) * static_cast<size_t>(map.rows), cell);
  return map;
}

/// A straight wall as a rasteriser would draw it: the cells whose centre is within half its thickness.
void drawWall(CellMap& map, const Point2& a, const Point2& b, double thickness_m) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column) {
      const Point2 p{(column + 0.5) * map.resolution_m, (row + 0.5) * map.resolution_m};
      const double along = std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
      if (std::hypot(p.x - a.x - along * dx, p.y - a.y - along * dy) <= thickness_m / 2)
        map.cells[static_cast<size_t>(row) * static_cast<size_t>(map.columns) + static_cast<size_t>(column)] =
            Cell::kOccupied;
    }
}

void drawRoom(CellMap& map, const core::Pose2& T_map_room, double width_m, double height_m,
              double thickness_m) {
  const std::vector<Point2> corners = {{-width_m / 2, -height_m / 2},
                                       {width_m / 2, -height_m / 2},
                                       {width_m / 2, height_m / 2},
                                       {-width_m / 2, height_m / 2}};
  for (size_t i = 0; i < 4; ++i)
    drawWall(map, T_map_room * corners[i], T_map_room * corners[(i + 1) % 4], thickness_m);
}

/// The map turned by a quarter.
CellMap turned(const CellMap& map) {
  CellMap result = map;
  std::swap(result.columns, result.rows);
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column)
      result.cells[static_cast<size_t>(column) * static_cast<size_t>(result.columns) +
                   static_cast<size_t>(map.rows - 1 - row)] = map.at(column, row);
  return result;
}

CellMap mirrored(const CellMap& map) {
  CellMap result = map;
  for (int row = 0; row < map.rows; ++row) {
    const auto begin = result.cells.begin() + static_cast<std::ptrdiff_t>(row) * map.columns;
    std::reverse(begin, begin + map.columns);
  }
  return result;
}

TEST(MapStructure, CountsOccupiedCellsAmongTheKnownOnes) {
  const auto structure = mapStructure(drawn({"????", "##..", "?..."}));
  EXPECT_EQ(structure.occupied_share, 2.0 / 7);
  EXPECT_EQ(mapStructure(drawn({"#?"})).occupied_share, 1);
  EXPECT_EQ(mapStructure(drawn({".?"})).occupied_share, 0);
}

// What a reader counts in the drawing, whatever the angle, the walls' thickness and the cells: a square room
// has four corners and an area shut in; where two walls meet or one ends is a corner too.
TEST(MapStructure, CountsCornersEndsAndCrossingsOfWallsAtAnyAngle) {
  for (const double resolution_m : {0.05, 0.1})
    for (const double thickness_cells : {1.42, 2.2, 4.0})
      for (const double angle_deg : {0.0, 10.0, 30.0, 45.0, 77.0}) {
        SCOPED_TRACE(::testing::Message()
                     << resolution_m << " m, " << thickness_cells << " cells, " << angle_deg << " deg");
        const core::Pose2 T{5.012, 4.987, core::degToRad(angle_deg)};
        const double thickness_m = thickness_cells * resolution_m;
        CellMap room = field(10, resolution_m);
        drawRoom(room, T, 4, 4, thickness_m);
        EXPECT_EQ(mapStructure(room).corners, 4U);
        EXPECT_EQ(mapStructure(room).enclosed_areas, 1U);

        CellMap walls = field(10, resolution_m);
        drawWall(walls, T * Point2{-3, 0}, T * Point2{3, 0}, thickness_m);
        EXPECT_EQ(mapStructure(walls).corners, 2U);  // its ends
        drawWall(walls, T * Point2{0, 0}, T * Point2{0, 3}, thickness_m);
        EXPECT_EQ(mapStructure(walls).corners, 4U);  // and a junction, and one more end
        drawWall(walls, T * Point2{0, 0}, T * Point2{0, -3}, thickness_m);
        EXPECT_EQ(mapStructure(walls).corners, 5U);
        EXPECT_EQ(mapStructure(walls).enclosed_areas, 0U);
      }
}

// What the measures are for: a second visit drawn 1 m and 4 degrees off.
TEST(MapStructure, GrowsInEveryMeasureWhenARoomIsDrawnTwice) {
  CellMap once = field(12, 0.05, Cell::kFree);
  drawRoom(once, {6, 6, 0.1}, 6, 4, 0.1);
  CellMap twice = once;
  drawRoom(twice, {7, 6.8, 0.17}, 6, 4, 0.1);
  const auto clean = mapStructure(once), blurred = mapStructure(twice);
  EXPECT_GT(blurred.occupied_share, 1.5 * clean.occupied_share);
  EXPECT_GE(blurred.corners, clean.corners + 4);
  EXPECT_GE(blurred.enclosed_areas, clean.enclosed_areas + 2);
}

// What they cannot see, as the header says.
TEST(MapStructure, IsBlindToAMapThatIsBentAsAWhole) {
  CellMap straight = field(12, 0.05), bent = field(12, 0.05);
  drawRoom(straight, {6, 6, 0}, 8, 4, 0.11);
  for (const auto& [a, b] : std::vector<std::pair<Point2, Point2>>{
           {{2, 3}, {10, 4}}, {{10, 4}, {10, 8}}, {{10, 8}, {2, 9}}, {{2, 9}, {2, 3}}})
    drawWall(bent, a, b, 0.11);
  EXPECT_EQ(mapStructure(straight).corners, mapStructure(bent).corners);
  EXPECT_EQ(mapStructure(straight).enclosed_areas, mapStructure(bent).enclosed_areas);
  // Longer walls around a larger area: the share alone moves, by what the outline moved.
  EXPECT_NEAR(mapStructure(straight).occupied_share, mapStructure(bent).occupied_share, 0.005);
}

TEST(MapStructure, TakesNoSpeckForACorner) {
  const auto block = [](int cells) {
    CellMap map = field(3, 0.1);
    for (int row = 10; row < 10 + cells; ++row)
      for (int column = 10; column < 10 + cells; ++column)
        map.cells[static_cast<size_t>(row) * 30 + static_cast<size_t>(column)] = Cell::kOccupied;
    return mapStructure(map);
  };
  EXPECT_EQ(block(1).corners, 0U);
  EXPECT_EQ(block(3).corners, 0U);  // 0.3 m, the limit
  EXPECT_GT(block(4).corners, 0U);
  EXPECT_EQ(block(3).occupied_share, 9.0 / 900);  // specks are occupied all the same
}

TEST(MapStructure, CountsAreasShutInButForTheLargestAndForSlivers) {
  // 0.1 m cells: five of them are 0.05 m2, the limit.
  EXPECT_EQ(mapStructure(drawn({"..........", "##########", ".....#....", "##########"})).enclosed_areas, 1U);
  EXPECT_EQ(mapStructure(drawn({"..........", "##########", "....#....#", "##########"})).enclosed_areas, 0U);
  // Unknown cells shut in as walls do, and so does a diagonal.
  EXPECT_EQ(mapStructure(drawn({".....???", ".....???", "?????...", "?????..."})).enclosed_areas, 1U);
  EXPECT_EQ(mapStructure(drawn({".....???", ".....???", "????....", "????...."})).enclosed_areas, 0U);
}

TEST(MapStructure, IsTheSameForATurnedAMirroredAndAPaddedMap) {
  core::RandomStream random(7, "walls");
  for (int scene = 0; scene < 5; ++scene) {
    CellMap map = field(7, 0.05, Cell::kUnknown);
    map.rows -= 20;
    map.cells.resize(static_cast<size_t>(map.rows) * static_cast<size_t>(map.columns));
    for (int i = 0; i < 3000; ++i)
      map.cells[static_cast<size_t>(random.uniform(0, 1) * static_cast<double>(map.cells.size()))] =
          Cell::kFree;
    for (int wall = 0; wall < 12; ++wall)
      drawWall(map, {random.uniform(0, 7), random.uniform(0, 6)},
               {random.uniform(0, 7), random.uniform(0, 6)}, random.uniform(0.07, 0.2));
    const auto expected = mapStructure(map);
    EXPECT_GT(expected.corners, 10U);
    CellMap other = map;
    for (int quarter = 0; quarter < 4; ++quarter) {
      other = turned(other);
      for (const CellMap& image : {other, mirrored(other)}) {
        EXPECT_EQ(mapStructure(image).occupied_share, expected.occupied_share);
        EXPECT_EQ(mapStructure(image).corners, expected.corners);
        EXPECT_EQ(mapStructure(image).enclosed_areas, expected.enclosed_areas);
      }
    }
    // 37 columns of padding also move every wall against the tiles that the corners are sought in.
    CellMap padded = field(9, 0.05, Cell::kUnknown);
    for (int row = 0; row < map.rows; ++row)
      for (int column = 0; column < map.columns; ++column)
        padded.cells[static_cast<size_t>(row + 21) * static_cast<size_t>(padded.columns) +
                     static_cast<size_t>(column + 37)] = map.at(column, row);
    EXPECT_EQ(mapStructure(padded).corners, expected.corners);
    EXPECT_EQ(mapStructure(padded).enclosed_areas, expected.enclosed_areas);
  }
}

TEST(MapStructure, OfAMapThatKnowsNothingIsNothing) {
  for (const CellMap& map : {CellMap{}, CellMap(drawn({"??", "??"}))}) {
    EXPECT_TRUE(std::isnan(mapStructure(map).occupied_share));
    EXPECT_EQ(mapStructure(map).corners, 0U);
    EXPECT_EQ(mapStructure(map).enclosed_areas, 0U);
  }
  EXPECT_EQ(mapStructure(drawn({"."})).enclosed_areas, 0U);
  EXPECT_EQ(mapStructure(drawn({"#"})).corners, 0U);
}

}  // namespace
}  // namespace slam::metrics

#include "libslam/pictures/picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "libslam/core/error.h"
#include "libslam/draw/map_view.h"
#include "libslam/resources/file_hash.h"
#include "libslam/testing/temp_folder.h"
#include "tests/pictures/read_picture.h"

namespace slam::pictures {
namespace {

using testing::TempFolder;
using world::Cell;

/// A room of 8 x 4 m in walls of 0.2 m, its lower left corner at the world's origin.
world::Plan room(int columns = 160, int rows = 80) {
  world::Plan plan;
  plan.name = "room";
  plan.columns = columns, plan.rows = rows, plan.resolution_m = 0.05;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const bool inside = column >= 4 && row >= 4 && column < columns - 4 && row < rows - 4;
      plan.cells.push_back(inside ? Cell::kFree : Cell::kOccupied);
    }
  return plan;
}

core::Trajectory straight(double x0, double x1, double y) {
  core::Trajectory path;
  for (int i = 0; i <= 20; ++i) path.push_back({0.1 * i, {x0 + (x1 - x0) * i / 20, y, 0}});
  return path;
}

/// The smallest box round all pixels of that colour.
cv::Rect extentOf(const cv::Mat& image, draw::Colour colour) {
  cv::Mat mask;
  cv::inRange(image, cv::Scalar(colour.blue, colour.green, colour.red),
              cv::Scalar(colour.blue, colour.green, colour.red), mask);
  std::vector<cv::Point> places;
  cv::findNonZero(mask, places);
  cv::Rect extent;
  for (const auto& place : places) extent |= cv::Rect(place, cv::Size(1, 1));
  return extent;
}

TEST(Pictures, HaveTheSameBytesForTheSameInput) {
  const TempFolder folder;
  const auto plan = room();
  lidar::Scan scan;
  scan.first_angle_rad = -1, scan.step_rad = 0.1, scan.max_range_m = 5;
  scan.ranges_m = {1, 2, lidar::kNoReturn, lidar::kLostReading, 3};
  for (const std::string name : {"a", "b"}) {
    drawMap(plan, {{straight(1, 7, 2), "true path", true}}, "Room", folder / (name + "plan.png"));
    drawDifference(plan, plan, {0.3, 0, 0}, "Room", folder / (name + "difference.png"));
    drawPanels({{"icp", "ATE 0.1 m", plan, {}, {{straight(1, 7, 2), "icp"}}}},
               folder / (name + "panels.png"));
    drawScan(scan, folder / (name + "scan.png"));
  }
  for (const std::string kind : {"plan", "difference", "panels", "scan"})
    EXPECT_EQ(resources::fileSha256(folder / ("a" + kind + ".png")),
              resources::fileSha256(folder / ("b" + kind + ".png")));
}

TEST(DrawMap, ShowsWallsFreeSpaceAndPathsInTheirPlaces) {
  const TempFolder folder;
  auto plan = room();
  for (int row = 66; row < 72; ++row)  // a pillar at (6, 3.45)
    for (int column = 117; column < 123; ++column)
      plan.cells[static_cast<size_t>(row) * 160 + column] = Cell::kOccupied;
  drawMap(
      plan,
      {{straight(1, 7, 3), "first"}, {straight(1, 7, 1), "true path", true}, {straight(1, 7, 2), "second"}},
      "Room", folder / "plan.png");
  const auto image = load(folder / "plan.png");
  // The outer face of the walls gives the scale: 8 m from the first to the last dark column of the map. The
  // walls are by far the largest dark thing.
  cv::Mat upper = image(cv::Rect(0, 66, image.cols, image.rows - 66 - 50));  // without title and legend
  const auto walls = extentOf(upper, draw::kWall);
  const double pixels_per_metre = walls.width / 8.0;
  EXPECT_NEAR(walls.height, 4 * pixels_per_metre, 3);  // rounding of either end
  const auto at = [&](double x, double y) {
    return upper.at<cv::Vec3b>(static_cast<int>(walls.y + walls.height - y * pixels_per_metre),
                               static_cast<int>(walls.x + x * pixels_per_metre));
  };
  EXPECT_TRUE(isColour(at(0.1, 2), draw::kWall));
  EXPECT_TRUE(isColour(at(4, 3.9), draw::kWall));
  EXPECT_TRUE(isColour(at(6, 3.45), draw::kWall));
  EXPECT_TRUE(isColour(at(6, 0.55), draw::kFree));
  EXPECT_TRUE(isColour(at(4, 2.5), draw::kFree));
  EXPECT_TRUE(isColour(at(4, 3), draw::lineColours()[0]));
  EXPECT_TRUE(isColour(at(4, 2), draw::lineColours()[1]));
  // The truth is dashed: along its line there is ink and there is free space.
  int ink = 0, free = 0;
  for (double x = 2; x < 6; x += 0.01)
    ink += at(x, 1)[0] < 200 ? 1 : 0, free += isColour(at(x, 1), draw::kFree) ? 1 : 0;
  EXPECT_GT(ink, 100);
  EXPECT_GT(free, 100);
}

TEST(DrawMap, DrawsTheTruthAsDashesOverTheEstimates) {
  const TempFolder folder;
  drawMap(room(), {{straight(1, 7, 2), "estimate"}, {straight(1, 7, 2), "truth", true}}, "",
          folder / "plan.png");
  const auto image = load(folder / "plan.png");
  // 6 m of about 145 pixels each; half of them lie under a dash, whose edges are mixed with what lies below.
  EXPECT_GT(countOf(image, draw::lineColours()[0]), 800);
  EXPECT_GT(countOf(image, draw::kInk), 200);
  drawMap(room(), {{straight(1, 7, 2), "truth", true}}, "", folder / "alone.png");
  EXPECT_GT(countOf(load(folder / "alone.png"), draw::kTruthPath), 4 * 800)
      << "nothing lies below: it is broad";
}

TEST(DrawMap, DashesEndWhereAPoseIsNotFinite) {
  const TempFolder folder;
  auto broken = straight(1, 7, 2);
  for (auto& stamped : broken)
    if (stamped.pose.x > 2 && stamped.pose.x < 6) stamped.pose.x = std::nan("");
  const auto inkOf = [&](const core::Trajectory& truth) {
    drawMap(room(), {{straight(1, 7, 3), "estimate"}, {truth, "truth", true}}, "", folder / "plan.png");
    return countOf(load(folder / "plan.png"), draw::kInk);
  };
  const int legend = inkOf({});
  EXPECT_LT(inkOf(broken) - legend, 0.6 * (inkOf(straight(1, 7, 2)) - legend));
}

TEST(DrawMap, APathOfBlackIsSeenOnWalls) {
  const TempFolder folder;
  drawMap(room(), {{straight(1, 7, 2), "naive"}}, "", folder / "plan.png");
  EXPECT_EQ(countOf(load(folder / "plan.png"), {0, 0, 0}), 0);
}

TEST(PathPanels, ShowEveryPathByItselfWithTheTruth) {
  const auto panels = pathPanels(
      room(),
      {{straight(1, 7, 3), "icp"}, {straight(1, 7, 1), "true path", true}, {straight(1, 7, 2), "graph"}});
  ASSERT_EQ(panels.size(), 2U);
  EXPECT_EQ(panels[0].title, "icp");
  EXPECT_EQ(panels[1].title, "graph");
  for (const auto& panel : panels) {
    ASSERT_EQ(panel.paths.size(), 2U);
    EXPECT_TRUE(panel.paths[1].is_truth);
  }
}

TEST(DrawMap, FollowsAPlanThatIsTurned) {
  const TempFolder folder;
  auto turned = room();
  turned.T_frame_raster = {100, 50, core::kPi / 2};
  drawMap(turned, {}, "", folder / "turned.png");
  const auto image = load(folder / "turned.png");
  const auto walls = extentOf(image, draw::kWall);
  EXPECT_NEAR(walls.height, 2.0 * walls.width, 6);  // now taller than wide
}

TEST(DrawMap, SurvivesPathsThatAreEmptyShortNotFiniteOrFarAway) {
  const TempFolder folder;
  auto broken = straight(1, 7, 2);
  broken[10].pose.x = std::nan("");
  broken[20].pose.x = 1e300;
  drawMap(
      room(),
      {{{}, "empty"}, {{{0, {2, 2, 0}}}, "one pose"}, {broken, "broken"}, {straight(1e6, 2e6, 0), "far"}},
      "A title that is far longer than the picture is wide, so that it has to be cut somewhere near its end, "
      "ü",
      folder / "plan.png");
  const auto image = load(folder / "plan.png");
  EXPECT_GT(countOf(image, draw::lineColours()[2]), 200);
  EXPECT_GT(extentOf(image, draw::kWall).width,
            1000);  // the far path is cut: the room still fills the picture
}

TEST(DrawMap, BreaksAPathWhereAPoseIsNotFinite) {
  const TempFolder folder;
  auto broken = straight(1, 7, 2);
  for (size_t i = 5; i < 15; ++i) broken[i].pose.y = std::nan("");
  drawMap(room(), {{straight(1, 7, 2), "whole"}}, "", folder / "whole.png");
  drawMap(room(), {{broken, "broken"}}, "", folder / "broken.png");
  const double whole = countOf(load(folder / "whole.png"), draw::lineColours()[0]);
  // 9 of 20 segments remain, and the sample in the legend.
  EXPECT_NEAR(countOf(load(folder / "broken.png"), draw::lineColours()[0]) / whole, 9.0 / 20, 0.07);
}

TEST(DrawMap, KeepsThinWallsOfALargePlan) {
  const TempFolder folder;
  world::Plan large;
  large.columns = 4000, large.rows = 2001;
  large.cells.assign(size_t{4000} * 2001, Cell::kFree);
  for (int column = 0; column < 4000; ++column)
    for (const int row : {0, 1000, 2000})
      large.cells[static_cast<size_t>(row) * 4000 + column] = Cell::kOccupied;
  drawMap(large, {}, "", folder / "large.png");
  const auto image = load(folder / "large.png");
  int dark_rows = 0;
  for (int y = 0; y < image.rows - 60; ++y) dark_rows += image.at<cv::Vec3b>(y, image.cols / 2)[0] < 150;
  EXPECT_GE(dark_rows, 3);
}

TEST(DrawDifference, OfAPlanFromItselfHasNoDisagreement) {
  const TempFolder folder;
  drawDifference(room(), room(), {}, "", folder / "same.png");
  const auto same = load(folder / "same.png");
  EXPECT_LT(countOf(same, draw::kVermillion), 400);  // the box in the legend alone: 18 x 16 pixels
  EXPECT_LT(countOf(same, draw::kBlue), 400);
}

TEST(DrawDifference, MarksWallsThatOnlyOneSideHas) {
  const TempFolder folder;
  drawDifference(room(), room(), {1, 0, 0}, "", folder / "shifted.png");
  const auto shifted = load(folder / "shifted.png");
  EXPECT_GT(countOf(shifted, draw::kVermillion),
            5000);  // two walls 0.2 x 4 m at 140 pixels per metre, in part
  EXPECT_GT(countOf(shifted, draw::kBlue), 2000);
  drawDifference(room(), room(), {std::nan(""), 0, 0}, "", folder / "lost.png");
  EXPECT_GT(countOf(load(folder / "lost.png"), draw::kBlue), 2000);
}

/// Everything of the plan's size is unseen but the columns up to `last_column`.
metrics::SeenMask seenUpTo(const world::Plan& plan, int last_column) {
  metrics::SeenMask seen{plan.columns, plan.rows, {}, {}};
  for (int row = 0; row < plan.rows; ++row)
    for (int column = 0; column < plan.columns; ++column) {
      seen.wall.push_back(column <= last_column && plan.at(column, row) == Cell::kOccupied);
      seen.free.push_back(column <= last_column && plan.at(column, row) == Cell::kFree);
    }
  return seen;
}

TEST(DrawDifference, KeepsWallsThatWereNeverInViewApartFromMissedOnes) {
  constexpr draw::Colour kUnseen{160, 168, 176};
  const TempFolder folder;
  const auto plan = room();
  auto map = room();  // nothing but unknown
  std::fill(map.cells.begin(), map.cells.end(), Cell::kUnknown);
  const auto seen = seenUpTo(plan, 79);
  drawDifference(plan, map, {}, "", folder / "masked.png", &seen);
  drawDifference(plan, map, {}, "", folder / "plain.png");
  const auto masked = load(folder / "masked.png"), plain = load(folder / "plain.png");
  EXPECT_EQ(countOf(plain, kUnseen), 0);
  // Without title the map begins at the same place; the legend's row is below both.
  const cv::Rect map_area(0, 0, plain.cols, plain.rows - 90);
  const auto missed = extentOf(masked(map_area), draw::kBlue), unseen = extentOf(masked(map_area), kUnseen);
  const auto all = extentOf(plain(map_area), draw::kBlue);
  EXPECT_EQ(missed.x, all.x);
  EXPECT_NEAR(missed.x + missed.width, unseen.x, 2);  // the border between the two, averaged over a pixel
  EXPECT_EQ(unseen.x + unseen.width, all.x + all.width);
  EXPECT_NEAR(missed.width, unseen.width, 3);  // half of the room each
}

TEST(DrawDifference, ShowsAWallThatTheMapHasWhetherItWasInViewOrNot) {
  const TempFolder folder;
  const auto nothing_seen = seenUpTo(room(), -1);
  drawDifference(room(), room(), {}, "", folder / "same.png", &nothing_seen);
  drawDifference(room(), room(), {}, "", folder / "plain.png");
  EXPECT_NEAR(countOf(load(folder / "same.png"), draw::kWall),
              countOf(load(folder / "plain.png"), draw::kWall), 10);
  const auto other = seenUpTo(room(100, 80), -1);
  EXPECT_THROW(drawDifference(room(), room(), {}, "", folder / "no.png", &other), core::ContractError);
  EXPECT_FALSE(std::filesystem::exists(folder / "no.png"));
}

TEST(DrawPanels, ArrangesOneToEightPanelsOfAnyShape) {
  const TempFolder folder;
  for (const auto& [columns, rows] : {std::pair{160, 80}, {800, 30}, {30, 800}})
    for (const int count : {1, 2, 5, 8}) {
      std::vector<Panel> panels;
      panels.reserve(static_cast<size_t>(count));
      for (int i = 0; i < count; ++i)
        panels.push_back({"method " + std::to_string(i),
                          "ATE 0.1 m",
                          room(columns, rows),
                          {},
                          {{straight(0.5, 1, 0.7), "true path", true}, {straight(0.5, 1, 0.8), "estimate"}}});
      drawPanels(panels, folder / "panels.png");
      const auto image = load(folder / "panels.png");
      EXPECT_GT(countOf(image, draw::kWall), 100 * count);
      EXPECT_GT(countOf(image, draw::lineColours()[0]), 5 * count);
    }
}

TEST(DrawPanels, ShowsPathsWithoutMapsAndMapsWithoutPaths) {
  const TempFolder folder;
  world::Plan none;
  drawPanels({{"a", "", none, {}, {{straight(0, 5, 1), "estimate"}}}, {"b", "", room(), {}, {}}},
             folder / "panels.png");
  const auto image = load(folder / "panels.png");
  EXPECT_GT(countOf(image, draw::kWall), 1000);
  EXPECT_GT(countOf(image, draw::lineColours()[0]), 100);
  drawPanels({{"a", "", none, {std::nan(""), 0, 0}, {}}}, folder / "nothing.png");
  load(folder / "nothing.png");
}

TEST(DrawPanels, IsNotShrunkByOneMapThatWentAstray) {
  const TempFolder folder;
  const auto with = [&](double shift_m, const std::string& name) {
    drawPanels({{"a", "", room(), {}, {}}, {"b", "", room(), {}, {}}, {"c", "", room(), {shift_m, 0, 0}, {}}},
               folder / name);
    return countOf(load(folder / name), draw::kWall);
  };
  const int good = with(0, "good.png");
  EXPECT_GT(with(1000, "right.png"), good / 2);
  EXPECT_GT(with(-1000, "left.png"), good / 2);
}

TEST(CommonWindow, ShowsAllOfMapsThatDifferALittle) {
  const draw::Window one{0, 0, 100, 100}, wider{-10, 0, 100, 112}, astray{0, 0, 5000, 100};
  const auto both = draw::commonWindow({one, wider}, {}, {});
  EXPECT_LT(both.x0, -10);
  EXPECT_GT(both.y1, 112);
  EXPECT_LT(both.x1, 110);
  EXPECT_LT(draw::commonWindow({one, one, astray}, {}, {}).x1, 110);
}

// A plan that is larger than its neighbours is shown whole: only then do walls stand in its part of the
// picture.
TEST(DrawPanels, ShowsTruePlansWholeHoweverUnlikeTheirSizes) {
  const TempFolder folder;
  world::Plan yard;
  yard.columns = yard.rows = 400;
  yard.resolution_m = room().resolution_m;
  yard.cells.assign(size_t{400} * 400, world::Cell::kFree);
  for (int i = 0; i < 400; ++i)
    for (const int k : {i, 399 * 400 + i, i * 400, i * 400 + 399})
      yard.cells[static_cast<size_t>(k)] = world::Cell::kOccupied;
  const core::Pose2 T_world_yard{-200 * yard.resolution_m, -200 * yard.resolution_m, 0};
  const auto wallsWith = [&](bool is_true, const std::string& name) {
    drawPanels({{"yard", "", yard, T_world_yard, {}, is_true},
                {"a", "", room(), {}, {}, is_true},
                {"b", "", room(), {}, {}, is_true}},
               folder / name);
    const cv::Mat picture = load(folder / name);
    return countOf(picture(cv::Rect(0, 0, picture.cols / 3, picture.rows / 2)), draw::kWall);
  };
  EXPECT_EQ(wallsWith(false, "cut.png"), 0);
  EXPECT_GT(wallsWith(true, "whole.png"), 100);
}

TEST(DrawPanels, RefusesNoneAndMoreThanEight) {
  const TempFolder folder;
  EXPECT_THROW(drawPanels({}, folder / "none.png"), core::ContractError);
  EXPECT_THROW(drawPanels(std::vector<Panel>(9), folder / "nine.png"), core::ContractError);
}

TEST(Pictures, ThatCannotBeWrittenAreAnErrorAndLeaveNothing) {
  const TempFolder folder;
  const auto path = folder / "missing/plan.png";
  try {
    drawMap(room(), {}, "", path);
    FAIL() << "expected an error";
  } catch (const core::IoError& e) {
    EXPECT_EQ(std::string(e.what()).rfind(path + ": cannot be written: ", 0), 0U) << e.what();
  }
  EXPECT_THROW(drawScan({}, path), core::IoError);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(NiceStep, IsOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_EQ(draw::niceStep(10), 10);
  EXPECT_EQ(draw::niceStep(9.9), 5);
  EXPECT_EQ(draw::niceStep(4.9), 2);
  EXPECT_EQ(draw::niceStep(1.9), 1);
  EXPECT_EQ(draw::stepLabel(draw::niceStep(0.07)), "0.05");
  EXPECT_EQ(draw::stepLabel(3 * draw::niceStep(0.1)), "0.3");
}

}  // namespace
}  // namespace slam::pictures

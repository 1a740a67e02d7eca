#include "libslam/draw/map_view.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include "tests/world/drawn_plan.h"

namespace slam::draw {
namespace {

using core::kNaN;

void expectWindow(const Window& window, double x0, double y0, double x1, double y1) {
  EXPECT_NEAR(window.x0, x0, 1e-9);
  EXPECT_NEAR(window.y0, y0, 1e-9);
  EXPECT_NEAR(window.x1, x1, 1e-9);
  EXPECT_NEAR(window.y1, y1, 1e-9);
}

TEST(Window, HoldsWhatWasPutIn) {
  Window window;
  EXPECT_TRUE(window.isEmpty());
  window.include(core::Point2{kNaN, 1});
  window.include(Window{});
  EXPECT_TRUE(window.isEmpty());
  window.include(core::Point2{-2, -3});
  EXPECT_FALSE(window.isEmpty());
  expectWindow(window, -2, -3, -2, -3);
  window.include(core::Point2{-5, 4});
  window.include(Window{0, 0, 1, 1});
  expectWindow(window, -5, -3, 1, 4);
}

TEST(Window, GrowsByItsLongerSideAndIsCutToAnother) {
  const Window window{0, 0, 10, 2};
  expectWindow(window.grownBy(0.1), -1, -1, 11, 3);
  EXPECT_TRUE(Window{}.grownBy(0.1).isEmpty());
  expectWindow(window.cutTo({5, -4, 20, 1}), 5, 0, 10, 1);
  EXPECT_TRUE(window.cutTo({11, 0, 12, 1}).isEmpty());
}

TEST(Window, OfARasterIsItsWallsAsItLiesInTheWorld) {
  const auto plan = world::drawnPlan({"........", ".####...", ".#......", "........"}, 0.5);
  // Centres of the walls: columns 1 to 4, rows 1 and 2 from the bottom.
  expectWindow(windowOf(plan, {}), 0.75, 0.75, 2.25, 1.25);
  expectWindow(windowOf(plan, {10, 20, core::kPi / 2}), 10 - 1.25, 20.75, 10 - 0.75, 22.25);
  expectWindow(windowOf(world::drawnPlan({"??", "?.", "??"}), {}), 1.5, 1.5, 1.5, 1.5);
  EXPECT_TRUE(windowOf(world::drawnPlan({"??"}), {}).isEmpty());
}

TEST(Window, OfAPathLeavesOutWhereItIsBroken) {
  expectWindow(windowOf({{0, {1, 2, 0}}, {1, {kNaN, kNaN, 0}}, {2, {-1, 5, 0}}}), -1, 2, 1, 5);
}

TEST(Window, APictureHasAnArea) {
  const Window nothing = usable({});
  EXPECT_GE(nothing.width(), 0.5);
  EXPECT_GE(nothing.height(), 0.5);
  const Window line = usable({0, 3, 100, 3});
  EXPECT_GE(line.height(), 5);
  EXPECT_NEAR((line.y0 + line.y1) / 2, 3, 1e-9) << "in its middle";
  EXPECT_GT(line.x1, 100);
  EXPECT_LT(line.x1, 105);
}

TEST(Window, EstimatesThatWentAstrayWidenItByATenth) {
  const Window truth{0, 0, 20, 10};
  expectWindow(withEstimates(truth, {-1, 1, 21, 9}), -1, 0, 21, 10);
  expectWindow(withEstimates(truth, {-500, 1, 300, 9}), -2, 0, 22, 10);
  expectWindow(withEstimates(truth, {100, 100, 110, 110}), 0, 0, 20, 10);
  expectWindow(withEstimates({}, {5, 5, 6, 7}), 5, 5, 6, 7);
}

TEST(Window, SidesAreThoseOfHalfOfTheMapsOrALittleFartherOut) {
  const Window a{0, 0, 20, 10}, wider{-1, -0.5, 21, 10.5}, astray{-400, 0, 20, 900};
  expectWindow(commonWindow({a, a, wider}, {}, {}), -1 - 0.55, -0.5 - 0.55, 21 + 0.55, 10.5 + 0.55);
  const Window window = commonWindow({a, astray, wider}, {}, {});
  EXPECT_GT(window.x0, -4);
  EXPECT_LT(window.y1, 14);
  // All of the truth is shown, whatever the maps are.
  const Window with_truth = commonWindow({a, a}, {0, 0, 40, 10}, {});
  EXPECT_GE(with_truth.x1, 40);
  expectWindow(commonWindow({{}, {}}, {0, 0, 20, 10}, {}), -0.5, -0.5, 20.5, 10.5);
  // One map of two does not shrink the other.
  EXPECT_GE(commonWindow({a, {}}, {}, {}).x1, 20);
}

TEST(MapView, HasItsYAxisUp) {
  const MapView view{{-1, 2, 3, 4}, {100, 50, 400, 200}};
  EXPECT_DOUBLE_EQ(view.pixelsPerMetre(), 100);
  const Pixel lower_left = view.toPixel({-1, 2}), upper_right = view.toPixel({3, 4});
  EXPECT_DOUBLE_EQ(lower_left.x, 100);
  EXPECT_DOUBLE_EQ(lower_left.y, 250);
  EXPECT_DOUBLE_EQ(upper_right.x, 500);
  EXPECT_DOUBLE_EQ(upper_right.y, 50);
  const core::Point2 back = view.toWorld(view.toPixel({0.3, 3.7}));
  EXPECT_NEAR(back.x, 0.3, 1e-12);
  EXPECT_NEAR(back.y, 3.7, 1e-12);
}

/// Column + 10 * row of each cell of 4 x 3, a metre each.
LabelRaster numbered(const core::Pose2& T_world_raster) {
  return LabelRaster(world::drawnPlan({"....", "....", "...."}), T_world_raster,
                     [](int column, int row) { return static_cast<unsigned char>(column + 10 * row); });
}

TEST(LabelRaster, IsAskedInTheWorld) {
  const auto raster = numbered({});
  EXPECT_EQ(raster.at({2.5, 1.5}, 0), 12);
  EXPECT_EQ(raster.at({2.01, 1.99}, 0.9), 12) << "a square within a cell asks for the point";
  EXPECT_EQ(raster.at({-0.1, 1}, 0), 0);
  EXPECT_EQ(raster.at({4.1, 1}, 0), 0);
  EXPECT_EQ(raster.at({1e12, -1e12}, 0), 0);
  EXPECT_EQ(LabelRaster().at({0, 0}, 1), 0);
  // Turned by a quarter about (10, 10): its x goes up, its y to the left.
  const auto turned = numbered({10, 10, core::kPi / 2});
  EXPECT_EQ(turned.at({8.5, 12.5}, 0), 12);
  EXPECT_EQ(turned.at({11, 12}, 0), 0);
}

TEST(LabelRaster, ShowsTheHighestOfASquare) {
  const auto raster = numbered({});
  EXPECT_EQ(raster.at({1, 1}, 1.5), 11);
  EXPECT_EQ(raster.at({1.5, 1.5}, 2.2), 22);
  EXPECT_EQ(raster.at({0, 0}, 1.5), 0);
  EXPECT_EQ(raster.at({5, 2.5}, 3), 23) << "what reaches in counts";
}

}  // namespace
}  // namespace slam::draw

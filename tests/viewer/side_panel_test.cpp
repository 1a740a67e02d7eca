#include "libslam/viewer/side_panel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "libslam/draw/canvas.h"
#include "libslam/draw/map_view.h"

namespace slam::viewer {
namespace {
using ::testing::ElementsAre;

cv::Mat decoded(const std::string& png) {
  const cv::Mat bytes(1, static_cast<int>(png.size()), CV_8UC1, const_cast<char*>(png.data()));
  return cv::imdecode(bytes, cv::IMREAD_COLOR);
}

/// Share of the pixels of nearly that colour.
double shareOf(const cv::Mat& picture, draw::Colour colour) {
  cv::Mat near;
  const cv::Scalar bgr(colour.blue, colour.green, colour.red), slack(12, 12, 12);
  cv::inRange(picture, bgr - slack, bgr + slack, near);
  return static_cast<double>(cv::countNonZero(near)) / static_cast<double>(picture.total());
}

Snapshot inAWideRoom() {
  Snapshot snapshot;
  snapshot.title = "a room";
  snapshot.time_s = 12.34;
  snapshot.scans = 56;
  snapshot.T_map_robot = {1, -2, core::degToRad(30)};
  snapshot.scan.first_angle_rad = -core::kPi / 2;
  snapshot.scan.step_rad = core::kPi / 180;
  snapshot.scan.max_range_m = 10;
  snapshot.scan.ranges_m.assign(181, 3.0F);
  return snapshot;
}

TEST(SidePanel, SaysWhatIsGoingOn) {
  auto snapshot = inAWideRoom();
  EXPECT_THAT(statusLines(snapshot, {}),
              ElementsAre("a room", "12.3 s, scan 56", "pose (1.00, -2.00) m, 30 deg"));
  snapshot.method = "graph";
  snapshot.T_scene_map = {10, 0, 0};
  snapshot.T_scene_truth = core::Pose2{11.03, -1.96, core::degToRad(29)};
  snapshot.collisions = 2;
  snapshot.note = "nearest of 5 frontiers";
  PanelState state;
  state.playback = "paused";
  EXPECT_THAT(statusLines(snapshot, state),
              ElementsAre("a room", "graph", "12.3 s, scan 56", "pose (1.00, -2.00) m, 30 deg",
                          "error 0.050 m, 1.0 deg", "2 collisions", "paused", "nearest of 5 frontiers"));
}

TEST(SidePanel, HasTheChartAndTheObstaclesWhereThereIsRoom) {
  auto snapshot = inAWideRoom();
  const auto plain = decoded(sidePanel(snapshot, {}, 800));
  ASSERT_EQ(plain.cols, kPanelWidth);
  ASSERT_EQ(plain.rows, 800);
  EXPECT_GT(shareOf(plain, draw::kVermillion), 0.001);  // the chart
  EXPECT_EQ(shareOf(plain, draw::kBlue), 0);
  LocalObstacles obstacles;
  obstacles.remembered = {{1, 1}, {-1, 0.5}};
  obstacles.front_m = 4, obstacles.rear_m = 2, obstacles.width_m = 5;
  snapshot.obstacles = obstacles;
  EXPECT_GT(shareOf(decoded(sidePanel(snapshot, {}, 800)), draw::kBlue), 0);
  // The chart and the obstacles find no room; nothing is drawn over the rest.
  PanelState keys;
  keys.keys = {{"q", "end"}};
  EXPECT_EQ(shareOf(decoded(sidePanel(snapshot, keys, 260)), draw::kVermillion), 0);
}

/// As much as a scene can have.
Snapshot withEverything() {
  auto snapshot = inAWideRoom();
  snapshot.method = "graph";
  snapshot.note = "a note that is so long that it takes two lines of the panel, however it is broken";
  snapshot.T_scene_truth = core::Pose2{1, -2, 0};
  snapshot.collisions = 1;
  snapshot.map = std::make_shared<gridmap::OccupancyRaster>();
  snapshot.path = snapshot.truth = {{0, {0, 0, 0}}};
  snapshot.nodes = {{0, 0}};
  snapshot.particles = {{0, 0, 0}};
  snapshot.people = {{{0, 0}, 0.2}};
  snapshot.candidates.emplace();
  LocalObstacles obstacles;
  obstacles.remembered = {{1, 1}, {-1, 0.5}};
  obstacles.front_m = 4, obstacles.rear_m = 2, obstacles.width_m = 5;
  snapshot.obstacles = obstacles;
  return snapshot;
}

TEST(SidePanel, CutsNothingOffTheLegendInALowWindow) {
  PanelState state;
  state.playback = "paused";
  for (const int height : {500, 640, 800, 1200}) {
    const auto picture = decoded(sidePanel(withEverything(), state, height));
    for (const auto& colour : {draw::kOrange, draw::kYellow, draw::kPurple, draw::kGreen})
      EXPECT_GT(shareOf(picture, colour), 0) << height;
    // The line of the help stands at the bottom, alone.
    const auto ink = [&](int top, int bottom) {
      return shareOf(picture.rowRange(height - top, height - bottom), draw::kInk);
    };
    EXPECT_GT(ink(22, 6), 0) << height;
    EXPECT_EQ(ink(5, 0), 0) << height;
  }
}

TEST(SidePanel, HasTheObstaclesInALowWindowToo) {
  auto snapshot = withEverything();
  snapshot.note.clear();
  const auto with = shareOf(decoded(sidePanel(snapshot, {}, 500)), draw::kVermillion);
  snapshot.scan.ranges_m.clear();
  EXPECT_LT(shareOf(decoded(sidePanel(snapshot, {}, 500)), draw::kVermillion), with);
  const auto zone = shareOf(decoded(sidePanel(snapshot, {}, 500)), {214, 214, 214});
  EXPECT_GT(zone, 0.005);  // not in view
}

TEST(SidePanel, ALayerThatIsOffLosesItsColour) {
  PanelState state;
  const auto on = shareOf(decoded(sidePanel(withEverything(), state, 800)), draw::kPurple);
  state.hidden = "29";
  const auto off = shareOf(decoded(sidePanel(withEverything(), state, 800)), draw::kPurple);
  EXPECT_GT(on, 0);
  EXPECT_EQ(off, 0);
}

TEST(ScaleBar, IsAsLongAsItSays) {
  const auto picture = decoded(scaleBar(2, 100));
  EXPECT_EQ(picture.cols, 120);
  int longest = 0;
  for (int row = 0; row < picture.rows - 1; ++row) {
    int length = 0;
    for (int column = 2; column < picture.cols - 2; ++column)
      length += picture.at<cv::Vec3b>(row, column)[0] < 100;
    longest = std::max(longest, length);
  }
  EXPECT_NEAR(longest, 100, 3);
}

TEST(SidePanel, AScanWithoutAnyReturnHasNoCurve) {
  auto snapshot = inAWideRoom();
  snapshot.scan.ranges_m.assign(181, lidar::kNoReturn);
  const double only_the_legend = shareOf(decoded(sidePanel(snapshot, {}, 800)), draw::kVermillion);
  snapshot.scan.ranges_m.assign(181, 2.0F);
  EXPECT_LT(only_the_legend, shareOf(decoded(sidePanel(snapshot, {}, 800)), draw::kVermillion));
  snapshot.scan.ranges_m.clear();
  sidePanel(snapshot, {}, 800);
}

TEST(SidePanel, ShowsTheKeysInsteadOfTheColours) {
  const auto snapshot = inAWideRoom();
  PanelState state;
  state.keys = {{"q", "end"}};
  EXPECT_NE(sidePanel(snapshot, state, 800), sidePanel(snapshot, {}, 800));
  EXPECT_EQ(sidePanel(snapshot, state, 800), sidePanel(snapshot, state, 800));  // the same bytes
}

}  // namespace
}  // namespace slam::viewer

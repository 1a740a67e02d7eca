#include "libslam/pictures/obstacle_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "libslam/core/error.h"
#include "libslam/draw/map_view.h"
#include "libslam/resources/file_hash.h"
#include "libslam/testing/temp_folder.h"

namespace slam::pictures {
namespace {

using testing::TempFolder;

/// Middles of the spots of one colour within a part of the picture.
std::vector<cv::Point2d> spots(const cv::Mat& image, draw::Colour colour) {
  cv::Mat mask, labels, stats, centres;
  const cv::Scalar value(colour.blue, colour.green, colour.red);
  cv::inRange(image, value, value, mask);
  cv::connectedComponentsWithStats(mask, labels, stats, centres);
  std::vector<cv::Point2d> found;
  for (int i = 1; i < centres.rows; ++i)  // 0 is the background
    if (stats.at<int>(i, cv::CC_STAT_AREA) > 8)
      found.emplace_back(centres.at<double>(i, 0), centres.at<double>(i, 1));
  return found;
}

ObstaclePanel example() {
  return {"start",  "1 seen, 1 remembered", {{0.5, -0.3}, {3, -2}, {3, 2}, {0.5, 0.3}}, {{2, 0}}, {{-1, 1}},
          {{-1, 1}}};
}

TEST(DrawObstacles, PutsAheadUpAndLeftLeft) {
  const TempFolder folder;
  ObstacleZone zone;
  zone.front_m = 3, zone.rear_m = 2, zone.width_m = 5;
  drawObstacles({example()}, zone, "", folder / "one.png");
  const auto image = cv::imread(folder / "one.png", cv::IMREAD_COLOR);
  ASSERT_FALSE(image.empty());
  const cv::Mat zone_only = image(cv::Rect(0, 0, image.cols, 20 + 54 + 640));  // without the legend
  const auto seen = spots(zone_only, draw::kVermillion), remembered = spots(zone_only, draw::kBlue);
  ASSERT_EQ(seen.size(), 1U);
  ASSERT_EQ(remembered.size(), 1U);
  // From (2, 0) to (-1, 1): 3 m back and 1 m to the left. The single panel is 640 pixels for 5 m.
  const double pixels_per_metre = 128;
  EXPECT_NEAR(remembered[0].y - seen[0].y, 3 * pixels_per_metre, 1);  // pixel centres
  EXPECT_NEAR(seen[0].x - remembered[0].x, 1 * pixels_per_metre, 1);
  // White round what is seen, grey round what is remembered.
  const auto colourAt = [&](const cv::Point2d& p) {
    const auto& pixel = zone_only.at<cv::Vec3b>(static_cast<int>(p.y) + 20, static_cast<int>(p.x));
    return static_cast<int>(pixel[0]);
  };
  EXPECT_EQ(colourAt(seen[0]), 255);
  EXPECT_EQ(colourAt(remembered[0]), draw::kUnknown.blue);
}

TEST(DrawObstacles, DrawsTheSameBytesForOneToTwelvePanelsOfAnyShape) {
  const TempFolder folder;
  for (const auto& [front_m, width_m] : {std::pair{4.0, 5.0}, {1.0, 20.0}, {30.0, 1.0}})
    for (const size_t count : {1U, 2U, 5U, 12U}) {
      ObstacleZone zone;
      zone.front_m = front_m, zone.width_m = width_m;
      const std::vector<ObstaclePanel> panels(count, example());
      drawObstacles(panels, zone, "Title", folder / "a.png");
      drawObstacles(panels, zone, "Title", folder / "b.png");
      EXPECT_EQ(resources::fileSha256(folder / "a.png"), resources::fileSha256(folder / "b.png"));
      const auto image = cv::imread(folder / "a.png", cv::IMREAD_COLOR);
      EXPECT_GE(image.cols, 600);
      EXPECT_LE(std::max(image.cols, image.rows), 2000);
    }
}

TEST(DrawObstacles, SurvivesEmptyAndUnusablePanels) {
  const TempFolder folder;
  ObstaclePanel broken;
  broken.visible = {{std::nan(""), 0}, {1, 1}};
  broken.seen = {{INFINITY, 0}, {1e300, -1e300}};
  drawObstacles({{}, broken}, {}, "", folder / "empty.png");
  EXPECT_TRUE(std::filesystem::exists(folder / "empty.png"));
}

TEST(DrawObstacles, RefusesNoPanelsTooManyAndAZoneWithoutArea) {
  const TempFolder folder;
  EXPECT_THROW(drawObstacles({}, {}, "", folder / "x.png"), core::ContractError);
  EXPECT_THROW(drawObstacles(std::vector<ObstaclePanel>(13), {}, "", folder / "x.png"), core::ContractError);
  ObstacleZone flat;
  flat.width_m = 0;
  EXPECT_THROW(drawObstacles({example()}, flat, "", folder / "x.png"), core::ContractError);
  EXPECT_FALSE(std::filesystem::exists(folder / "x.png"));
}

}  // namespace
}  // namespace slam::pictures

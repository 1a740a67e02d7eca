#include "libslam/pictures/journal_picture.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "libslam/draw/canvas.h"
#include "libslam/resources/file_hash.h"
#include "libslam/testing/temp_folder.h"

namespace slam::pictures {
namespace {

using core::kNaN;

world::CellMap room() {
  world::CellMap map;
  map.columns = map.rows = 100;
  map.resolution_m = 0.1;
  map.cells.assign(10000, world::Cell::kFree);
  for (size_t i = 0; i < 100; ++i) map.cells[i] = map.cells[9900 + i] = world::Cell::kOccupied;
  return map;
}

core::Trajectory straight() {
  core::Trajectory path;
  for (int i = 0; i <= 80; ++i) path.push_back({100.0 + i, {1 + 0.1 * i, 5, 0}});
  return path;
}

core::JournalLine at(int scan, const std::string& event, double value = 0) {
  core::JournalLine line;
  line.scan = scan, line.time_s = scan;
  line.event = core::journalEventOf(event).value(), line.value = value;
  line.place = {1 + 0.1 * scan, 5};
  return line;
}

class JournalPicture : public ::testing::Test {
 protected:
  /// Pixels of a colour in the map, above the legend.
  int count(const std::vector<core::JournalLine>& events, draw::Colour colour) {
    drawJournal(room(), straight(), events, "journal", folder_ / "j.png");
    const cv::Mat picture = cv::imread(folder_ / "j.png");
    int pixels = 0;
    for (int y = 70; y < 950 && y < picture.rows; ++y)
      for (int x = 0; x < picture.cols; ++x) {
        const auto& pixel = picture.at<cv::Vec3b>(y, x);
        pixels += pixel[0] == colour.blue && pixel[1] == colour.green && pixel[2] == colour.red ? 1 : 0;
      }
    return pixels;
  }
  testing::TempFolder folder_;
};

TEST_F(JournalPicture, AnAcceptedLoopIsALineBetweenItsPlaces) {
  auto loop = at(70, "accepted", 60);
  EXPECT_LT(count({loop}, draw::kGreen), 100);  // no other place: an end alone
  loop.other_place = {2, 9};
  EXPECT_GT(count({loop}, draw::kGreen), 500);
  loop.event = core::JournalEvent::kRejected;
  EXPECT_EQ(count({loop}, draw::kGreen), 0);
  EXPECT_GT(count({loop}, draw::kVermillion), 500);
}

TEST_F(JournalPicture, StretchesAreColouredAlongThePath) {
  std::vector<core::JournalLine> events;
  for (int scan = 20; scan < 50; ++scan) events.push_back(at(scan, "degenerate", 0.001));
  const int stretch = count(events, draw::kSkyBlue);
  EXPECT_GT(stretch, 1000);
  EXPECT_LT(count({at(20, "degenerate"), at(49, "degenerate")}, draw::kSkyBlue), stretch / 10);
}

TEST_F(JournalPicture, LostLastsUntilTheRobotIsFound) {
  const int to_the_end = count({at(20, "lost")}, draw::kVermillion);
  const int found = count({at(20, "lost"), at(50, "recovered")}, draw::kVermillion);
  EXPECT_GT(found, 1000);
  EXPECT_NEAR(to_the_end, 2 * found, 0.1 * to_the_end);
}

TEST_F(JournalPicture, AnUnknownEventIsAMark) {
  EXPECT_GT(count({at(40, "rematched")}, draw::kYellow), 10);
  EXPECT_EQ(count({at(40, "searched")}, draw::kYellow), 0);
}

TEST_F(JournalPicture, NothingIsAPictureTooAndTheSameInputGivesTheSameBytes) {
  drawJournal(room(), {}, {}, "nothing", folder_ / "a.png");
  EXPECT_FALSE(cv::imread(folder_ / "a.png").empty());
  drawJournal(world::CellMap{}, {}, {at(0, "optimised", kNaN)}, "no map", folder_ / "b.png");
  EXPECT_FALSE(cv::imread(folder_ / "b.png").empty());
  const std::vector<core::JournalLine> events = {at(3, "optimised", 100), at(60, "optimised", 250),
                                                 at(61, "resampled", 0.4)};
  drawJournal(room(), straight(), events, "some", folder_ / "c.png");
  drawJournal(room(), straight(), events, "some", folder_ / "d.png");
  EXPECT_EQ(resources::fileSha256(folder_ / "c.png"), resources::fileSha256(folder_ / "d.png"));
}

}  // namespace
}  // namespace slam::pictures

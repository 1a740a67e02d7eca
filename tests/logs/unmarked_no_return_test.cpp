#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "libslam/core/random.h"
#include "libslam/files/files.h"
#include "libslam/logs/log_reader.h"
#include "libslam/testing/temp_folder.h"

namespace slam::logs {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kBeams = 40;

/// A CARMEN log of so many scans, which has no word for a lidar's range.
struct Log {
  testing::TempFolder folder;
  Log(int scans, const std::function<double(int beam)>& reading_m) {
    std::string text;
    char word[32];
    for (int scan = 0; scan < scans; ++scan) {
      text += "FLASER " + std::to_string(kBeams);
      for (int beam = 0; beam < kBeams; ++beam) {
        std::snprintf(word, sizeof word, " %.2f", reading_m(beam));
        text += word;
      }
      std::snprintf(word, sizeof word, "%.1f", 0.1 * scan);
      text += std::string(" 0 0 0 0 0 0 ") + word + " robot " + word + "\n";
    }
    files::writeFileAtomically(folder / "a.clf", text);
  }
  std::vector<LogEntry> read() {
    LogReader reader(folder / "a.clf");
    std::vector<LogEntry> entries;
    while (auto entry = reader.next()) entries.push_back(std::move(*entry));
    remarks = reader.remarks();
    return entries;
  }
  std::vector<std::string> remarks;
};

int noReturnsIn(const lidar::Scan& scan) {
  return static_cast<int>(std::count(scan.ranges_m.begin(), scan.ranges_m.end(), lidar::kNoReturn));
}

TEST(UnmarkedNoReturn, IsTheLargestReadingThatComesAgainAndAgain) {
  core::RandomStream random(3, "readings");
  Log log(130, [&](int beam) { return beam % 4 == 0 ? 8.19 : random.uniform(2, 8); });
  const auto entries = log.read();
  ASSERT_EQ(entries.size(), 130U);
  for (const size_t i : {0U, 129U}) {
    EXPECT_EQ(noReturnsIn(entries[i].scan), kBeams / 4) << i;
    EXPECT_NEAR(entries[i].scan.max_range_m, 8.19, 1e-6) << i;
  }
  EXPECT_THAT(log.remarks, ElementsAre(HasSubstr("25.0 % of the first readings are 8.19 m to the last bit")));
}

TEST(UnmarkedNoReturn, IsNotToldByFewScans) {
  core::RandomStream random(3, "readings");
  Log log(19, [&](int beam) { return beam % 4 == 0 ? 8.19 : random.uniform(2, 8); });
  EXPECT_EQ(noReturnsIn(log.read().front().scan), 0);
  EXPECT_THAT(log.remarks, IsEmpty());
}

// The same scan again and again, rounded to centimetres: few beams see what is farthest.
TEST(UnmarkedNoReturn, IsNoWallThatARobotAtRestLooksAt) {
  Log log(40, [](int beam) { return beam < 10 ? 2.5 : 5.0 / std::cos(0.012 * (beam - 24)); });
  EXPECT_EQ(noReturnsIn(log.read().front().scan), 0);
  EXPECT_THAT(log.remarks, IsEmpty());
}

// A lidar that speaks in steps of 5 cm says two things of one wall.
TEST(UnmarkedNoReturn, IsNotWhatCoarseStepsMakeOfAWall) {
  Log log(40, [](int beam) { return beam < 10 ? 2.5 : beam % 3 == 0 ? 5.95 : 6.0; });
  EXPECT_EQ(noReturnsIn(log.read().front().scan), 0);
  EXPECT_THAT(log.remarks, IsEmpty());
}

// A few beams through a door, at the wall beyond it.
TEST(UnmarkedNoReturn, IsNotWhatAFewBeamsBesideEachOtherSee) {
  core::RandomStream random(3, "readings");
  Log log(40, [&](int beam) { return beam >= 20 && beam < 23 ? 8.19 : random.uniform(2, 6); });
  EXPECT_EQ(noReturnsIn(log.read().front().scan), 0);
  EXPECT_THAT(log.remarks, IsEmpty());
}

TEST(UnmarkedNoReturn, IsNotWhatComesNowAndThen) {
  core::RandomStream random(3, "readings");
  Log log(100, [&](int) { return random.uniform() < 0.005 ? 8.19 : random.uniform(2, 6); });
  EXPECT_EQ(noReturnsIn(log.read().front().scan), 0);
  EXPECT_THAT(log.remarks, IsEmpty());
}

}  // namespace
}  // namespace slam::logs

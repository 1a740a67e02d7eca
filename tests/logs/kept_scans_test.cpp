#include "libslam/logs/kept_scans.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/testing/temp_folder.h"
#include "tests/logs/log_fixtures.h"

namespace slam::logs {
namespace {

void expectSame(const lidar::Scan& kept, const lidar::Scan& scan) {
  EXPECT_EQ(kept.T_robot_lidar.x, scan.T_robot_lidar.x);
  EXPECT_EQ(kept.T_robot_lidar.y, scan.T_robot_lidar.y);
  EXPECT_EQ(kept.T_robot_lidar.phi, scan.T_robot_lidar.phi);
  EXPECT_EQ(kept.first_angle_rad, scan.first_angle_rad);
  EXPECT_EQ(kept.step_rad, scan.step_rad);
  ASSERT_EQ(kept.ranges_m.size(), scan.ranges_m.size());
  EXPECT_EQ(std::memcmp(kept.ranges_m.data(), scan.ranges_m.data(), 4 * scan.ranges_m.size()), 0)
      << "lost readings included";
}

/// An entry of 181 beams with another lidar's scan of 2, or alone.
LogEntry entryOf(LogEntry entry, bool has_other) {
  entry.scan.T_robot_lidar = {0.1, -0.2, 0.3};
  entry.scan.ranges_m[3] = lidar::kLostReading;
  entry.scan.ranges_m[4] = lidar::kNoReturn;
  if (!has_other) return entry;
  lidar::Scan other = entry.scan;
  other.T_robot_lidar = {-0.2, 0, 3};
  other.ranges_m = {1, 2};
  entry.others.push_back({"rear", other, {}});
  return entry;
}

TEST(KeptScans, ComeBackToTheBitAsOftenAsAskedFor) {
  testing::TempFolder folder;
  KeptScans kept(folder.path());
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "the file has no name";
  std::vector<LogEntry> entries;
  for (const auto& entry : sampleEntries(60)) entries.push_back(entryOf(entry, entries.size() % 3 == 1));
  for (const auto& entry : entries) kept.add(entry);
  for (int time = 0; time < 2; ++time) {
    ASSERT_TRUE(kept.rewind());
    for (const auto& entry : entries) {
      const auto scans = kept.next();
      ASSERT_TRUE(scans);
      ASSERT_EQ(scans->size(), 1 + entry.others.size());
      expectSame(scans->front(), entry.scan);
      if (!entry.others.empty()) expectSame(scans->back(), entry.others.front().scan);
    }
    EXPECT_FALSE(kept.next());
    EXPECT_FALSE(kept.next()) << "the end stays the end";
  }
}

TEST(KeptScans, AreAllOrNone) {
  testing::TempFolder folder;
  const auto entries = sampleEntries(10);
  const std::uint64_t bytes_each = 48 + 4 * entries.front().scan.ranges_m.size();
  KeptScans enough(folder.path(), 10 * bytes_each), less(folder.path(), 10 * bytes_each - 1),
      nowhere(folder / "missing");
  for (const auto& entry : entries) {
    enough.add(entry);
    less.add(entry);
    nowhere.add(entry);
  }
  EXPECT_TRUE(enough.rewind());
  EXPECT_FALSE(less.rewind());
  EXPECT_FALSE(nowhere.rewind());
  EXPECT_THROW(less.next(), core::ContractError);
}

TEST(KeptScans, AreReadAfterAllWereWritten) {
  testing::TempFolder folder;
  KeptScans kept(folder.path());
  const auto entries = sampleEntries(1);
  kept.add(entries.front());
  EXPECT_THROW(kept.next(), core::ContractError);
  ASSERT_TRUE(kept.rewind());
  EXPECT_THROW(kept.add(entries.front()), core::ContractError);
}

}  // namespace
}  // namespace slam::logs

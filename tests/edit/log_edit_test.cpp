#include "libslam/edit/log_edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/logs/log_format.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"
#include "tests/edit/edited_logs.h"
#include "tests/logs/log_fixtures.h"

namespace slam::edit {
namespace {

using namespace logs;

using testing::errorOf;
using ::testing::HasSubstr;

TEST(CutLog, KeepsTheObjectsBetweenTwoMomentsByteForByte) {
  const testing::TempFolder folder;
  const auto path = bareLog(folder, "a.rawlog", 10);
  const auto counts = cut(path, folder / "b.rawlog", {LogMoment{3, false}, LogMoment{5, false}});
  EXPECT_EQ(outline(folder / "b.rawlog"),
            (std::vector<std::string>{"ODOMETRY 3.0", "LASER 3.0", "ODOMETRY 4.0", "LASER 4.0"}));
  EXPECT_EQ(counts.read, 20U);
  EXPECT_EQ(counts.unchanged, 4U);
  EXPECT_EQ(counts.changed, 0U);
  EXPECT_EQ(counts.dropped, 16U);
  EXPECT_THAT(unpacked(path), HasSubstr(unpacked(folder / "b.rawlog")));
  // The same moments, said in the other way.
  cut(path, folder / "c.rawlog", {LogMoment{kStart_s + 3, true}, LogMoment{kStart_s + 5, true}});
  EXPECT_EQ(readBytes(folder / "b.rawlog"), readBytes(folder / "c.rawlog"));
}

TEST(CutLog, TwoPiecesMakeTheWholeAgain) {
  const testing::TempFolder folder;
  const auto path = actionLog(folder, "a.rawlog", 12);
  cut(path, folder / "b.rawlog", {std::nullopt, LogMoment{1.3, false}});
  cut(path, folder / "c.rawlog", {LogMoment{1.3, false}, std::nullopt});
  EXPECT_EQ(unpacked(folder / "b.rawlog") + unpacked(folder / "c.rawlog"), unpacked(path));
}

TEST(CutLog, LeavesOldAndUnknownDigitsAlone) {
  const std::string old = "/usr/share/mrpt/datasets/2006-01ENE-21-SENA_Telecom Faculty_one_loop_only.rawlog";
  if (!std::filesystem::exists(old)) GTEST_SKIP() << "mrpt-common's datasets are not installed";
  const testing::TempFolder folder;
  // Of 2006: MRPT itself would write all of its classes in newer versions.
  const auto counts = cut(old, folder / "all.rawlog", {LogMoment{0, false}, std::nullopt});
  EXPECT_EQ(counts.unchanged, 449U);
  EXPECT_EQ(unpacked(folder / "all.rawlog"), unpacked(old));
}

TEST(CutLog, AnActionStaysWithItsFrameAndObjectsWithoutAStampWithTheOneBefore) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    const auto remark = unstampedRemark();
    log << remark;
    for (int i = 0; i < 4; ++i) {
      // The action is stamped before the cut, its frame after.
      log << collection(wheelAction(kStart_s + i - 0.5, 1)) << frame(rawScan(kStart_s + i, "L")) << remark;
    }
  }
  cut(folder / "a.rawlog", folder / "b.rawlog", {LogMoment{2, false}, LogMoment{3, false}});
  EXPECT_EQ(outline(folder / "b.rawlog"), (std::vector<std::string>{"", "actions", "frame [L 2.0]", ""}));
}

TEST(CutLog, KeepsTheFilesOrderWhereStampsRunBack) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    for (const double time_s : {0.0, 2.0, 1.0, 3.0}) log << rawScan(kStart_s + time_s, "L");
  }
  cut(folder / "a.rawlog", folder / "b.rawlog", {LogMoment{1, false}, LogMoment{3, false}});
  EXPECT_EQ(outline(folder / "b.rawlog"), (std::vector<std::string>{"L 2.0", "L 1.0"}));
}

TEST(CutLog, SalvagesWhatComesBeforeDamage) {
  const testing::TempFolder folder;
  const auto path = bareLog(folder, "a.rawlog", 30);
  const std::string bytes = unpacked(path);
  writeBytes(bytes.substr(0, bytes.size() - 20), path);
  EXPECT_THAT(errorOf([&] {
                cut(path, folder / "b.rawlog", {LogMoment{0, false}, std::nullopt});
              }),
              HasSubstr("truncated"));
  EXPECT_FALSE(std::filesystem::exists(folder / "b.rawlog"));
  EXPECT_THAT(testing::leftoversIn(folder.path()), ::testing::IsEmpty());
  const auto counts = cut(path, folder / "b.rawlog", {std::nullopt, std::nullopt, true});
  EXPECT_EQ(counts.unchanged, 59U);
  EXPECT_THAT(counts.damage, HasSubstr("truncated"));
  EXPECT_EQ(unpacked(folder / "b.rawlog"), bytes.substr(0, unpacked(folder / "b.rawlog").size()));
}

TEST(CutLog, RefusesToWriteNothing) {
  const testing::TempFolder folder;
  const auto path = bareLog(folder, "a.rawlog", 3);
  EXPECT_EQ(errorOf([&] {
              cut(path, folder / "b.rawlog", {LogMoment{100, false}, std::nullopt});
            }),
            (folder / "b.rawlog") + ": nothing would be left of 6 objects, expected at least one");
  EXPECT_THAT(testing::leftoversIn(folder.path()), ::testing::IsEmpty());
}

TEST(CutLog, AnInterruptLeavesNothing) {
  struct Impatient : core::Progress {
    void update(double, double) override { throw core::Interrupted(); }
  } impatient;
  const testing::TempFolder folder;
  const auto path = bareLog(folder, "a.rawlog", 200);
  EXPECT_THROW(cutLog(path, folder / "b.rawlog", {LogMoment{0, false}, std::nullopt}, impatient),
               core::Interrupted);
  EXPECT_FALSE(std::filesystem::exists(folder / "b.rawlog"));
  EXPECT_THAT(testing::leftoversIn(folder.path()), ::testing::IsEmpty());
}

TEST(CutLog, ReadsOtherFormats) {
  const testing::TempFolder folder;
  std::string text = "PARAM robot_frontlaser_offset 0.1 nohost 0\n";
  for (int i = 0; i < 4; ++i)
    text += "FLASER 3 1 2 3 0 0 0 0 0 0 " + std::to_string(100 + i) + " nohost " + std::to_string(i) + "\n";
  writeBytes(text, folder / "a.log");
  cut(folder / "a.log", folder / "b.rawlog", {LogMoment{1, false}, LogMoment{2, false}});
  EXPECT_EQ(LogReader(folder / "b.rawlog").next()->scan.T_robot_lidar.x,
            LogReader(folder / "a.log").next()->scan.T_robot_lidar.x);
  EXPECT_EQ(inspectLog(folder / "b.rawlog").scans, 1U);
}

TEST(MergeLogs, SortsByStampAndPrefersTheFirstLog) {
  const testing::TempFolder folder;
  const auto front = bareLog(folder, "a.rawlog", 3, "FRONT");
  {
    RawObjects log(folder / "b.rawlog");
    for (const double time_s : {0.0, 0.5, 7.0}) log << rawScan(kStart_s + time_s, "REAR");
  }
  const auto counts = mergeLogs(front, folder / "b.rawlog", folder / "c.rawlog", core::silentProgress());
  EXPECT_EQ(outline(folder / "c.rawlog"),
            (std::vector<std::string>{"ODOMETRY 0.0", "FRONT 0.0", "REAR 0.0", "REAR 0.5", "ODOMETRY 1.0",
                                      "FRONT 1.0", "ODOMETRY 2.0", "FRONT 2.0", "REAR 7.0"}));
  EXPECT_EQ(counts.read, 9U);
  EXPECT_EQ(counts.unchanged, 9U);
  EXPECT_EQ(unpacked(folder / "c.rawlog").size(),
            unpacked(front).size() + unpacked(folder / "b.rawlog").size());
}

TEST(MergeLogs, KeepsEachLogsOwnOrder) {
  const testing::TempFolder folder;
  {
    RawObjects a(folder / "a.rawlog"), b(folder / "b.rawlog");
    for (const double time_s : {1.0, 5.0, 4.0}) a << rawScan(kStart_s + time_s, "A");
    const auto remark = unstampedRemark();
    b << remark << rawScan(kStart_s + 2, "B") << remark << rawScan(kStart_s + 4.5, "B");
  }
  mergeLogs(folder / "a.rawlog", folder / "b.rawlog", folder / "c.rawlog", core::silentProgress());
  EXPECT_EQ(outline(folder / "c.rawlog"),
            (std::vector<std::string>{"", "A 1.0", "B 2.0", "", "B 4.5", "A 5.0", "A 4.0"}));
}

TEST(MergeLogs, RefusesTwoRobotsAtATime) {
  const testing::TempFolder folder;
  const auto path = actionLog(folder, "a.rawlog", 12);
  cut(path, folder / "b.rawlog", {std::nullopt, LogMoment{1, false}});
  cut(path, folder / "c.rawlog", {LogMoment{1, false}, std::nullopt});
  const auto merge = [&](const char* first, const char* second) {
    mergeLogs(folder / first, folder / second, folder / "d.rawlog", core::silentProgress());
  };
  EXPECT_THAT(errorOf([&] { merge("a.rawlog", "b.rawlog"); }), HasSubstr("holds actions at the same time"));
  EXPECT_FALSE(std::filesystem::exists(folder / "d.rawlog"));
  merge("c.rawlog", "b.rawlog");
  EXPECT_EQ(unpacked(folder / "d.rawlog"), unpacked(path)) << "one after the other is one drive";
  bareLog(folder, "e.rawlog", 2, "REAR");
  merge("a.rawlog", "e.rawlog");
  EXPECT_EQ(inspectLog(folder / "d.rawlog").form, "mixed");
}

TEST(EditLog, SameInputSameBytes) {
  const testing::TempFolder folder;
  const auto path = actionLog(folder, "a.rawlog", 10);
  FilterOptions options;
  options.every = 4;
  filter(path, folder / "b.rawlog", options);
  filter(path, folder / "c.rawlog", options);
  EXPECT_EQ(readBytes(folder / "b.rawlog"), readBytes(folder / "c.rawlog"));
}

}  // namespace
}  // namespace slam::edit

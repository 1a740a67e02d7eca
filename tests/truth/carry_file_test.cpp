#include "libslam/truth/carry_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "libslam/core/error.h"
#include "libslam/testing/temp_folder.h"

namespace slam::truth {
namespace {
using ::testing::HasSubstr;

TEST(CarryFile, ComesBackAsItWasWritten) {
  const testing::TempFolder folder;
  const std::string path = carriesPath(folder / "run.rawlog");
  EXPECT_EQ(path, folder / "run.carries.csv");
  EXPECT_EQ(carriesPath(folder / "run.gt.tum"), path);
  EXPECT_TRUE(readCarryFile(path).empty());
  std::ofstream(path) << carriesCsv(
      {{1700000060.2, {1, -2, 0.5}, {12.5, 3, -3.125}}, {1700000090, {}, {4, 5, 6}}});
  const auto carries = readCarryFile(path);
  ASSERT_EQ(carries.size(), 2U);
  EXPECT_DOUBLE_EQ(carries[0].time_s, 1700000060.2);
  EXPECT_DOUBLE_EQ(carries[0].T_world_from.y, -2);
  EXPECT_DOUBLE_EQ(carries[0].T_world_from.phi, 0.5);
  EXPECT_DOUBLE_EQ(carries[0].T_world_to.x, 12.5);
  EXPECT_DOUBLE_EQ(carries[0].T_world_to.phi, -3.125);
  EXPECT_DOUBLE_EQ(carries[1].T_world_to.x, 4);
}

TEST(CarryFile, ABrokenOneIsRefusedWithItsLine) {
  const testing::TempFolder folder;
  const std::string path = folder / "run.carries.csv";
  const auto refusal = [&](const std::string& text) {
    std::ofstream(path) << text;
    try {
      readCarryFile(path);
    } catch (const core::InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_THAT(refusal("time_s,x_m\n1,2\n"), HasSubstr("run.carries.csv:1: found 'time_s,x_m'"));
  const std::string header = carriesCsv({});
  EXPECT_EQ(refusal(header), "none");
  EXPECT_THAT(refusal(header + "1,2,3,4,5,6,7\n1,2,3,4,5,6\n"), HasSubstr(":3: found 6 fields, expected 7"));
  EXPECT_THAT(refusal(header + "1,2,three,4,5,6,7\n"), HasSubstr(":2:"));
}

core::Trajectory straight() {
  core::Trajectory path;
  for (int i = 0; i < 5; ++i) path.push_back({10.0 + i, {1.0 * i, 0, 0}});
  return path;
}

TEST(CarryFile, APathIsBrokenBeforeThePoseAfterACarry) {
  const auto broken = brokenAtCarries(straight(), {{12, {2, 0, 0}, {9, 9, 0}}, {13.5, {}, {}}});
  ASSERT_EQ(broken.size(), 7U);
  for (const size_t gap : {2U, 5U}) EXPECT_TRUE(std::isnan(broken[gap].pose.x)) << gap;
  EXPECT_EQ(broken[2].time_s, 12);
  EXPECT_EQ(broken[3].time_s, 12);
  EXPECT_EQ(broken[3].pose.x, 2);
  EXPECT_EQ(broken[6].pose.x, 4);
  for (size_t i = 1; i < broken.size(); ++i) EXPECT_GE(broken[i].time_s, broken[i - 1].time_s);
}

TEST(CarryFile, WhatIsNotWithinThePathBreaksNothing) {
  EXPECT_EQ(brokenAtCarries(straight(), {}).size(), 5U);
  EXPECT_EQ(brokenAtCarries(straight(), {{9, {}, {}}, {20, {}, {}}}).size(), 5U);
  EXPECT_TRUE(brokenAtCarries({}, {{9, {}, {}}}).empty());
}

TEST(CarryFile, IsToldInSecondsSinceTheStart) {
  EXPECT_EQ(carryText({1060, {1, 2, 0}, {12.5, 3, core::kPi / 2}}, 1000),
            "kidnapped at 60.0 s from (1.00 m, 2.00 m) to (12.50 m, 3.00 m, 90 deg)");
}

}  // namespace
}  // namespace slam::truth

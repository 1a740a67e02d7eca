#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(Data, ListsAllAndTellsOne) {
  const auto all = rasterslam("data");
  ASSERT_EQ(all.exit_code, 0) << all.err;
  EXPECT_THAT(all.out, HasSubstr("deutsches-museum"));
  const auto json = nlohmann::json::parse(rasterslam("data --json").out);
  EXPECT_GE(json["data"].size(), 15U);
  const auto one = rasterslam("data intel");
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_THAT(one.out, HasSubstr("fetch     wget http://"));
  EXPECT_THAT(one.out, HasSubstr("use       rasterslam convert intel.clf intel.rawlog"));
  EXPECT_THAT(one.out, HasSubstr("631 scans"));
  EXPECT_EQ(nlohmann::json::parse(rasterslam("data intel --json").out)["licence"], "CC BY 3.0");
}

TEST(Data, KnowsTheLogsOfAnInstalledPackage) {
  const std::string log = "/usr/share/mrpt/datasets/2006-01ENE-21-SENA_Telecom Faculty_one_loop_only.rawlog";
  const auto one = nlohmann::json::parse(rasterslam("data mrpt-malaga --json").out);
  EXPECT_EQ(one["here"], fs::exists(log) ? nlohmann::json{log} : nlohmann::json::array());
  EXPECT_EQ(rasterslam("data").out.find("here: " + log) != std::string::npos, fs::exists(log));
}

TEST(Data, AWrongNameIsToldTheNearest) {
  const auto wrong = rasterslam("data intell");
  EXPECT_EQ(wrong.exit_code, 3);
  EXPECT_THAT(wrong.err, HasSubstr("no public data named 'intell'; did you mean 'intel'?"));
}

}  // namespace
}  // namespace slam::apps

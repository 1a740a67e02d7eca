// Maps of two drives, on the command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "libslam/files/files.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

const std::string kDrive = "simulate flat --duration 150 --set strategy.name=wall_follow -q ";

TEST(MergeMaps, SaysWhereTheyLieAndWhatHasChanged) {
  const testing::TempFolder folder;
  const auto run = [&](const std::string& words) { return rasterslam(words, folder.path()); };
  ASSERT_EQ(run(kDrive + "-o may.rawlog --seed 2").exit_code, 0);
  ASSERT_EQ(run(kDrive + "-o june.rawlog --seed 7 --start 9.5,8,180 --set living.visit=2").exit_code, 0);
  for (const std::string name : {"may", "june"})
    ASSERT_EQ(run("run graph " + name + ".rawlog -o " + name + " -q").exit_code, 0);
  const auto merged = run("merge may june -o both");
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_THAT(merged.out, HasSubstr("its frame is the merged map's"));
  EXPECT_THAT(merged.out, HasSubstr("nats ahead"));
  EXPECT_THAT(run("merge may june -o both -q").err, HasSubstr("--overwrite"));
  const auto json = nlohmann::json::parse(run("merge june may -o back -q --json").out);
  EXPECT_EQ(json.at("sessions")[1].at("name"), "may");
  const auto changes = run("diff may june -o changes");
  ASSERT_EQ(changes.exit_code, 0) << changes.err;
  EXPECT_THAT(changes.out, HasSubstr("What has changed from may to june"));
  EXPECT_TRUE(fs::exists(folder / "changes/changes.html"));

  // What cannot be merged, in one line each.
  const std::tuple<const char*, int, const char*> refusals[] = {
      {"may may", 3, "holds the same scans as may"},
      {"may june.rawlog", 3, "june.rawlog: found a log among maps, expected logs or maps alone"},
      {"may nothing", 3, "nothing: no such file"},
      {"may.rawlog may.rawlog june.rawlog", 3, "found 3 logs, expected two"}};
  for (const auto& [inputs, exit_code, what] : refusals) {
    const auto result = run("merge " + std::string(inputs) + " -o wrong.rawlog -q");
    EXPECT_EQ(result.exit_code, exit_code) << inputs;
    EXPECT_THAT(result.err, HasSubstr(what));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(folder / "wrong.rawlog"));
  }
  ASSERT_EQ(run("simulate pillar_hall -o hall.rawlog --duration 40 -q").exit_code, 0);
  ASSERT_EQ(run("run graph hall.rawlog -o hall -q").exit_code, 0);
  for (const std::string command : {"merge", "diff"}) {
    const auto result = run(command + " may hall -o wrong -q");
    EXPECT_EQ(result.exit_code, 4);
    EXPECT_THAT(result.err, HasSubstr("hall: "));
    EXPECT_FALSE(fs::exists(folder / "wrong"));
  }
}

}  // namespace
}  // namespace slam::apps

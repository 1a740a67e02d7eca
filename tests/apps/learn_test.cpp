// learn, new and contest: what the program says around lessons. Whole lessons are worked through by
// tests/learn/course.py.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "libslam/files/files.h"
#include "libslam/resources/file_hash.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Learn, ListsTenLessons) {
  const auto list = rasterslam("learn --json");
  ASSERT_EQ(list.exit_code, 0) << list.err;
  EXPECT_EQ(nlohmann::json::parse(list.out).size(), 10U);
  EXPECT_THAT(rasterslam("learn").out, HasSubstr("next: rasterslam learn 1"));
}

TEST(Learn, PrintsAPageInTheTerminalsWidth) {
  const testing::TempFolder folder;
  for (const int columns : {40, 80}) {
    const auto page =
        testing::runCommand("COLUMNS=" + std::to_string(columns) + " '" RASTERSLAM_PROGRAM "' learn 8");
    ASSERT_EQ(page.exit_code, 0) << page.err;
    EXPECT_THAT(page.out, StartsWith("Lesson 8: consistency\n"));
  }
}

TEST(Learn, RefusesWhatIsNone) {
  const testing::TempFolder folder;
  const auto refused = [&](const std::string& arguments, int code, const std::string& said) {
    const auto result = rasterslam(arguments, folder.path());
    EXPECT_EQ(result.exit_code, code) << arguments;
    EXPECT_THAT(result.err, HasSubstr(said)) << arguments;
  };
  refused("learn 11", 3, "expected a number from 1 to 10");
  refused("learn start 1", 2, "--student is required");
  refused("learn start 1 --student zero", 3, "--student: found 'zero'");
  refused("learn check 1 2.5", 3, "whose answer is it?");
  refused("learn grade nowhere", 3, "no such folder");
  refused("learn chekc 1 2", 2, "");
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(New, MakesAMethodThatKeepsTheContractFromTheFirstMinute) {
  const testing::TempFolder folder;
  ASSERT_EQ(rasterslam("simulate flat -o run.rawlog --duration 3 -q", folder.path()).exit_code, 0);
  for (const std::string kind : {"method one", "plugin two", "plugin three --language python"}) {
    const auto made = rasterslam("new " + kind + " --json", folder.path());
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const auto said = nlohmann::json::parse(made.out);
    const std::string name = said["folder"];
    const auto check = rasterslam("plugin check " + name + "/" + name + ".ini run.rawlog", folder.path());
    EXPECT_EQ(check.exit_code, 0) << check.out;
    EXPECT_THAT(check.out, HasSubstr("keeps the contract: 16 of 16 scans have a pose"));
    // The lines that it says are next, as they are.
    for (const auto& line : said["next"]) {
      if (line.get<std::string>().find("rasterslam") == 0) continue;
      EXPECT_EQ(testing::runCommand("cd '" + folder.path() + "' && " + line.get<std::string>()).exit_code, 0)
          << line;
    }
  }
  const auto again = rasterslam("new method one", folder.path());
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_THAT(again.err, HasSubstr("somebody's work"));
  EXPECT_EQ(rasterslam("new strategy x --language python", folder.path()).exit_code, 3);
  EXPECT_EQ(rasterslam("new sonnet x", folder.path()).exit_code, 2);
}

TEST(Contest, RanksOursMrptsAndTwoTemplatesAndKeepsOneThatCrashes) {
  const testing::TempFolder folder;
  const auto run = [&](const std::string& arguments) { return rasterslam(arguments, folder.path()); };
  ASSERT_EQ(run("new method anna").exit_code, 0);
  ASSERT_EQ(run("new plugin ben").exit_code, 0);
  ASSERT_EQ(run("new method carl").exit_code, 0);
  files::writeFileAtomically(folder / "carl/carl.py", "import sys\nsys.exit('I have lost my way')\n");
  files::writeFileAtomically(
      folder / "ground.ini",
      "[suite]\nworlds = room\nlidars = urg04lx\nmethods = graph\nfailure_ate_m = 1\n"
      "[odometry]\nscale = 1.05\nheading_bias_degpm = 4\n"
      "[simulation]\nduration_s = 5\n[world room]\nkind = flat\nwidth_m = 10\nheight_m = 8\n");
  const std::string line =
      "contest graph icp anna/anna.ini ben/ben.ini carl/carl.ini --suite ground.ini --seeds 6 -q -j 2 --json "
      "-o ";
  const auto held = run(line + "one --seed 5");
  ASSERT_EQ(held.exit_code, 0) << held.err;
  const auto json = nlohmann::json::parse(held.out);
  const auto& rows = json["standings"]["rows"];
  ASSERT_EQ(rows.size(), 5U);
  EXPECT_EQ(rows[0]["entry"], "graph");
  EXPECT_EQ(rows[4]["entry"], "carl");
  EXPECT_EQ(rows[4]["failed"], "6 of 6");
  EXPECT_THAT(rows[4]["first_failure"].get<std::string>(), HasSubstr("I have lost my way"));
  // The two templates believe the wheels: nothing tells them apart.
  std::string groups[2];
  for (const auto& row : rows)
    if (row["entry"] == "anna" || row["entry"] == "ben") groups[row["entry"] == "ben"] = row["group"];
  EXPECT_EQ(groups[0], groups[1]);
  const auto page = files::readTextFile(folder / "one/report.html");
  for (const char* word : {"Contest", "Standings", "I have lost my way", "anna"})
    EXPECT_THAT(page, HasSubstr(word));
  EXPECT_EQ(page.find(folder.path()), std::string::npos);
  // The same seed is the same contest.
  ASSERT_EQ(run(line + "two --seed 5").exit_code, 0);
  EXPECT_EQ(resources::fileSha256(folder / "one/standings.csv"),
            resources::fileSha256(folder / "two/standings.csv"));
}

TEST(Contest, RefusesWhatCannotBeHeld) {
  const testing::TempFolder folder;
  for (const std::string entries : {"graph", "graph nobody.ini", "graph graph", "graph grahp"}) {
    const auto result = rasterslam("contest " + entries + " -o out", folder.path());
    EXPECT_EQ(result.exit_code, 3) << entries;
    EXPECT_THAT(result.err, StartsWith("rasterslam: ")) << entries;
  }
  EXPECT_FALSE(fs::exists(folder / "out"));
}

}  // namespace
}  // namespace slam::apps

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "libslam/core/files.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::string kSource = RASTERSLAM_SOURCE_DIR;

std::vector<std::string> linesOf(const testing::CommandResult& result) {
  std::vector<std::string> lines;
  std::istringstream text(result.out);
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

/// What the words behind `rasterslam`, of which the last is not finished, could become.
std::vector<std::string> completed(const std::string& words) {
  return linesOf(rasterslam("complete " + words));
}

TEST(Completion, KnowsCommandsAndTheirSubcommands) {
  EXPECT_THAT(completed("comp"), ElementsAre("compare"));
  EXPECT_THAT(completed("''"), Contains("simulate"));
  EXPECT_THAT(completed("graph ''"), ElementsAre("info", "optimise"));
}

TEST(Completion, KnowsFlagsOfTheCommand) {
  EXPECT_THAT(completed("simulate --dur"), ElementsAre("--duration"));
  EXPECT_THAT(completed("simulate flat -o run.rawlog --str"), ElementsAre("--strategy"));
  EXPECT_THAT(completed("list --dur"), IsEmpty());
}

TEST(Completion, KnowsNamesWhereTheyAreWanted) {
  EXPECT_THAT(completed("run grap"), ElementsAre("graph"));
  EXPECT_THAT(completed("simulate fl"), ElementsAre("flat"));
  EXPECT_THAT(completed("simulate flat --lidar utm"), ElementsAre("utm30lx"));
  EXPECT_THAT(completed("simulate flat --strategy ''"), Contains("quadrant"));
  EXPECT_THAT(completed("navigate flat --method tang"), ElementsAre("tangent"));
  EXPECT_THAT(completed("list strat"), ElementsAre("strategies"));
  EXPECT_THAT(completed("compare run.rawlog --methods icp,gra"), ElementsAre("icp,graph"));
}

TEST(Completion, LeavesFilesToTheShell) {
  EXPECT_THAT(completed("info run.raw"), IsEmpty());
  EXPECT_THAT(completed("nonsense ''"), Not(Contains("nonsense")));
}

TEST(Completion, WorksInBash) {
  const auto result = testing::runCommand(
      "bash -c 'PATH=" + fs::path(RASTERSLAM_PROGRAM).parent_path().string() + ":$PATH; . " + kSource +
      "/apps/completion/rasterslam.bash; COMP_WORDS=(rasterslam run grap); COMP_CWORD=2; _rasterslam; "
      "echo \"${COMPREPLY[@]}\"'");
  EXPECT_EQ(result.out, "graph\n") << result.err;
}

TEST(Manual, HasAPageForEveryCommandThatManCanRead) {
  const testing::TempFolder folder;
  ASSERT_EQ(rasterslam("manual .", folder.path()).exit_code, 0);
  const std::string whole = core::readTextFile(folder / "rasterslam.1");
  for (const std::string& command : completed("''"))
    EXPECT_THAT(whole, HasSubstr("rasterslam\\-" + command + " (1)"));
  const std::string page = core::readTextFile(folder / "rasterslam-world.1");
  EXPECT_THAT(page, HasSubstr("RASTERSLAM WORLD CHECK"));
  EXPECT_THAT(page, HasSubstr("\\-\\-preview"));
  if (!testing::programExists("man")) GTEST_SKIP() << "man is not here";
  for (const auto& file : fs::directory_iterator(folder.path())) {
    const auto read =
        testing::runCommand("man --warnings -E UTF-8 -l -Tutf8 '" + file.path().string() + "' >/dev/null");
    EXPECT_EQ(read.err, "") << file.path();
  }
}

}  // namespace
}  // namespace slam::apps

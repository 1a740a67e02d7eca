#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "libslam/files/files.h"
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
  EXPECT_THAT(completed("graph ''"), ElementsAre("info", "convert", "optimise"));
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

TEST(Completion, KnowsTheKeysOfTheCommandAndTheMethod) {
  EXPECT_THAT(completed("simulate flat --set lidar.beams"), ElementsAre("lidar.beams="));
  EXPECT_THAT(completed("simulate --set living.peop"), ElementsAre("living.people="));
  const auto graph = completed("run graph run.rawlog --set graph.ke"),
             naive = completed("run naive --set ''");
  EXPECT_THAT(graph, Contains("graph.keyframe_score="));
  EXPECT_THAT(naive, Not(Contains("graph.keyframe_score=")));
  EXPECT_THAT(naive, Contains("mapping.insert_angle_deg="));
  EXPECT_THAT(completed("graph optimise a.g2o --set posegraph.rob"), ElementsAre("posegraph.robust="));
  EXPECT_THAT(completed("compare run.rawlog --set ''"),
              ::testing::IsSupersetOf({"lidar.beams=", "graph.keyframe_score="}));
  EXPECT_THAT(completed("stress flat --vary living.people=0..2 --set lidar.beams"),
              ElementsAre("lidar.beams="));
  EXPECT_THAT(completed("info --set ''"), IsEmpty());
}

TEST(Completion, KnowsTheValuesOfKeysThatHaveFew) {
  EXPECT_THAT(completed("graph optimise a.g2o --set posegraph.robust=lo"),
              ElementsAre("posegraph.robust=local"));
  EXPECT_THAT(completed("simulate --set lidar.beams=1"), IsEmpty());
  EXPECT_THAT(completed("run graph --set method.deskew=f"), ElementsAre("method.deskew=false"));
}

/// What a shell's script makes of a line.
std::string inShell(const std::string& shell, const std::string& script) {
  return testing::runCommand(shell + " 'PATH=" + fs::path(RASTERSLAM_PROGRAM).parent_path().string() +
                             ":$PATH; " + script + "'")
      .out;
}

TEST(Completion, WorksInBash) {
  const auto words = [](const std::string& typed, int last) {
    return inShell("bash -c", ". " + kSource + "/apps/completion/rasterslam.bash; COMP_WORDS=(rasterslam " +
                                  typed + "); COMP_CWORD=" + std::to_string(last) +
                                  "; _rasterslam; echo \"${COMPREPLY[@]}\"");
  };
  EXPECT_EQ(words("run grap", 2), "graph\n");
  EXPECT_EQ(words("simulate flat --set lidar.beams", 4), "lidar.beams=\n");
  // As bash takes posegraph.robust=lo apart.
  EXPECT_EQ(words("graph optimise a.g2o --set posegraph.robust = lo", 7), "local\n");
  EXPECT_EQ(words("graph optimise a.g2o --set posegraph.robust =", 6), "global local none\n");
  EXPECT_EQ(words("simulate --set lidar.beams = 90 --dur", 6), "--duration\n");
}

TEST(Completion, WorksInZsh) {
  if (!testing::programExists("zsh")) GTEST_SKIP() << "zsh is not here";
  const auto words = [](const std::string& typed, int last) {
    return inShell("zsh -fc", "compadd() { print -r -- $@ }; _files() { print files }; words=(rasterslam " +
                                  typed + "); CURRENT=" + std::to_string(last) + "; f() { . " + kSource +
                                  "/apps/completion/_rasterslam }; f");
  };
  EXPECT_EQ(words("run grap", 3), "-- graph\n");
  EXPECT_EQ(words("simulate flat --set lidar.beams", 5), "-S -- lidar.beams=\n");
  EXPECT_EQ(words("graph optimise a.g2o --set posegraph.robust=lo", 6), "-- posegraph.robust=local\n");
  EXPECT_EQ(words("info run.raw", 3), "files\n");
}

TEST(Manual, HasAPageForEveryCommandThatManCanRead) {
  const testing::TempFolder folder;
  ASSERT_EQ(rasterslam("manual .", folder.path()).exit_code, 0);
  const std::string whole = files::readTextFile(folder / "rasterslam.1");
  for (const std::string& command : completed("''"))
    EXPECT_THAT(whole, HasSubstr("rasterslam\\-" + command + " (1)"));
  const std::string page = files::readTextFile(folder / "rasterslam-world.1");
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

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "libslam/files/files.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

/// The page of a folder; "" with a failure of the test where there is none.
std::string pageOf(const std::string& folder, const testing::TempFolder& place) {
  const auto result = rasterslam("report " + folder + " -o page.html --overwrite -q", place.path());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? files::readTextFile(place / "page.html") : "";
}

/// What a page says first. Whole pages would drown a failure's message.
std::string verdictOf(const std::string& page) {
  const auto from = page.find("<section id=\"verdict\">");
  return from == std::string::npos ? "" : page.substr(from, page.find("</section>", from) - from);
}

/// The paragraphs of a page.
std::string notesOf(const std::string& page) {
  std::string notes;
  for (auto at = page.find("<p"); at != std::string::npos; at = page.find("<p", at + 1))
    if (page[at + 2] == '>' || page[at + 2] == ' ')
      notes += page.substr(at, page.find("</p>", at) - at) + "\n";
  return notes;
}

bool has(const std::string& page, const std::string& text) {
  return page.find(text) != std::string::npos;
}

nlohmann::json replaysOf(const std::string& page) {
  const std::string begin = "id=\"replay-data\">";
  const auto at = page.find(begin);
  if (at == std::string::npos) return nlohmann::json::array();
  const auto from = at + begin.size();
  return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
}

std::size_t countOf(const std::string& what, const std::string& text) {
  std::size_t count = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

TEST(Report, AStressTestHasItsCurvesWithIntervalsAndWhereMethodsBreak) {
  const testing::TempFolder folder;
  const auto stress = rasterslam(
      "stress flat --vary odometry.slips_per_m=0.01,30 --set odometry.slip_m=0.1 --methods naive_wheel "
      "--seeds 2 --duration 40 --set lidar.beams=31 -q -o out",
      folder.path());
  ASSERT_EQ(stress.exit_code, 0) << stress.err;
  const auto page = pageOf("out", folder);
  EXPECT_THAT(verdictOf(page), HasSubstr("<p>naive_wheel: breaks at 30 and above (holds at 0.01).</p>"));
  EXPECT_TRUE(has(page, "id=\"stress-error\""));
  EXPECT_TRUE(has(page, "id=\"stress-failures\""));
  // Of 2 runs none failed, and 2: their intervals by Clopper and Pearson.
  EXPECT_TRUE(has(page, "data-values=\"0.01 0 0 0.8419;30 1 0.1581 1\""));
  EXPECT_TRUE(has(page, "class=\"cross\""));
  EXPECT_EQ(replaysOf(page).size(), 1U);
  EXPECT_THAT(verdictOf(page), HasSubstr("maps and replay of 1 of 4 runs only, the worst of each method"));
}

TEST(Report, ASweepThatIsNotWholeSaysWhatIsMissing) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "tiny.ini",
                             "[suite]\nworlds = flat\nmethods = naive_wheel, naive_flow\nseeds = 1..3\n"
                             "[simulation]\nduration_s = 10\n[lidar]\nbeams = 31\n");
  ASSERT_EQ(rasterslam("bench tiny.ini -o out -q", folder.path()).exit_code, 0);
  const auto whole = pageOf("out", folder);
  EXPECT_THAT(verdictOf(whole), HasSubstr("6 runs were planned, and all of them have ended."));
  EXPECT_TRUE(has(whole, "Methods by "));
  EXPECT_THAT(verdictOf(whole), Not(HasSubstr("class=\"missing\"")));

  const auto rows = nlohmann::json::parse(files::readTextFile(folder / "out/results.json"))["rows"];
  int removed = 0;
  for (const auto& row : rows)
    if (row["method"] == "naive_flow" && ++removed <= 2)
      fs::remove_all(folder / ("out/" + row["folder"].get<std::string>()));
  rasterslam("bench merge out -o out", folder.path());
  EXPECT_THAT(verdictOf(pageOf("out", folder)),
              HasSubstr("of its logs and runs 2 are missing (runs: naive_flow 2)"));

  for (const auto& row : rows) fs::remove_all(folder / ("out/" + row["folder"].get<std::string>()));
  rasterslam("bench merge out -o out", folder.path());
  const auto none = pageOf("out", folder);
  EXPECT_THAT(verdictOf(none), HasSubstr("<p>No run has ended.</p>"));
  EXPECT_THAT(verdictOf(none), HasSubstr("naive_flow 3, naive_wheel 3"));

  fs::remove(folder / "out/summary.json");
  const auto refused = rasterslam("report out -o page.html --overwrite", folder.path());
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("out: is a sweep without tables"));
}

TEST(Report, ExplorationsHaveTheirCurvesGoalsAndReplays) {
  const testing::TempFolder folder;
  const auto explore = rasterslam(
      "explore flat --strategy nearest_frontier,wall_follow --slam truth --seeds 4 --duration 15 "
      "--set lidar.beams=61 -q -o out",
      folder.path());
  ASSERT_EQ(explore.exit_code, 0) << explore.err;
  const auto page = pageOf("out", folder);
  for (const char* id : {"id=\"coverage-path\"", "id=\"coverage-time\""}) EXPECT_TRUE(has(page, id)) << id;
  EXPECT_EQ(countOf("<g data-series=", page), 16U);  // two charts, every run
  const auto replays = replaysOf(page);
  ASSERT_EQ(replays.size(), 6U);
  EXPECT_EQ(replays[0]["name"], "nearest_frontier, seed 1");
  EXPECT_EQ(replays[1]["name"], "wall_follow, seed 1");
  EXPECT_FALSE(replays[0]["goals"].empty());
  EXPECT_EQ(replays[0]["moments"][0][1], "decision");
  EXPECT_EQ(replays[0]["operations"][0], "");
  // The log's first line, to four digits: nearest_frontier begins with a turn.
  const auto log = files::readTextFile(folder / "out/nearest_frontier/seed_1/run.operations.txt");
  ASSERT_EQ(log[0], 't');
  const std::string first = replays[0]["operations"][1];
  EXPECT_EQ(first[0], 't');
  EXPECT_NEAR(std::stod(first.substr(2)), std::stod(log.substr(2)), 5e-5);
  EXPECT_THAT(verdictOf(page),
              ContainsRegex("maps and replay of 6 of 8 runs only; &#39;rasterslam report [^ ]*seed_4&#39;"));

  ASSERT_EQ(rasterslam("explore flat --strategy nearest_frontier,wall_follow --slam truth --duration 5 "
                       "--set lidar.beams=61 -q --tables-only -o bare",
                       folder.path())
                .exit_code,
            0);
  const auto bare = pageOf("bare", folder);
  EXPECT_THAT(verdictOf(bare), HasSubstr("no curves and no replay"));
  EXPECT_TRUE(replaysOf(bare).empty());
}

TEST(Report, OneExplorationSaysHowMuchItSawAndHasItsGoals) {
  const testing::TempFolder folder;
  ASSERT_EQ(rasterslam("explore flat --strategy nearest_frontier --slam truth --duration 15 "
                       "--set lidar.beams=61 -q -o out",
                       folder.path())
                .exit_code,
            0);
  const auto page = pageOf("out", folder);
  EXPECT_THAT(verdictOf(page), ContainsRegex("nearest_frontier explored [0-9.]+ % of what can be explored"));
  EXPECT_TRUE(has(page, "id=\"coverage-path\""));
  EXPECT_FALSE(replaysOf(page)[0]["goals"].empty());
}

TEST(Report, DrivesToAGoalHaveTheirPathsStatesAndGoal) {
  const testing::TempFolder folder;
  rasterslam("navigate flat --goal '7 2' --method bug2,tangent -q -o out", folder.path());
  const auto page = pageOf("out", folder);
  const auto replays = replaysOf(page);
  ASSERT_EQ(replays.size(), 2U);
  EXPECT_EQ(replays[0]["name"], "bug2");
  EXPECT_EQ(replays[0]["goals"], nlohmann::json::parse("[[0.0, 7.0, 2.0]]"));
  EXPECT_EQ(replays[0]["moments"][0][1], "to goal");
  EXPECT_TRUE(has(page, "id=\"plan-0\""));
  fs::remove_all(folder / "out/tangent");
  EXPECT_THAT(verdictOf(pageOf("out", folder)), HasSubstr("no path of tangent"));
}

TEST(Report, WithoutTruthTheMethodThatOthersAgreeWithComesFirst) {
  const testing::TempFolder folder;
  ASSERT_EQ(rasterslam("simulate flat --duration 20 -q -o known.rawlog", folder.path()).exit_code, 0);
  fs::copy(folder / "known.rawlog", folder / "lone.rawlog");
  ASSERT_EQ(
      rasterslam("compare lone.rawlog --methods naive_wheel,graph,icp,naive_flow -q -o out", folder.path())
          .exit_code,
      0);
  const auto rows = nlohmann::json::parse(files::readTextFile(folder / "out/scores.json"))["rows"];
  const auto nearest = std::min_element(rows.begin(), rows.end(), [](const auto& a, const auto& b) {
    return a["agreement_m"] < b["agreement_m"];
  });
  const std::string name = (*nearest)["method"];
  ASSERT_NE(name, "naive_wheel") << "the first in the table must not be first by chance";
  const auto page = pageOf("out", folder);
  EXPECT_THAT(verdictOf(page), HasSubstr(name + " is nearest to what the others say"));
  EXPECT_EQ(replaysOf(page)[0]["runs"][0]["name"], name);
}

TEST(Report, OfALogOf100000ScansThePlayerShowsSomeAndSaysSo) {
  const testing::TempFolder folder;
  ASSERT_EQ(rasterslam("simulate flat --duration 20000 --strategy random_heading --set lidar.beams=5 "
                       "-q -o long.rawlog",
                       folder.path())
                .exit_code,
            0);
  ASSERT_EQ(rasterslam("run naive_wheel long.rawlog -q -o run", folder.path()).exit_code, 0);
  const auto page = pageOf("run", folder);
  EXPECT_THAT(notesOf(page),
              HasSubstr("Of the log&#39;s 100001 scans the player shows 2000, evenly chosen."));
  EXPECT_THAT(notesOf(page),
              ContainsRegex("The robot had [0-9]+ events, of which [0-9]+ are listed: collision one in"));
  EXPECT_EQ(replaysOf(page)[0]["operations"].size(), 2000U);
  EXPECT_LT(page.size(), 3U << 20);
}

}  // namespace
}  // namespace slam::apps

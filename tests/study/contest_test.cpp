#include "libslam/study/contest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/resources/resources.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::study {
namespace {
using slam::testing::errorOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

ContestRequest request(std::vector<std::string> entries, std::uint64_t seed = 1) {
  ContestRequest request;
  request.entries = std::move(entries);
  request.suite_path = resources::configsFolder() + "/suites/contest.ini";
  request.seed = seed;
  request.seeds = 3;
  return request;
}

TEST(ContestSuite, DrawsBuildingsAndDrivesFromItsSeed) {
  const auto first = contestSuite(request({"graph", "naive_wheel"}));
  const auto again = contestSuite(request({"graph", "naive_wheel"}));
  const auto other = contestSuite(request({"graph", "naive_wheel"}, 2));
  ASSERT_EQ(first.worlds.size(), 4U);
  std::set<std::uint64_t> seeds;
  for (std::size_t i = 0; i < first.worlds.size(); ++i) {
    EXPECT_EQ(first.worlds[i].sha256, again.worlds[i].sha256);
    EXPECT_NE(first.worlds[i].sha256, other.worlds[i].sha256);
    seeds.insert(first.worlds[i].seed);
  }
  EXPECT_EQ(seeds.size(), 4U);
  EXPECT_EQ(first.seeds.size(), 3U);
  EXPECT_EQ(first.seeds, again.seeds);
  EXPECT_NE(first.seeds, other.seeds);
  EXPECT_EQ(first.options.baseline, "graph");
}

TEST(ContestSuite, TakesFilesByTheirPath) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "mine.ini",
                             "[method]\ntype = external\ncommand = cp {scans} {output}\n");
  auto with_file = request({"mine.ini", "graph"});
  with_file.folder = folder.path();
  const auto suite = contestSuite(with_file);
  ASSERT_EQ(suite.methods.size(), 2U);
  EXPECT_EQ(suite.methods.front().name, "mine");
  EXPECT_EQ(suite.options.baseline, "mine");
}

TEST(ContestSuite, RefusesWhatCannotBeHeld) {
  EXPECT_THAT(errorOf([] { contestSuite(request({"graph"})); }), HasSubstr("found 1 entries, expected two"));
  EXPECT_THAT(errorOf([] {
                contestSuite(request({"graph", "./none.ini"}));
              }),
              HasSubstr("./none.ini: no such file"));
  EXPECT_THAT(errorOf([] { contestSuite(request({"graph", "grahp"})); }), HasSubstr("graph"));
  EXPECT_THAT(errorOf([] { contestSuite(request({"graph", "graph"})); }), HasSubstr("graph"));
}

/// A sweep of one setting; values[m][s], infinite where the run crashed.
struct Drawn {
  sweep::SweepPlan plan;
  summary::SweepResults results;
};
Drawn drawn(const std::vector<std::string>& methods, const std::vector<std::vector<double>>& values) {
  Drawn sweep;
  sweep.plan.metric = "ate_final_m";
  sweep.plan.baseline = methods.front();
  sweep.plan.failure_ate_m = 1;
  for (std::size_t s = 0; s < values.front().size(); ++s) {
    sweep.plan.logs.push_back({"log" + std::to_string(s), "w", "r", "l", "o", "s", "f", s + 1});
    for (std::size_t m = 0; m < methods.size(); ++m) {
      sweep.plan.runs.push_back({"run", s, s + 1, methods[m], ""});
      sweep::CellResult result;
      if (std::isinf(values[m][s]))
        result.status = "failed", result.message = "exit code 7";
      else
        result.figures = {{"ate_final_m", values[m][s]}};
      sweep.results.emplace_back(result);
    }
  }
  return sweep;
}

std::string text(const table::CellValue& cell) {
  return std::get<std::string>(cell);
}

TEST(Standings, PutTheBestFirstAndShareThePlaceOfWhatCannotBeToldApart) {
  const double inf = std::numeric_limits<double>::infinity();
  const auto sweep =
      drawn({"poor", "good", "alike", "crash"}, {{0.31, 0.32, 0.33, 0.34, 0.35, 0.36, 0.37, 0.38, 0.39, 0.4},
                                                 {0.1, 0.11, 0.12, 0.13, 0.14, 0.15, 0.16, 0.17, 0.18, 0.19},
                                                 {0.11, 0.1, 0.13, 0.12, 0.15, 0.14, 0.17, 0.16, 0.19, 0.18},
                                                 {inf, inf, inf, inf, inf, inf, inf, inf, inf, inf}});
  const auto standings = standingsOf(sweep.plan, sweep.results);
  const auto& rows = standings.table.rows;
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_THAT((std::set<std::string>{text(rows[0][1]), text(rows[1][1])}), ElementsAre("alike", "good"));
  EXPECT_EQ(text(rows[0][0]), "1");
  EXPECT_EQ(text(rows[1][0]), "1");
  EXPECT_EQ(text(rows[2][0]), "3");
  EXPECT_EQ(text(rows[2][1]), "poor");
  EXPECT_EQ(text(rows[3][1]), "crash");
  EXPECT_EQ(text(rows[3][4]), "10 of 10");
  EXPECT_EQ(text(standings.full.rows[3][6]), "failed: exit code 7");
  EXPECT_THAT(standings.verdict.front(), HasSubstr("First place is shared"));
}

TEST(Standings, OfNothingSaySo) {
  auto sweep = drawn({"a", "b"}, {{0.1}, {0.2}});
  sweep.results.front().reset();
  const auto standings = standingsOf(sweep.plan, sweep.results);
  EXPECT_TRUE(standings.table.rows.empty());
  EXPECT_EQ(standings.verdict.front(), "No drive was finished by every entry.");
}

}  // namespace
}  // namespace slam::study

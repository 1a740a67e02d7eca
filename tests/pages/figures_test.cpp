#include "libslam/pages/figures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "libslam/core/error.h"
#include "libslam/testing/temp_folder.h"

namespace slam::pages {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

template <class Work>
std::string inputErrorOf(Work work) {
  try {
    work();
  } catch (const core::InputError& e) {
    return e.what();
  }
  return "no error";
}

table::Table results() {
  return table::fromCsv(
      "world,lidar,seed,method,parameters,status,ate_final_m\n"
      "flat,wide,1,graph,,ok,0.1\n"
      "flat,wide,1,icp,icp.x=2,ok,0.4\n"
      "flat,wide,2,graph,,ok,0.2\n"
      "flat,wide,2,icp,icp.x=2,timeout,\n"
      "hall,wide,1,graph,,ok,0.3\n",
      "r.csv");
}

TEST(SeedBoxes, GroupByTheAxesThatVaryAndCountFailures) {
  const auto charts = seedBoxes(results(), {}, "r.csv");
  ASSERT_EQ(charts.size(), 2U);
  EXPECT_EQ(charts[0].title, "flat");  // the lidar does not vary
  EXPECT_EQ(charts[1].title, "hall");
  ASSERT_EQ(charts[0].samples.size(), 2U);
  EXPECT_EQ(charts[0].samples[0].label, "graph");
  EXPECT_THAT(charts[0].samples[0].values, ElementsAre(0.1, 0.2));
  EXPECT_EQ(charts[0].samples[1].label, "icp icp.x=2");
  EXPECT_THAT(charts[0].samples[1].values, ElementsAre(0.4));
  EXPECT_EQ(charts[0].samples[1].failed, 1U);
  EXPECT_TRUE(charts[1].samples[1].values.empty());  // the same boxes everywhere
}

TEST(SeedBoxes, TakeOnlyWhatWasChosen) {
  const auto charts = seedBoxes(results(), {"ate_final_m", {"world=flat", "seed=2"}, {"graph"}}, "r.csv");
  ASSERT_EQ(charts.size(), 1U);
  EXPECT_EQ(charts[0].title, "");
  ASSERT_EQ(charts[0].samples.size(), 1U);
  EXPECT_THAT(charts[0].samples[0].values, ElementsAre(0.2));
}

TEST(SeedBoxes, SayWhatIsWrongWithTheTableOrTheChoice) {
  const auto error = [](const SeedSelection& selection) {
    return inputErrorOf([&] { seedBoxes(results(), selection, "r.csv"); });
  };
  EXPECT_EQ(error({"ate_finl_m", {}, {}}),
            "r.csv:1: names no column 'ate_finl_m'; did you mean 'ate_final_m'?");
  EXPECT_THAT(error({"ate_final_m", {"world"}, {}}), HasSubstr("--where: found 'world', expected KEY=VALUE"));
  EXPECT_THAT(error({"ate_final_m", {"world=moon"}, {}}), HasSubstr("r.csv: none of its 5 runs was chosen"));
  table::Table many{"", {{"world", ""}, {"method", ""}, {"status", ""}, {"ate_final_m", ""}}, {}, {}};
  for (int i = 0; i < 25; ++i) many.rows.push_back({"w" + std::to_string(i), "graph", "ok", 1.0});
  EXPECT_THAT(inputErrorOf([&] { seedBoxes(many, {}, "m.csv"); }),
              HasSubstr("m.csv: has 25 combinations of its axes, expected at most 24; choose with --where"));
}

TEST(ExplorationCharts, NameStrategiesByTheirFoldersAndTellFoldersApart) {
  const testing::TempFolder folder;
  const auto write = [&](const std::string& path, const std::string& text) {
    std::filesystem::create_directories(std::filesystem::path(folder / path).parent_path());
    std::ofstream(folder / path) << text;
  };
  const std::string curve = "time_s,path_m,explored_share\n0,0,0.25\n2,1,0.5\n";
  write("many/frontier/seed_1/exploration.csv", curve);
  write("many/frontier/seed_2/exploration.csv", curve);
  write("one/exploration.csv", curve);
  write("one/runs.csv", "plan,strategy\nflat,frontier\n");
  const auto charts = explorationCharts({folder / "many", folder / "one"});
  ASSERT_EQ(charts.size(), 2U);
  ASSERT_EQ(charts[0].curves.size(), 3U);
  EXPECT_EQ(charts[0].curves[0].label, "many, frontier");
  EXPECT_EQ(charts[0].curves[2].label, "one, frontier");
  EXPECT_EQ(charts[1].curves[2].points[1].x, 1);
  EXPECT_EQ(charts[1].curves[2].points[1].y, 50);
  EXPECT_EQ(explorationCharts({folder / "one"})[0].curves[0].label, "frontier");
  std::filesystem::create_directory(folder / "empty");
  EXPECT_THAT(inputErrorOf([&] { explorationCharts({folder / "empty"}); }),
              HasSubstr("empty: holds no exploration.csv"));
  EXPECT_THAT(inputErrorOf([&] { explorationCharts({folder / "none"}); }),
              HasSubstr("none: is not a folder"));
}

TEST(ErrorChart, NeedsATruth) {
  report::ReportPage page;
  page.runs.emplace_back();
  page.runs[0].method = "graph";
  page.runs[0].path = {{100, {}}, {101, {1, 0, 0}}};
  EXPECT_THAT(inputErrorOf([&] { errorChart(page, "out", true); }), HasSubstr("out: has no errors to draw"));
  EXPECT_THAT(inputErrorOf([&] { mapPanels(page, "out"); }), HasSubstr("out: holds no map"));
  page.runs[0].error_m = {0.5, 0.25};
  const auto chart = errorChart(page, "out", true);
  ASSERT_EQ(chart.curves.size(), 1U);
  EXPECT_EQ(chart.curves[0].points[1].x, 1);  // since the first scan
  EXPECT_EQ(chart.curves[0].points[1].y, 0.25);
  EXPECT_EQ(allPaths(page).size(), 1U);
}

TEST(PathPanels, ShowEachRunWithItsOwnTruthAndPlan) {
  report::ReportPage page;
  page.runs.resize(3);
  page.replays.resize(2);
  for (std::size_t i = 0; i < 2; ++i) {  // two drives of one comparison
    page.runs[i].method = i == 0 ? "one" : "other";
    page.runs[i].path = {{0, {}}, {1, {1, 0, 0}}};
    page.runs[i].replay = i;
    page.replays[i].truth = {{0, {}}, {1, {1 + static_cast<double>(i), 0, 0}}};
    page.replays[i].plan.emplace();
    page.replays[i].plan->columns = 5 + static_cast<int>(i);
  }
  page.runs[2].method = "failed";  // left no path
  const auto panels = pathPanels(page);
  ASSERT_EQ(panels.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(panels[i].title, page.runs[i].method);
    EXPECT_EQ(panels[i].map.columns, page.replays[i].plan->columns);
    EXPECT_TRUE(panels[i].is_true);
    ASSERT_EQ(panels[i].paths.size(), 2U);
    EXPECT_TRUE(panels[i].paths[1].is_truth);
    EXPECT_EQ(panels[i].paths[1].path.back().pose.x, page.replays[i].truth.back().pose.x);
  }
  EXPECT_EQ(allPaths(page).size(), 4U);  // both truths
}

TEST(ErrorChart, IsSmoothAndDrawsTheBestLast) {
  report::ReportPage page;
  page.runs.resize(2);
  const char* names[] = {"good", "bad"};
  for (std::size_t i = 0; i < 2; ++i) {
    auto& run = page.runs[i];
    run.method = names[i];
    for (int k = 0; k <= 1000; ++k) {  // 100 s; the error is 0 or 0.2 by turns, of the second ten times that
      run.path.push_back({0.1 * k, {}});
      run.error_m.push_back((k % 2) * (i == 0 ? 0.2 : 2));
    }
  }
  page.runs[0].error_m[500] = std::nan("");  // does not count
  const auto chart = errorChart(page, "out", true);
  ASSERT_EQ(chart.curves.size(), 2U);
  EXPECT_EQ(chart.curves[0].label, "bad");
  EXPECT_EQ(chart.curves[1].label, "good");
  EXPECT_EQ(chart.y_title, "position error (m), rms over 2 s");
  for (const auto& p : chart.curves[1].points) EXPECT_NEAR(p.y, 0.2 / std::sqrt(2), 0.01) << p.x;
}

}  // namespace
}  // namespace slam::pages

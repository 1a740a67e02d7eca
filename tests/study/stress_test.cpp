#include "libslam/study/stress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/testing/error_of.h"

namespace slam::study {
namespace {
using ::testing::ElementsAre;
using ::testing::HasSubstr;

StressSuite suiteOf(const std::string& ground, const std::string& vary) {
  return stressSuite({ground, vary, "naive_wheel,icp", "1..8", {}});
}

/// Every run 0.1 m off, but those of `method` from `fails_at` down failed.
summary::SweepResults resultsOf(const StressSuite& suite, const sweep::SweepPlan& plan,
                                const std::string& method, double fails_at) {
  summary::SweepResults results;
  for (const auto& run : plan.runs) {
    sweep::CellResult result;
    result.figures = {{"ate_final_m", 0.1}};
    for (std::size_t v = 0; v < suite.values.size(); ++v)
      if (suite.names[v].count(plan.logs[run.log].fault) && run.method == method &&
          suite.values[v] <= fails_at)
        result.status = "failed";
    results.emplace_back(result);
  }
  return results;
}

TEST(Stress, VariesANumberOfTheSimulationAsFaults) {
  const auto stress = suiteOf("flat", "lidar.fov_deg=60..360:3");
  EXPECT_THAT(stress.values, ElementsAre(60, 210, 360));
  ASSERT_EQ(stress.suite.faults.size(), 3U);
  EXPECT_EQ(stress.suite.faults[1].name, "lidar.fov_deg=210");
  EXPECT_EQ(stress.suite.faults[1].overlay.find("lidar", "fov_deg")->value, "210");
  EXPECT_EQ(sweep::planSweep(stress.suite).plan.runs.size(), 48U);  // 3 values, 8 seeds, 2 methods
  // The text that goes into the sweep's folder is the same suite.
  const auto again = sweep::readSuite(files::IniFile::parse(stress.suite.text, "suite.ini"), "suite.ini",
                                      stress.suite.folder);
  EXPECT_EQ(sweep::planSweep(again).plan.runs[7].id, sweep::planSweep(stress.suite).plan.runs[7].id);
}

TEST(Stress, TakesWholeNumbersWhereTheParameterDoes) {
  EXPECT_THAT(suiteOf("flat", "living.people=0..5:4").values, ElementsAre(0, 2, 3, 5));
}

TEST(Stress, VariesTheSizeOfGeneratedBuildings) {
  const auto stress = suiteOf("office:seed=3", "world.width_m=20,30");
  ASSERT_EQ(stress.suite.worlds.size(), 2U);
  EXPECT_EQ(stress.suite.worlds[0].seed, 3U);
  EXPECT_THAT(stress.names[0], ElementsAre(stress.suite.worlds[0].name));
  EXPECT_EQ(sweep::loadWorld(stress.suite.worlds[0]).columns + 200,
            sweep::loadWorld(stress.suite.worlds[1]).columns);
}

TEST(Stress, SaysWhatItCannotVary) {
  const auto message = [](const std::string& ground, const std::string& vary) {
    return testing::errorOf([&] { suiteOf(ground, vary); });
  };
  EXPECT_THAT(message("flat", "lidar.fov_dag=1..2"), HasSubstr("lidar.fov_deg"));
  EXPECT_THAT(message("flat", "lidar.fov_deg"), HasSubstr("expected KEY=VALUES"));
  EXPECT_THAT(message("flat", "world.width_m=20..30"), HasSubstr("is not generated"));
  EXPECT_THAT(message("office:seed=1", "world.widht_m=20..30"), HasSubstr("width_m"));
  EXPECT_THAT(message("flat", "strategy.name=1..2"), HasSubstr("expected a number of the simulation"));
  EXPECT_THAT(message("flat", "lidar.fov_deg=0..90"), HasSubstr("fov_deg"));  // below its bound
}

TEST(Stress, FindsTheValueFromWhichAMethodBreaks) {
  const auto suite = suiteOf("flat", "lidar.fov_deg=60..360:4");
  const auto plan = sweep::planSweep(suite.suite).plan;
  const auto result = stress(suite, plan, resultsOf(suite, plan, "icp", 160), {});
  ASSERT_EQ(result.breaks.size(), 2U);
  EXPECT_EQ(result.breaks[0].text, "holds everywhere");
  EXPECT_THAT(result.breaks[1].broken, ElementsAre(60, 160));
  EXPECT_EQ(result.breaks[1].text, "breaks at 160 and below (holds at 260)");
  EXPECT_EQ(stress(suite, plan, resultsOf(suite, plan, "icp", 400), {}).breaks[1].text, "broken everywhere");
}

TEST(Stress, AFewFailuresProveNothing) {
  const auto suite = suiteOf("flat", "lidar.fov_deg=60..360:2");
  const auto plan = sweep::planSweep(suite.suite).plan;
  auto results = resultsOf(suite, plan, "icp", 0);
  const auto failFirst = [&](int count) {
    for (std::size_t i = 0; i < results.size() && count > 0; ++i)
      if (plan.runs[i].method == "icp") results[i]->status = "failed", --count;
    return stress(suite, plan, results, {}).breaks[1].text;
  };
  // 3 of 8: at least 0.085 of all
  EXPECT_EQ(failFirst(3), "not proven to break; failed, too few to prove it: 3 of 8 at 60");
  EXPECT_THAT(failFirst(4), HasSubstr("breaks at 60"));  // 4 of 8: at least 0.157
}

TEST(Stress, HoldsTheMedianAgainstALimitOfTheError) {
  const auto suite = suiteOf("flat", "lidar.fov_deg=60..360:2");
  const auto plan = sweep::planSweep(suite.suite).plan;
  const auto results = resultsOf(suite, plan, "icp", 0);
  EXPECT_EQ(stress(suite, plan, results, {0.1, 0.2}).breaks[0].text, "holds everywhere");
  EXPECT_EQ(stress(suite, plan, results, {0.1, 0.05}).breaks[0].text, "broken everywhere");
}

TEST(Stress, ARunThatIsMissingIsNotOneThatHolds) {
  const auto suite = suiteOf("flat", "lidar.fov_deg=60..360:2");
  const auto plan = sweep::planSweep(suite.suite).plan;
  const summary::SweepResults none(plan.runs.size());
  EXPECT_THAT(stress(suite, plan, none, {}).breaks[0].text, HasSubstr("nothing known at 60, 360"));
}

}  // namespace
}  // namespace slam::study

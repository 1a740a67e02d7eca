#include "libslam/study/tune.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/resources.h"
#include "libslam/sweep/suite.h"
#include "libslam/testing/error_of.h"

namespace slam::study {
namespace {
using ::testing::HasSubstr;

std::size_t runsOf(const std::vector<TuneRung>& rungs, std::size_t logs) {
  std::size_t runs = 0, seeds = 0;
  for (const auto& rung : rungs) runs += rung.candidates * (rung.seeds - seeds) * logs, seeds = rung.seeds;
  return runs;
}

TEST(Tune, TheScheduleUsesTheBudgetAndNoMore) {
  // Nine candidates on one seed, three on three: 9 + 3 * 2 = 15 runs.
  const auto rungs = tuneSchedule(15, 1, 3);
  ASSERT_EQ(rungs.size(), 2U);
  EXPECT_EQ(rungs[0].candidates, 9U);
  EXPECT_EQ(rungs[1].candidates, 3U);
  EXPECT_EQ(rungs[1].seeds, 3U);
  EXPECT_EQ(tuneSchedule(30, 2, 3)[0].candidates, 9U);
  for (const std::size_t budget : {3U, 14U, 40U, 200U, 5000U}) {
    const auto schedule = tuneSchedule(budget, 1, 3);
    EXPECT_LE(runsOf(schedule, 1), budget);
    EXPECT_LE(schedule.back().candidates, 3U);
  }
  EXPECT_GT(runsOf(tuneSchedule(5000, 1, 3), 1), 4000U);
  EXPECT_THAT(testing::errorOf([] { tuneSchedule(5, 2, 3); }), HasSubstr("at least 6 runs"));
}

TEST(Tune, TheParameterThatDecidesIsFound) {
  const std::vector<ValueRange> ranges = {readValueRange("0..100", ""), readValueRange("0..100", ""),
                                          readValueRange("slow, fast", "")};
  std::vector<std::vector<std::string>> settings;
  std::vector<double> scores;
  core::RandomStream random(1, "test");
  for (int i = 0; i < 60; ++i) {
    settings.push_back(
        {drawValue(ranges[0], random), drawValue(ranges[1], random), drawValue(ranges[2], random)});
    scores.push_back(std::stod(settings.back()[1]) + (settings.back()[2] == "slow" ? 30 : 0));
  }
  const auto result = sensitivities({"a.idle", "a.decides", "a.pace"}, ranges, settings, scores);
  EXPECT_LT(result[0].share, 0.1);
  EXPECT_GT(result[0].p, 0.05);
  EXPECT_GT(result[1].share, 0.5);
  EXPECT_LT(result[1].p, 0.01);
  EXPECT_EQ(result[1].best, "2..32");  // the lowest third of sixty draws
  EXPECT_EQ(result[2].best, "fast");
}

TEST(Tune, AFewCandidatesSayNothingOfSensitivity) {
  const auto result = sensitivities({"a.b"}, {readValueRange("0..1", "")}, {{"0"}, {"1"}}, {1, 2});
  EXPECT_EQ(result[0].share, 0);
  EXPECT_EQ(result[0].p, 1);
}

TEST(Tune, TheFirstFinalistThatIsProvenBetterIsChosen) {
  const auto less = stats::Better::kSmaller;
  const std::vector<double> base = {1, 2, 3, 4, 5, 6, 7, 8}, mixed = {2, 1, 4, 3, 6, 5, 8, 7};
  std::vector<double> good, better;
  for (const double value : base) good.push_back(value - 0.1), better.push_back(value - 0.5);
  const auto second = heldOutVerdict({base, mixed, good, better}, less, {});
  EXPECT_EQ(second.method, 2U);  // the best in training of those that are better, not the best here
  EXPECT_TRUE(second.is_better);
  EXPECT_DOUBLE_EQ(second.p, 3 * 2.0 / 256);  // the clearest eight pairs can be, by Holm's method of three
  EXPECT_EQ(heldOutVerdict({base, good, better}, less, {}).method, 1U);
  const auto none = heldOutVerdict({base, mixed, mixed}, less, {});
  EXPECT_EQ(none.method, 1U);
  EXPECT_FALSE(none.is_better || none.is_worse);
  const auto worse = heldOutVerdict({good, base}, less, {});
  EXPECT_TRUE(worse.is_worse);
  EXPECT_DOUBLE_EQ(worse.p, 2.0 / 256);
  EXPECT_THROW(heldOutVerdict({base}, less, {}), core::ContractError);
}

TEST(Tune, EveryShippedRangeFitsItsMethod) {
  const auto names = resources::namesInFolder(resources::configsFolder() + "/tune", ".ini");
  EXPECT_GE(names.size(), 4U);
  for (const auto& name : names) {
    const auto ranges = resources::readConfigFile(resources::configsFolder() + "/tune/" + name + ".ini");
    for (const bool high : {false, true}) {
      files::IniFile suite;
      suite.set("suite", "worlds", "flat", "");
      suite.set("suite", "methods", "edge", "");
      suite.set("method edge", "base", name, "");
      for (const auto& [key, entry] : ranges.sections().at("tune.parameters")) {
        const auto range = readValueRange(entry.value, entry.origin);
        suite.set("method edge", key, files::formatNumber(high ? range.high : range.low), entry.origin);
      }
      EXPECT_EQ(testing::errorOf([&] { sweep::readSuite(suite, name, "."); }), "no error");
    }
  }
  EXPECT_EQ(testing::errorOf([] { sweep::readSuite(resources::configsFolder() + "/suites/tune.ini"); }),
            "no error");
}

}  // namespace
}  // namespace slam::study

#include "libslam/run/sweep_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/files.h"
#include "libslam/run/sweep_index.h"
#include "libslam/testing/temp_folder.h"

namespace slam::run {
namespace {
using ::testing::HasSubstr;

/// Ten seeds of `good` (0.01 m off, 0.02, ...) and `bad` (always 0.5 m more) in one world.
struct TwoMethods {
  SweepPlan plan;
  SweepResults results;
  TwoMethods() {
    plan.name = "two";
    plan.baseline = "bad";
    plan.metric = "ate_final_m";
    plan.failure_ate_m = 1;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const std::string number = std::to_string(seed);
      plan.logs.push_back(
          {"log" + number, "hall", "built-in", "built-in", "built-in", "built-in", "built-in", seed, true});
      for (const double offset_m : {0.0, 0.5}) {
        plan.runs.push_back(
            {"run" + std::to_string(plan.runs.size()), seed - 1, seed, offset_m > 0 ? "bad" : "good", ""});
        CellResult result;
        result.id = plan.runs.back().id;
        result.figures = {{"ate_final_m", 0.01 * static_cast<double>(seed) + offset_m}, {"wall_f1", 0.9}};
        results.emplace_back(result);
      }
    }
  }
};

std::string textIn(const report::Table& table, std::size_t row, const std::string& key) {
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    if (table.columns[c].key == key) return std::get<std::string>(table.rows[row][c]);
  return "no column " + key;
}

double numberIn(const report::Table& table, std::size_t row, const std::string& key) {
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    if (table.columns[c].key == key) return std::get<double>(table.rows[row][c]);
  return std::nan("");
}

TEST(SweepTables, AMethodThatAlwaysWinsIsInAGroupOfItsOwn) {
  const TwoMethods sweep;
  const auto summary = summarize(sweep.plan, sweep.results);
  ASSERT_EQ(summary.all.rows.size(), 2U);
  EXPECT_EQ(textIn(summary.all, 0, "method"), "good");
  EXPECT_DOUBLE_EQ(numberIn(summary.all, 0, "ate_final_m"), 0.055);  // of 0.01, 0.02, ..., 0.10
  EXPECT_EQ(textIn(summary.all, 0, "group"), "a");
  EXPECT_EQ(textIn(summary.all, 1, "group"), "b");
  EXPECT_DOUBLE_EQ(numberIn(summary.all, 0, "better"), 1);
  EXPECT_DOUBLE_EQ(numberIn(summary.all, 0, "p"), 2 * std::pow(2, -10));  // of 2^10 signs two are so clear
  EXPECT_DOUBLE_EQ(numberIn(summary.all, 0, "p_holm"), 2 * std::pow(2, -10));
  EXPECT_EQ(textIn(summary.all, 0, "more_seeds"), "0");
  EXPECT_TRUE(std::isnan(numberIn(summary.all, 1, "p")));  // the baseline is not compared with itself
  // Of 0 failures in 10 Clopper and Pearson say at most 0.3085.
  EXPECT_NEAR(numberIn(summary.all, 0, "failure_rate_high"), 0.3085, 5e-5);
}

TEST(SweepTables, AFailedRunIsWorseThanAnyOther) {
  TwoMethods sweep;
  for (std::size_t i = 0; i < sweep.results.size(); i += 2)
    sweep.results[i]->figures[0].second = 1.5;  // good: lost
  for (std::size_t i = 1; i < 4; i += 2) sweep.results[i]->status = "timeout";
  const auto summary = summarize(sweep.plan, sweep.results);
  EXPECT_EQ(numberIn(summary.all, 0, "failed"), 10);
  EXPECT_EQ(numberIn(summary.all, 1, "failed"), 2);
  EXPECT_TRUE(std::isinf(numberIn(summary.all, 0, "ate_final_m")));
  EXPECT_THAT(textIn(summary.main, 0, "ate_final_m"), HasSubstr("failed"));
  EXPECT_DOUBLE_EQ(numberIn(summary.all, 0, "better"), 0.1);  // two failures against two: half a win each
  EXPECT_EQ(textIn(summary.all, 0, "group"), "b");
}

TEST(SweepTables, MissingRunsAreSaidAndLeftOutOfPairs) {
  TwoMethods sweep;
  sweep.results[0].reset();
  const auto summary = summarize(sweep.plan, sweep.results);
  EXPECT_EQ(numberIn(summary.all, 0, "runs"), 9);
  EXPECT_DOUBLE_EQ(numberIn(summary.all, 0, "p"), 2 * std::pow(2, -9));
  EXPECT_EQ(summary.main.notes.front(), "Incomplete: 1 of 20 runs are missing.");
  const auto results = resultsTable(sweep.plan, sweep.results);
  ASSERT_EQ(results.rows.size(), 20U);
  EXPECT_EQ(textIn(results, 0, "status"), "missing");
  EXPECT_EQ(textIn(results, 1, "folder"), "cells/run1");
  EXPECT_EQ(textIn(results, 1, "reproduce"), "rasterslam bench exec suite.ini --cell run1 -o again");
}

TEST(SweepTables, ASingleRunSaysSo) {
  TwoMethods sweep;
  sweep.plan.runs.resize(2);
  sweep.results.resize(2);
  const auto summary = summarize(sweep.plan, sweep.results);
  EXPECT_THAT(summary.main.notes.back(), HasSubstr("One run with one seed"));
  EXPECT_EQ(textIn(summary.main, 0, "ate_final_m"), "0.010");  // no interval
}

TEST(SweepTables, SeveralSettingsHaveARowOfAllTogether) {
  TwoMethods sweep;
  for (std::size_t i = 5; i < 10; ++i) sweep.plan.logs[i].world = "office";
  const auto summary = summarize(sweep.plan, sweep.results);
  ASSERT_EQ(summary.main.rows.size(), 6U);
  EXPECT_EQ(textIn(summary.main, 0, "world"), "all");
  EXPECT_EQ(textIn(summary.main, 4, "world"), "office");
  EXPECT_EQ(numberIn(summary.all, 0, "runs"), 10);
  EXPECT_EQ(numberIn(summary.all, 4, "runs"), 5);
  EXPECT_EQ(textIn(summary.all, 4, "group"), "a");  // five pairs can never be significant
}

TEST(SweepTables, TheIndexIsTheSameBytesEveryTime) {
  const testing::TempFolder folder;
  const TwoMethods sweep;
  writeSweepIndex(sweep.plan, sweep.results, folder / "a.sqlite");
  writeSweepIndex(sweep.plan, sweep.results, folder / "b.sqlite");
  EXPECT_EQ(core::fileSha256(folder / "a.sqlite"), core::fileSha256(folder / "b.sqlite"));
}

}  // namespace
}  // namespace slam::run

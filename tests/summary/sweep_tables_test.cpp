#include "libslam/summary/sweep_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libslam/resources/file_hash.h"
#include "libslam/summary/sweep_brief.h"
#include "libslam/summary/sweep_consistency.h"
#include "libslam/summary/sweep_index.h"
#include "libslam/testing/temp_folder.h"

namespace slam::summary {
namespace {
using ::testing::HasSubstr;

/// Ten seeds of `good` (0.01 m off, 0.02, ...) and `bad` (always 0.5 m more) in one world.
struct TwoMethods {
  sweep::SweepPlan plan;
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
        sweep::CellResult result;
        result.id = plan.runs.back().id;
        result.figures = {{"ate_final_m", 0.01 * static_cast<double>(seed) + offset_m}, {"wall_f1", 0.9}};
        results.emplace_back(result);
      }
    }
  }
};

std::string textIn(const table::Table& table, std::size_t row, const std::string& key) {
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    if (table.columns[c].key == key) return std::get<std::string>(table.rows[row][c]);
  return "no column " + key;
}

double numberIn(const table::Table& table, std::size_t row, const std::string& key) {
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    if (table.columns[c].key == key) return std::get<double>(table.rows[row][c]);
  return std::nan("");
}

TEST(SweepTables, AmongMoreMethodsMoreSeedsAreNeeded) {
  const auto seedsAmong = [](std::size_t methods) {
    sweep::SweepPlan plan;
    plan.baseline = "m0";
    plan.metric = "ate_final_m";
    SweepResults results;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      const std::string number = std::to_string(seed);
      plan.logs.push_back({"log" + number, "hall", "-", "-", "-", "-", "-", seed, true});
      for (std::size_t m = 0; m < methods; ++m) {
        plan.runs.push_back(
            {"run" + std::to_string(plan.runs.size()), seed - 1, seed, "m" + std::to_string(m), ""});
        sweep::CellResult result;
        // m1 is 0.01 m better in the mean, give or take 0.02 m.
        result.figures = {{"ate_final_m", m == 0 ? 0.2 : seed % 2 == 0 ? 0.17 : 0.21}};
        results.emplace_back(result);
      }
    }
    return std::stoi(textIn(summarize(plan, results).main, 1, "more_seeds"));
  };
  EXPECT_GT(seedsAmong(2), 10);
  EXPECT_GT(seedsAmong(6), seedsAmong(2) + 10);
}

TEST(SweepConsistency, SaysWhoIsOverconfidentAndWhoSaysNothing) {
  TwoMethods sweep;
  // `good` is overconfident online (ANEES 1.5, 2, ..., 6) and of the final poses neither (0.5 and 1.5 in
  // turn); `bad` states nothing.
  for (std::size_t i = 0; i < sweep.results.size(); i += 2) {
    const std::size_t number = i / 2 + 1;
    const double seed = static_cast<double>(number);
    auto& figures = sweep.results[i]->figures;
    figures.emplace_back("anees", 1 + seed / 2);
    figures.emplace_back("within_50_share", 0.25);
    figures.emplace_back("anees_final", i % 4 == 0 ? 0.5 : 1.5);
  }
  const auto tables = sweepConsistency(sweep.plan, sweep.results);
  ASSERT_EQ(tables.all.rows.size(), 1U);
  EXPECT_EQ(textIn(tables.all, 0, "method"), "good");
  EXPECT_EQ(numberIn(tables.all, 0, "runs"), 10);
  EXPECT_DOUBLE_EQ(numberIn(tables.all, 0, "anees"), 3.75);
  EXPECT_GT(numberIn(tables.all, 0, "anees_low"), 1);
  EXPECT_EQ(textIn(tables.all, 0, "verdict"), "overconfident");
  EXPECT_EQ(textIn(tables.main, 0, "within_50_share"), "0.250 [0.250, 0.250]");
  EXPECT_TRUE(std::isnan(numberIn(tables.all, 0, "within_95_share")));
  EXPECT_EQ(textIn(tables.all, 0, "verdict_final"), "consistent");
  for (std::size_t i = 2; i < sweep.results.size(); ++i) sweep.results[i].reset();
  EXPECT_EQ(textIn(sweepConsistency(sweep.plan, sweep.results).all, 0, "verdict"), "too few runs");
  sweep.results[0]->figures.clear();
  EXPECT_TRUE(sweepConsistency(sweep.plan, sweep.results).main.rows.empty());
}

TEST(SweepConsistency, ClaimedCertaintiesAreOverconfidentWhateverTheOthersSay) {
  TwoMethods sweep;
  for (std::size_t i = 0; i < sweep.results.size(); i += 2) {
    auto& figures = sweep.results[i]->figures;
    figures.emplace_back("anees", i % 4 == 0 ? 0.5 : 1.5);
    figures.emplace_back("singular_share", 0.04);
    figures.emplace_back("anees_final", std::nan(""));  // all were singular
    figures.emplace_back("singular_share_final", 1);
  }
  const auto tables = sweepConsistency(sweep.plan, sweep.results);
  EXPECT_EQ(textIn(tables.all, 0, "verdict"), "consistent");
  EXPECT_EQ(textIn(tables.all, 0, "verdict_final"), "overconfident");
  for (std::size_t i = 0; i < sweep.results.size(); i += 2) {
    auto& figures = sweep.results[i]->figures;
    for (auto& [key, value] : figures)
      if (key == "singular_share") value = 0.06;
  }
  EXPECT_EQ(textIn(sweepConsistency(sweep.plan, sweep.results).all, 0, "verdict"), "overconfident");
}

TEST(SweepTables, SayWhenThereAreTooFewSeedsForAnything) {
  TwoMethods sweep;
  const auto tooFew = HasSubstr("no difference in a single setting can be told from chance");
  EXPECT_THAT(summarize(sweep.plan, sweep.results).main.notes, ::testing::Not(::testing::Contains(tooFew)));
  sweep.plan.logs.resize(5);
  sweep.plan.runs.resize(10);
  sweep.results.resize(10);
  EXPECT_THAT(
      summarize(sweep.plan, sweep.results).main.notes,
      ::testing::Contains(HasSubstr("With 5 seeds no difference in a single setting can be told from chance: "
                                    "1 comparison at 5 % needs at least 6.")));
}

TEST(SweepConsistency, AllTogetherDrawsWithinEachSetting) {
  TwoMethods sweep;
  // Two buildings, 0.1 in all runs of one and 10.1 in the other's: nothing varies within them.
  for (std::size_t i = 0; i < sweep.plan.logs.size(); ++i)
    sweep.plan.logs[i].world = i % 2 == 0 ? "hall" : "cave";
  for (std::size_t i = 0; i < sweep.results.size(); i += 2)
    sweep.results[i]->figures.emplace_back("anees", i % 4 == 0 ? 0.1 : 10.1);
  const auto tables = sweepConsistency(sweep.plan, sweep.results);
  ASSERT_EQ(tables.main.rows.size(), 3U);
  EXPECT_EQ(textIn(tables.main, 0, "world"), "all");
  EXPECT_EQ(textIn(tables.main, 0, "anees"), "5.10 [5.10, 5.10]");
  EXPECT_EQ(textIn(tables.main, 1, "verdict"), "conservative");
  EXPECT_EQ(textIn(tables.main, 2, "verdict"), "overconfident");
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

TEST(SweepTables, AllTogetherIsDrawnAndRankedWithinEachSetting) {
  TwoMethods sweep;
  sweep.plan.logs.resize(4);
  sweep.plan.runs.resize(8);
  sweep.results.resize(8);
  const double good[] = {0.1, 0.1, 0.5, 0.5}, good_less_bad[] = {0.01, 0.02, -0.1, 0.2};
  for (std::size_t i = 0; i < 4; ++i) {
    if (i >= 2) sweep.plan.logs[i].world = "office";
    sweep.results[2 * i]->figures[0].second = good[i];
    sweep.results[2 * i + 1]->figures[0].second = good[i] - good_less_bad[i];
  }
  const auto summary = summarize(sweep.plan, sweep.results);
  ASSERT_EQ(textIn(summary.all, 0, "world"), "all");
  // Whatever is drawn within the buildings, the middle lies between theirs.
  EXPECT_DOUBLE_EQ(numberIn(summary.all, 0, "ate_final_m"), 0.3);
  EXPECT_DOUBLE_EQ(numberIn(summary.all, 0, "ate_final_m_low"), 0.3);
  EXPECT_DOUBLE_EQ(numberIn(summary.all, 0, "ate_final_m_high"), 0.3);
  // Better once in the office, whose two seeds are all that varies: with one degree of freedom that excludes
  // nothing.
  EXPECT_DOUBLE_EQ(numberIn(summary.all, 0, "better"), 0.25);
  EXPECT_NEAR(numberIn(summary.all, 0, "better_low"), 0, 1e-3);
  EXPECT_NEAR(numberIn(summary.all, 0, "better_high"), 1, 1e-3);
  // Ranks 1, 2 and 1, 2 of which a 1 is for `good`; in one row they would be 1, 2, 3, 4 and the 3 (p =
  // 0.625).
  EXPECT_DOUBLE_EQ(numberIn(summary.all, 0, "p"), 0.375);
  EXPECT_EQ(textIn(summary.all, 0, "more_seeds"), "-");
  EXPECT_THAT(summary.main.notes, ::testing::Contains(HasSubstr("drawing within each setting")));
}

TEST(SweepBrief, HasAllSettingsTogetherAndTheWorstOfEachMethod) {
  TwoMethods sweep;
  for (std::size_t i = 3; i < 10; ++i) sweep.plan.logs[i].world = i < 6 ? "office" : "cave";
  // `good` grows with the seed, so the cave is its worst; `bad` fails once, in the office.
  sweep.results[2 * 4 + 1]->status = "timeout";
  const auto brief = briefOf(sweep.plan, summarize(sweep.plan, sweep.results));
  ASSERT_EQ(brief.overall.rows.size(), 2U);
  EXPECT_EQ(brief.overall.columns.front().key, "method");
  EXPECT_EQ(numberIn(brief.overall, 0, "runs"), 10);
  EXPECT_EQ(brief.worst.caption, "The worst of 3 settings, by method");
  ASSERT_EQ(brief.worst.rows.size(), 2U);
  EXPECT_EQ(textIn(brief.worst, 0, "method"), "good");
  EXPECT_EQ(textIn(brief.worst, 0, "setting"), "cave");
  EXPECT_EQ(textIn(brief.worst, 1, "setting"), "office");
  EXPECT_THAT(textIn(brief.worst, 1, "failed"), HasSubstr("0.33"));
}

TEST(SweepBrief, OfASingleSettingIsTheWholeSummary) {
  const TwoMethods sweep;
  const auto summary = summarize(sweep.plan, sweep.results);
  const auto brief = briefOf(sweep.plan, summary);
  EXPECT_EQ(table::toText(brief.overall), table::toText(summary.main));
  EXPECT_TRUE(brief.worst.rows.empty());
}

TEST(SweepBrief, CountsNoSettingWithoutRuns) {
  TwoMethods sweep;
  for (std::size_t i = 5; i < 10; ++i) sweep.plan.logs[i].world = "office";
  for (std::size_t i = 10; i < 20; ++i) sweep.results[i].reset();
  const auto brief = briefOf(sweep.plan, summarize(sweep.plan, sweep.results));
  EXPECT_EQ(textIn(brief.worst, 0, "setting"), "hall");
  EXPECT_EQ(textIn(brief.worst, 1, "setting"), "hall");
}

TEST(SweepTables, SettingsThatRanOnceAreDrawnThemselves) {
  TwoMethods sweep;
  for (std::size_t i = 0; i < 10; ++i) sweep.plan.logs[i].world = "hall" + std::to_string(i);
  const auto summary = summarize(sweep.plan, sweep.results);
  EXPECT_LT(numberIn(summary.all, 0, "ate_final_m_low"), 0.055);
  EXPECT_GT(numberIn(summary.all, 0, "ate_final_m_high"), 0.055);
  EXPECT_DOUBLE_EQ(numberIn(summary.all, 0, "p"), 2 * std::pow(2, -10));
  EXPECT_THAT(summary.main.notes, ::testing::Not(::testing::Contains(HasSubstr("within each setting"))));
}

TEST(SweepTables, TheIndexIsTheSameBytesEveryTime) {
  const testing::TempFolder folder;
  const TwoMethods sweep;
  writeSweepIndex(sweep.plan, sweep.results, folder / "a.sqlite");
  writeSweepIndex(sweep.plan, sweep.results, folder / "b.sqlite");
  EXPECT_EQ(resources::fileSha256(folder / "a.sqlite"), resources::fileSha256(folder / "b.sqlite"));
}

}  // namespace
}  // namespace slam::summary

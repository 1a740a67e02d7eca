#include "libslam/study/sweep_gate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace slam::study {
namespace {
using ::testing::ElementsAre;

/// Seeds 1 and 2 in a hall and, with people about, in an office; a real log besides; one method.
struct ThreeSettings {
  sweep::SweepPlan plan;
  summary::SweepResults results;
  ThreeSettings() {
    plan.baseline = "graph";
    plan.metric = "ate_final_m";
    plan.failure_ate_m = 1;
    for (const std::uint64_t seed : {1, 2})
      add({"", "hall", "built-in", "built-in", "built-in", "built-in", "built-in", seed, true}, seed);
    for (const std::uint64_t seed : {1, 2})
      add({"", "office", "built-in", "tim571", "built-in", "built-in", "crowd", seed, true}, seed);
    add({"", "intel", "-", "-", "-", "-", "-", 0, false}, 1);
  }

 private:
  void add(const sweep::PlannedLog& log, std::uint64_t seed) {
    plan.logs.push_back(log);
    plan.runs.push_back({"", plan.logs.size() - 1, seed, "graph", ""});
    sweep::CellResult result;
    result.figures = {
        {"ate_final_m", 0.1 * static_cast<double>(plan.runs.size())}, {"wall_f1", 0.9}, {"relation_m", 0.02}};
    results.emplace_back(result);
  }
};

const score::Score& scoreOf(const std::vector<score::Score>& scores, const std::string& cell,
                            const std::string& metric) {
  static const score::Score kNone{"none", "none", {}};
  const auto at = std::find_if(scores.begin(), scores.end(), [&](const score::Score& score) {
    return score.cell == cell && score.metric == metric;
  });
  return at == scores.end() ? kNone : *at;
}

TEST(SweepGate, NamesACellByItsMethodAndWhatIsNotBuiltIn) {
  const ThreeSettings sweep;
  const auto scores = scoresOf(sweep.plan, sweep.results);
  const auto hall = scoreOf(scores, "graph on hall", "ate_final_m");
  EXPECT_THAT(hall.values, ElementsAre(0.1, 0.2));
  EXPECT_THAT(hall.seeds, ElementsAre(1, 2));
  EXPECT_EQ(scoreOf(scores, "graph on office, lidar tim571, fault crowd", "wall_f1").values.size(), 2U);
  EXPECT_THAT(scoreOf(scores, "graph on intel", "relation_m").values, ElementsAre(0.02));
  EXPECT_TRUE(std::isnan(scoreOf(scores, "graph on intel", "free_iou").values.at(0)));
  EXPECT_EQ(scoreOf(scores, "graph on hall", "path_length_m").cell, "none");  // has no better side
}

TEST(SweepGate, ARunThatFailedHasFailedByEveryFigure) {
  ThreeSettings sweep;
  sweep.results[0]->status = "timeout";
  sweep.results[1]->figures[0].second = 2;  // m off: more than failure_ate_m
  sweep.results[2].reset();
  const auto scores = scoresOf(sweep.plan, sweep.results);
  EXPECT_THAT(scoreOf(scores, "graph on hall", "ate_final_m").values, ElementsAre(INFINITY, INFINITY));
  EXPECT_THAT(scoreOf(scores, "graph on hall", "wall_f1").values, ElementsAre(-INFINITY, -INFINITY));
  const auto& missing = scoreOf(scores, "graph on office, lidar tim571, fault crowd", "wall_f1").values;
  EXPECT_TRUE(std::isnan(missing.at(0)));
  EXPECT_EQ(missing.at(1), 0.9);
}

TEST(SweepGate, ABaselineHoldsTheFiguresOfTheSummary) {
  const ThreeSettings sweep;
  const auto gate = score::updatedGate({}, summaryScoresOf(sweep.plan, sweep.results));
  std::vector<std::string> metrics;
  for (const auto& row : gate.rows) {
    metrics.push_back(row.baseline.metric);
    EXPECT_EQ(row.baseline.seeds.size(), row.baseline.values.size());
  }
  EXPECT_THAT(metrics,
              ElementsAre("ate_final_m", "wall_f1", "ate_final_m", "wall_f1", "ate_final_m", "wall_f1"));
  // A run that fails where none did before is worse, whatever the tolerance.
  ThreeSettings later;
  later.results[3]->status = "crashed";
  const auto findings = score::checkGate(gate, scoresOf(later.plan, later.results));
  EXPECT_TRUE(score::gateIsShut(findings));
  EXPECT_EQ(
      std::count_if(findings.begin(), findings.end(),
                    [](const score::GateFinding& f) { return f.verdict == score::GateVerdict::kWorse; }),
      2);
}

}  // namespace
}  // namespace slam::study

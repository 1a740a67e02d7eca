#include "libslam/score/gate.h"
#include "libslam/core/numbers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::score {
namespace {
using slam::testing::errorOf;
using stats::Better;
using ::testing::AllOf;
using ::testing::HasSubstr;

using core::kNaN;
const double kFailed = stats::failedValue(Better::kSmaller);

GateRow ateRow(std::vector<double> values, double relative, double absolute) {
  return {{"graph", "ate_rmse_m", std::move(values)}, Better::kSmaller, relative, absolute};
}

GateFinding found(const GateRow& row, std::vector<double> values) {
  return checkGate({0.05, {row}}, {{row.baseline.cell, row.baseline.metric, std::move(values)}}).at(0);
}

GateVerdict verdict(const GateRow& row, std::vector<double> values) {
  return found(row, std::move(values)).verdict;
}

TEST(Gate, AllowsTheLargerOfBothTolerances) {
  const auto row = ateRow({1}, 0.125, 0.0625);  // exact in binary: the edge itself is within
  EXPECT_EQ(verdict(row, {1.125}), GateVerdict::kWithin);
  EXPECT_EQ(verdict(row, {1.13}), GateVerdict::kWorse);
  EXPECT_EQ(verdict(row, {0.875}), GateVerdict::kWithin);
  EXPECT_EQ(verdict(row, {0.87}), GateVerdict::kBetter);
  EXPECT_EQ(verdict(ateRow({1}, 0.1, 0.5), {1.4}), GateVerdict::kWithin);
  EXPECT_EQ(verdict(ateRow({1}, 0, 0), {1}), GateVerdict::kWithin);
  EXPECT_EQ(verdict(ateRow({1}, 0, 0), {std::nextafter(1, 2)}), GateVerdict::kWorse);
}

TEST(Gate, KnowsWhichWayIsBetter) {
  const GateRow row{{"graph", "wall_f1", {0.9}}, Better::kLarger, 0.1, 0};
  EXPECT_EQ(verdict(row, {0.8}), GateVerdict::kWorse);
  EXPECT_EQ(verdict(row, {0.82}), GateVerdict::kWithin);
  EXPECT_EQ(verdict(row, {1}), GateVerdict::kBetter);
}

TEST(Gate, ExcusesWhatChanceCanExplainOnceSeedsAreManyEnough) {
  const std::vector<double> before = {1, 2, 3, 4, 5, 6, 7, 8};
  // Each seed a little worse: as clear as eight pairs can be, 2/256.
  const auto clear = found(ateRow(before, 0, 0.1), {1.2, 2.2, 3.2, 4.2, 5.2, 6.2, 7.2, 8.2});
  EXPECT_EQ(clear.verdict, GateVerdict::kWorse);
  EXPECT_DOUBLE_EQ(*clear.p, 2.0 / 256);
  // The same medians, but half of the seeds better.
  const auto mixed = found(ateRow(before, 0, 0.1), {0.7, 1.6, 2.5, 4.7, 4.7, 7, 7.5, 9});
  EXPECT_NEAR(mixed.now - mixed.before, 0.2, 1e-12);
  EXPECT_EQ(mixed.verdict, GateVerdict::kUnsure);
  EXPECT_GT(*mixed.p, 0.05);
  // With five no test can tell, so the tolerance decides.
  const auto few = found(ateRow({1, 2, 3, 4, 5}, 0, 0.1), {1.2, 2.2, 3.2, 4.2, 4.9});
  EXPECT_EQ(few.verdict, GateVerdict::kWorse);
  EXPECT_GT(*few.p, 0.05);
  // Other numbers of seeds do not pair up.
  EXPECT_FALSE(found(ateRow(before, 0, 0.1), {1, 2}).p);
}

TEST(Gate, PairsUpTheSeedsThatBothHave) {
  GateRow row = ateRow({1, 2, 3, 4, 5, 6, 7}, 0, 0.1);
  row.baseline.seeds = {1, 2, 3, 4, 5, 6, 7};
  // In another order, one seed more and one less: 2 to 7, each worse by 0.2.
  const Score now{"graph", "ate_rmse_m", {7.2, 6.2, 5.2, 4.2, 3.2, 2.2, 0}, {7, 6, 5, 4, 3, 2, 9}};
  const auto finding = checkGate({0.05, {row}}, {now}).at(0);
  EXPECT_DOUBLE_EQ(finding.before, 4.5);
  EXPECT_DOUBLE_EQ(finding.now, 4.7);
  EXPECT_EQ(finding.values.size(), 6U);
  EXPECT_DOUBLE_EQ(*finding.p, 2.0 / 64);
  EXPECT_EQ(finding.verdict, GateVerdict::kWorse);
  const auto apart = checkGate({0.05, {row}}, {{"graph", "ate_rmse_m", {1, 1}, {8, 9}}}).at(0);
  EXPECT_EQ(apart.verdict, GateVerdict::kMissing);
  EXPECT_DOUBLE_EQ(apart.before, 4);
}

TEST(Gate, IsShutByANewFailureEvenWhereTheMedianHolds) {
  const std::vector<double> before = {1, 1, 1, 1}, one_failed = {1, 1, 1, kFailed};
  EXPECT_EQ(verdict(ateRow(before, 9, 9), one_failed), GateVerdict::kWorse);
  EXPECT_EQ(verdict(ateRow(one_failed, 9, 9), one_failed), GateVerdict::kWithin);
  EXPECT_EQ(verdict(ateRow(one_failed, 0, 0), before), GateVerdict::kWithin);
  // One of four is as often as two of eight.
  EXPECT_EQ(verdict(ateRow(one_failed, 0, 0), {1, 1, 1, 1, 1, 1, kFailed, kFailed}), GateVerdict::kWithin);
  EXPECT_EQ(verdict(ateRow({kFailed}, 0.1, 0), {kFailed}), GateVerdict::kWithin);
  EXPECT_EQ(verdict(ateRow({kFailed}, 0.1, 0), {5}), GateVerdict::kBetter);
}

TEST(Gate, IsShutByWhatIsMissing) {
  const auto row = ateRow({1}, 0.1, 0);
  EXPECT_EQ(verdict(row, {kNaN}), GateVerdict::kMissing);
  EXPECT_EQ(verdict(row, {}), GateVerdict::kMissing);
  const auto findings = checkGate({0.05, {row}}, {});
  EXPECT_EQ(findings.at(0).verdict, GateVerdict::kMissing);
  EXPECT_TRUE(gateIsShut(findings));
  EXPECT_FALSE(gateIsShut(checkGate({0.05, {row}}, {{"graph", "ate_rmse_m", {1}}})));
  EXPECT_FALSE(gateIsShut({}));
}

TEST(Gate, ReadsWhatItWrites) {
  const testing::TempFolder folder;
  Gate gate{0.01,
            {ateRow({0.1, kFailed, 0.3}, 0.1, 0.001),
             {{"icp", "wall_f1", {0.9}}, Better::kLarger, 0, 0.5},
             {{"icp", "free_iou", {stats::failedValue(Better::kLarger)}}, Better::kLarger, 0, 0}}};
  gate.rows[0].baseline.seeds = {4, 7, 9};
  writeGate(gate, folder / "gate.json");
  const auto read = readGate(folder / "gate.json");
  EXPECT_EQ(read.alpha, 0.01);
  ASSERT_EQ(read.rows.size(), 3U);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read.rows[i].baseline.cell, gate.rows[i].baseline.cell);
    EXPECT_EQ(read.rows[i].baseline.metric, gate.rows[i].baseline.metric);
    EXPECT_EQ(read.rows[i].baseline.values, gate.rows[i].baseline.values);
    EXPECT_EQ(read.rows[i].baseline.seeds, gate.rows[i].baseline.seeds);
    EXPECT_EQ(read.rows[i].better, gate.rows[i].better);
    EXPECT_EQ(read.rows[i].relative, gate.rows[i].relative);
    EXPECT_EQ(read.rows[i].absolute, gate.rows[i].absolute);
  }
  EXPECT_THROW(writeGate({0.05, {ateRow({}, 0, 0)}}, folder / "x.json"), core::ContractError);
  EXPECT_THROW(writeGate({0.05, {ateRow({kNaN}, 0, 0)}}, folder / "x.json"), core::ContractError);
}

TEST(Gate, SaysWhichRowAndKeyOfTheFileIsWrong) {
  const testing::TempFolder folder;
  const auto errorWith = [&](const std::string& text) {
    files::writeFileAtomically(folder / "gate.json", text);
    return errorOf([&] { readGate(folder / "gate.json"); });
  };
  const auto row = [](const std::string& rest) {
    return R"({"rows": [{"cell": "graph", "metric": "ate_rmse_m", "better": "smaller")" + rest + "}]}";
  };
  EXPECT_EQ(errorWith(row(R"(, "value": 1)")), "no error");
  EXPECT_THAT(errorWith("{"), HasSubstr("gate.json: is not JSON"));
  EXPECT_THAT(errorWith("[]"), HasSubstr("gate.json: expected an object"));
  EXPECT_THAT(errorWith("{}"), HasSubstr("gate.json: key 'rows' is missing"));
  EXPECT_THAT(errorWith(R"({"rows": []})"), HasSubstr("key 'rows': found [], expected a list of at least"));
  EXPECT_THAT(errorWith(R"({"alpha": 2, "rows": []})"), HasSubstr("key 'alpha': found 2"));
  EXPECT_THAT(errorWith(R"({"rows": [3]})"), HasSubstr("gate.json: row 1: expected an object"));
  EXPECT_THAT(errorWith(row("")), HasSubstr("gate.json: row 1: key 'value' is missing"));
  EXPECT_THAT(errorWith(row(R"(, "value": "1")")),
              HasSubstr("row 1: key 'value': found \"1\", expected a number, or null"));
  EXPECT_THAT(errorWith(row(R"(, "values": [])")), HasSubstr("key 'values': found []"));
  EXPECT_THAT(errorWith(row(R"(, "values": [1, true])")), HasSubstr("key 'values': found true"));
  for (const char* seeds : {"[1]", "[1, 1]", "[1, -2]", "[1, 2.5]", "3"})
    EXPECT_THAT(errorWith(row(R"(, "values": [1, 2], "seeds": )" + std::string(seeds))),
                HasSubstr("key 'seeds': found "))
        << seeds;
  EXPECT_THAT(errorWith(row(R"(, "value": 1, "relative": -1)")), HasSubstr("key 'relative': found -1"));
  EXPECT_THAT(errorWith(row(R"(, "value": 1, "absolut": 1)")), HasSubstr("row 1: unknown key 'absolut'"));
  EXPECT_THAT(errorWith(R"({"rows": [{"cell": "a", "metric": "b", "better": "more", "value": 1}]})"),
              HasSubstr("key 'better': found \"more\", expected smaller or larger"));
  const std::string twice = R"({"cell": "a", "metric": "b", "better": "larger", "value": 1})";
  EXPECT_THAT(errorWith(R"({"rows": [)" + twice + ", " + twice + "]}"),
              HasSubstr("row 2: key 'metric': found 'b' of 'a' a second time"));
  EXPECT_THAT(errorOf([&] { readGate(folder / "none.json"); }), HasSubstr("none.json"));
}

TEST(Gate, IsMadeOfWhatHasABetterSideAndNoClock) {
  const Gate made = updatedGate({}, {{"graph", "ate_rmse_m", {0.5}},
                                     {"graph", "wall_f1", {0.9}},
                                     {"graph", "end_x_m", {3}},
                                     {"graph", "ms_per_scan", {3}},
                                     {"graph", "free_iou", {kNaN}},
                                     {"graph final", "translation_mean_m", {0.01}}});
  ASSERT_EQ(made.rows.size(), 3U);
  EXPECT_EQ(made.rows[0].better, Better::kSmaller);
  EXPECT_EQ(made.rows[0].relative, 0.1);
  EXPECT_DOUBLE_EQ(made.rows[0].absolute, 0.001);
  EXPECT_EQ(made.rows[1].better, Better::kLarger);
  EXPECT_DOUBLE_EQ(made.rows[2].absolute, 0.0001);
}

TEST(Gate, KeepsTolerancesAndOtherCellsWhenItIsUpdated) {
  Gate old{0.01, {ateRow({0.5}, 0.3, 0.2), {{"icp", "ate_rmse_m", {2}}, Better::kSmaller, 0, 0}}};
  const Gate made = updatedGate(old, {{"graph", "ate_rmse_m", {0.4}}});
  EXPECT_EQ(made.alpha, 0.01);
  ASSERT_EQ(made.rows.size(), 2U);
  EXPECT_EQ(made.rows[0].baseline.cell, "icp");
  EXPECT_EQ(made.rows[1].baseline.values, std::vector<double>{0.4});
  EXPECT_EQ(made.rows[1].relative, 0.3);
  EXPECT_EQ(made.rows[1].absolute, 0.2);
}

TEST(Gate, LooksOnlyAtTheCellsThatWereMeasured) {
  const Gate gate{0.05, {ateRow({0.5}, 0, 0), {{"icp", "ate_rms_m", {2}}, Better::kSmaller, 0, 0}}};
  EXPECT_EQ(rowsOfMeasured(gate, {{"graph", "ate_rmse_m", {kNaN}}}, "g.json").rows.size(), 1U);
  EXPECT_THAT(errorOf([&] {
                rowsOfMeasured(gate, {{"icp", "ate_rmse_m", {1}}}, "g.json");
              }),
              AllOf(HasSubstr("g.json: row 2: key 'metric': found 'ate_rms_m'"),
                    HasSubstr("did you mean 'ate_rmse_m'?")));
  EXPECT_THAT(errorOf([&] {
                rowsOfMeasured(gate, {{"grap", "ate_rmse_m", {1}}}, "g.json");
              }),
              AllOf(HasSubstr("found none for 'grap'"), HasSubstr("did you mean 'graph'?")));
}

TEST(Gate, TableShowsWhatIsNotWithin) {
  const Gate gate{0.05, {ateRow({0.5}, 0, 0), {{"icp", "ate_rmse_m", {2}}, Better::kSmaller, 0, 0}}};
  const auto findings = checkGate(gate, {{"graph", "ate_rmse_m", {0.5}}, {"icp", "ate_rmse_m", {3}}});
  const auto shown = gateTable(findings, "g.json", Detail::kShort);
  ASSERT_EQ(shown.rows.size(), 1U);
  EXPECT_EQ(std::get<std::string>(shown.rows[0].back()), "WORSE");
  EXPECT_THAT(shown.notes.at(0), HasSubstr("of 2 figures 1 within their tolerance, 0 better, 0 worse but"));
  EXPECT_THAT(shown.notes.at(1), HasSubstr("One run with one seed"));
  EXPECT_EQ(gateTable(findings, "g.json", Detail::kFull).rows.size(), 2U);
}

}  // namespace
}  // namespace slam::score

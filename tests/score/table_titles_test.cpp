#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "libslam/score/evaluate.h"
#include "libslam/score/metric_infos.h"
#include "libslam/score/relation_tables.h"

namespace slam::score {
namespace {
using ::testing::MatchesRegex;
using ::testing::Not;

/// "occu- pied" let a heading break where no word ends, and stood in JSON as it is.
TEST(TableTitles, HoldWholeWords) {
  for (const auto& info : metricInfos()) EXPECT_THAT(info.title, Not(MatchesRegex(".*[a-z]- ?[a-z].*")));
  for (const auto& column : relationTable({}, Detail::kFull).columns)
    EXPECT_THAT(column.title, Not(MatchesRegex(".*[a-z]- ?[a-z].*")));
}

std::size_t widestLine(const std::string& text) {
  std::istringstream lines(text);
  std::size_t most = 0;
  for (std::string line; std::getline(lines, line);) most = std::max(most, line.size());
  return most;
}

TEST(TableTitles, LeaveTheTablesOfRealLogsInOnePart) {
  Evaluation evaluation;
  evaluation.method = "naive_correlation";
  evaluation.path_length_m = 608.37, evaluation.agreement_m = 11.618, evaluation.wall_thickness_m = 0.1057;
  evaluation.on_wall_share = evaluation.through_wall_share = evaluation.structure.occupied_share = 1;
  evaluation.structure.corners = 649, evaluation.structure.enclosed_areas = 39000;
  const auto agreement = agreementTable({evaluation}, Detail::kShort);
  EXPECT_EQ(agreement.columns.size(), 9U);
  const auto text = table::toText({"", agreement.columns, agreement.rows, {}});
  EXPECT_LE(widestLine(text), 80U);
  EXPECT_EQ(text.find("\n\n"), std::string::npos) << text;

  RelationScore score;
  score.path = "particles online";
  score.error.translation_m = {0.1450, 0.3695, 0.1576, 1.2, 0.05, 3.000};
  score.error.rotation_rad = {0.0076, 0.0096, 1.5e-4, 1e-3, 0.003, 0.11};
  score.error.scored = 23000;
  score.within_95_share = 0.94;
  const auto relations = relationTable({score}, Detail::kShort);
  const auto shown = table::toText({"", relations.columns, relations.rows, {}});
  EXPECT_LE(widestLine(shown), 80U);
  EXPECT_EQ(shown.find("\n\n"), std::string::npos) << shown;
}

}  // namespace
}  // namespace slam::score

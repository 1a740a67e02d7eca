#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "libslam/logs/relations_io.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/testing/temp_folder.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
using ::testing::HasSubstr;

TEST(EvalByRelations, ScoresATrajectoryByItself) {
  const testing::TempFolder folder;
  logs::writeTum({{1, {0, 0, 0}}, {2, {1, 0, 0}}, {3, {2, 0, 0}}}, folder / "path.tum");
  logs::writeRelations({{1, 2, {1, 0, 0}}, {1, 3, {1.9, 0, 0}}, {3, 9, {0, 0, 0}}}, folder / "a.relations");
  const auto text = rasterslam("eval " + (folder / "path.tum") + " --relations " + (folder / "a.relations"));
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("error against 2 relations"));
  EXPECT_THAT(text.out, HasSubstr("0.0500"));
  EXPECT_THAT(text.out, HasSubstr("1 relations name a stamp outside the trajectory: not scored."));
  const auto json =
      rasterslam("eval " + (folder / "path.tum") + " --json --relations " + (folder / "a.relations"));
  const auto rows = nlohmann::json::parse(json.out)["relations"]["rows"];
  EXPECT_NEAR(rows[0]["mean"].get<double>(), 0.05, 1e-9);
  EXPECT_NEAR(rows[0]["max"].get<double>(), 0.1, 1e-9);
}

TEST(EvalByRelations, RefusesWhatDoesNotBelongTogether) {
  const testing::TempFolder folder;
  logs::writeTum({{1, {0, 0, 0}}, {2, {1, 0, 0}}}, folder / "path.tum");
  logs::writeRelations({{100, 200, {1, 0, 0}}}, folder / "a.relations");
  const std::string command = "eval " + (folder / "path.tum") + " --relations " + (folder / "a.relations");
  const auto other_log = rasterslam(command);
  EXPECT_EQ(other_log.exit_code, 3);
  EXPECT_THAT(other_log.err, HasSubstr("no stamp in common"));
  const auto two_truths = rasterslam(command + " --truth " + (folder / "path.tum"));
  EXPECT_EQ(two_truths.exit_code, 3);
  EXPECT_THAT(two_truths.err, HasSubstr("--relations"));
}

}  // namespace
}  // namespace slam::apps

// run --localise in a grid map: a robot that nobody says where it is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "libslam/files/files.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// 65 s in an office, its plan, and the plan of another building.
class InAPlan : public CommandsInAFolder {
 protected:
  static void SetUpTestSuite() {
    fill({"world make office -o plan.yaml --size 24x16 --seed 3", "world make flat -o other.yaml --seed 9",
          "simulate plan.yaml -o visit.rawlog --duration 65 --seed 5 -q"});
  }
};

TEST_F(InAPlan, ARobotIsFoundWithoutAStart) {
  const auto found = run("run graph visit.rawlog -o found --localise plan.yaml");
  ASSERT_EQ(found.exit_code, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr("% of the time\n"));
  const auto scored = run("eval found --truth visit.gt.tum");
  ASSERT_EQ(scored.exit_code, 0) << scored.err;
  EXPECT_THAT(scored.out, HasSubstr("not aligned (align none)"));
  const auto row =
      nlohmann::json::parse(run("eval found --truth visit.gt.tum --json").out)["scores"]["rows"][0];
  EXPECT_LT(row["ate_rmse_m"], 0.1);  // two cells of the plan
  EXPECT_LT(row["lost_share"], 1);
}

TEST_F(InAPlan, AnotherBuildingIsSaidAfterAMinute) {
  const auto lost = run("run graph visit.rawlog -o astray --localise other.yaml");
  EXPECT_EQ(lost.exit_code, 4);
  EXPECT_THAT(
      lost.err,
      HasSubstr(
          "other.yaml: the robot is not found in it after 60 s of the log: is it the map of another place?"));
  EXPECT_TRUE(fs::exists(*shared_folder / "astray/trajectory.tum"));
  EXPECT_THAT(lost.out, HasSubstr("lost 100.0 % of the time"));
}

TEST_F(InAPlan, AMapWithoutAFreePlaceIsRefused) {
  files::writeFileAtomically(*shared_folder / "full.pgm", "P2\n4 4\n255\n0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n");
  files::writeFileAtomically(*shared_folder / "full.yaml",
                             "image: full.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\n"
                             "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
  const auto refused = run("run graph visit.rawlog -o x --localise full.yaml -q");
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("full.yaml: the picture has no free space"));
  EXPECT_FALSE(fs::exists(*shared_folder / "x"));
}

TEST_F(InAPlan, MethodsThatCannotFindItSaySo) {
  const auto refused = run("run icp visit.rawlog -o x --localise plan.yaml -q");
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("has to be told where in the map the log begins (--start)"));
  EXPECT_FALSE(fs::exists(*shared_folder / "x"));
}

TEST_F(InAPlan, AFileThatIsNoMapIsNamed) {
  const auto refused = run("run graph visit.rawlog -o none --localise visit.rawlog -q");
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err,
              HasSubstr("visit.rawlog: found a file of another kind, expected the folder of a run"));
  EXPECT_FALSE(fs::exists(*shared_folder / "none"));
}

}  // namespace
}  // namespace slam::apps

// eval: a path by itself, other steps of the relative error, and a truth that is not its own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/apps/program.h"

namespace slam::apps {
namespace {
using ::testing::HasSubstr;
using ::testing::Not;

TEST(EvalPath, NeedsNoRunFolderAndNoticesTheTruthOfAnotherRun) {
  const testing::TempFolder folder;
  const auto run = [&](const std::string& arguments) { return rasterslam(arguments, folder.path()); };
  for (const std::string seed : {"3", "4"})
    ASSERT_EQ(
        run("simulate flat -o s" + seed + ".rawlog --duration 40 -q --set lidar.beams=91 --seed " + seed)
            .exit_code,
        0);
  ASSERT_EQ(run("run naive_wheel s3.rawlog -o out -q").exit_code, 0);

  const auto scored = run("eval out/trajectory.tum --truth s3.gt.tum --rpe 2m,5s --json");
  ASSERT_EQ(scored.exit_code, 0) << scored.err;
  EXPECT_THAT(scored.err, Not(HasSubstr("warning")));
  const auto json = nlohmann::json::parse(scored.out);
  EXPECT_LT(json["scores"]["rows"][0]["ate_rmse_m"].get<double>(), 0.5);  // wheels over 40 s
  ASSERT_EQ(json["rpe"]["rows"].size(), 2U);
  EXPECT_EQ(json["rpe"]["rows"][0]["over"], "2 m");
  // The same as of the folder.
  const auto whole = nlohmann::json::parse(run("eval out --truth s3.gt.tum --rpe 2m,5s --json").out);
  EXPECT_EQ(whole["rpe"], json["rpe"]);
  EXPECT_EQ(whole["scores"]["rows"][0]["ate_rmse_m"], json["scores"]["rows"][0]["ate_rmse_m"]);

  for (const std::string what : {"out", "out/trajectory.tum"})
    EXPECT_THAT(run("eval " + what + " --truth s4.gt.tum").err,
                HasSubstr("rasterslam: warning: s4.gt.tum: is it of another run?"));
}

TEST(EvalPath, RefusesWhatAPathCannotHave) {
  const testing::TempFolder folder;
  const auto errorOf = [&](const std::string& arguments) {
    const auto result = rasterslam("eval " + arguments, folder.path());
    EXPECT_EQ(result.exit_code, 3) << arguments;
    return result.err;
  };
  ASSERT_EQ(rasterslam("simulate flat -o a.rawlog --duration 3 -q", folder.path()).exit_code, 0);
  EXPECT_THAT(errorOf("a.gt.tum"),
              HasSubstr("is a file, expected a run's folder, or --truth or --relations"));
  EXPECT_THAT(errorOf("a.gt.tum --truth a.gt.tum --plan flat"), HasSubstr("--plan scores a map"));
  EXPECT_THAT(errorOf("a.gt.tum --truth a.gt.tum --gate g.json"),
              HasSubstr("--gate and --write-gate hold runs"));
  EXPECT_THAT(errorOf("a.gt.tum --truth a.gt.tum --rpe 3km"),
              HasSubstr("--rpe: found '3km', expected metres"));
}

}  // namespace
}  // namespace slam::apps

// run, plot journal and plugin: what the program says around methods.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "libslam/files/files.h"
#include "libslam/resources/file_hash.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// 20 s in the corridor, whose middle leaves a direction open.
class AroundMethods : public CommandsInAFolder {
 protected:
  static void SetUpTestSuite() {
    fill({"simulate corridor -o run.rawlog --duration 20 --set lidar.max_range_m=5 -q"});
  }
  static void write(const std::string& name, const std::string& text) {
    files::writeFileAtomically(*shared_folder / name, text);
  }
};

TEST_F(AroundMethods, TheJournalIsPrintedAndDrawn) {
  const auto printed = run("run graph run.rawlog -o graph --journal");
  ASSERT_EQ(printed.exit_code, 0) << printed.err;
  EXPECT_THAT(printed.out, StartsWith("   scan    time s  event"));
  EXPECT_THAT(printed.out, HasSubstr("degenerate"));
  const auto drawn = run("plot journal graph --json");
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_GT(nlohmann::json::parse(drawn.out)["events"], 0);
  EXPECT_FALSE(cv::imread(*shared_folder / "journal.png").empty());
  const auto json =
      nlohmann::json::parse(run("run graph run.rawlog -o graph --overwrite --journal --json -q").out);
  EXPECT_EQ(json["journal"][0]["place_m"].size(), 2U);
}

TEST_F(AroundMethods, AJournalWithNothingToTellIsOneToo) {
  ASSERT_EQ(run("simulate flat -o still.rawlog --duration 1 -q").exit_code, 0);
  const auto printed = run("run graph still.rawlog -o still --journal");
  EXPECT_EQ(printed.exit_code, 0) << printed.err;
  EXPECT_THAT(printed.out, StartsWith("method graph has nothing to tell\n"));
  const auto drawn = run("plot journal still -o still.png");
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_TRUE(fs::exists(*shared_folder / "still.png"));
}

TEST_F(AroundMethods, AMethodWithoutAJournalSaysSo) {
  const auto printed = run("run naive_wheel run.rawlog -o naive --journal");
  EXPECT_EQ(printed.exit_code, 0);
  EXPECT_THAT(printed.out, StartsWith("method naive_wheel wrote no journal\n"));
  const auto drawn = run("plot journal naive -o x.png");
  EXPECT_EQ(drawn.exit_code, 3);
  EXPECT_EQ(drawn.err, "rasterslam: naive: holds no journal.csv: method naive_wheel wrote no journal\n");
  EXPECT_FALSE(fs::exists(*shared_folder / "x.png"));
}

TEST_F(AroundMethods, ARunGoesOnOrOnlyLocalises) {
  ASSERT_EQ(run("run graph run.rawlog -o first -q").exit_code, 0);
  EXPECT_EQ(run("run graph run.rawlog -o second --continue first --start 0,0,0 -q").exit_code, 0);
  EXPECT_EQ(run("run graph run.rawlog -o third --localise first --start 0,0,0 -q").exit_code, 0);
  EXPECT_EQ(resources::fileSha256(*shared_folder / "first/map.simplemap"),
            resources::fileSha256(*shared_folder / "third/map.simplemap"));
  const auto alone = run("run graph run.rawlog -o x --start 0,0,0 -q");
  EXPECT_EQ(alone.exit_code, 3);
  EXPECT_THAT(alone.err, HasSubstr("--start belongs to --continue or --localise"));
  EXPECT_EQ(run("run graph run.rawlog -o x --continue first --localise first -q").exit_code, 2);
  EXPECT_EQ(run("run graph run.rawlog -o x --continue first --start 0,0 -q").exit_code, 3);
  EXPECT_EQ(run("run rbpf run.rawlog -o x --continue first -q").exit_code, 3);
}

TEST_F(AroundMethods, APluginIsCheckedAndCompared) {
  write("wheels.sh", "awk '{ print $1, $2, $3, 0, 0, 0, sin($4 / 2), cos($4 / 2) }' \"$1\" > \"$2\"\n");
  write("wheels.ini", "[method]\ntype = external\ncommand = sh {here}/wheels.sh {scans} {output}\n");
  const auto good = run("plugin check wheels.ini run.rawlog");
  EXPECT_EQ(good.exit_code, 0) << good.err;
  EXPECT_THAT(good.out, EndsWith("wheels keeps the contract: 101 of 101 scans have a pose\n"));

  write("bad.ini", "[method]\ntype = external\ncommand = echo 1 0 0 0 0 0 0 1 > {output}\n");
  const auto bad = run("plugin check bad.ini run.rawlog");
  EXPECT_EQ(bad.exit_code, 4);
  EXPECT_THAT(bad.out,
              StartsWith("violation: {output}:1: found the stamp 1.000000, which is no scan's of the log"));
  EXPECT_FALSE(
      nlohmann::json::parse(run("plugin check bad.ini run.rawlog -q --json").out)["violations"].empty());

  const auto compared = run("compare run.rawlog --methods wheels.ini,naive_wheel,bad.ini -o out");
  EXPECT_EQ(compared.exit_code, 4);
  EXPECT_THAT(compared.out, HasSubstr("bad failed: method bad: {output}:1: found the stamp"));
  EXPECT_THAT(files::readTextFile(*shared_folder / "out/scores.csv"), HasSubstr("\nwheels,"));

  const auto ours = run("plugin check ../none.ini run.rawlog -q");
  EXPECT_EQ(ours.exit_code, 3);
  write("own.ini", "[method]\ntype = graph\n");
  EXPECT_THAT(run("plugin check own.ini run.rawlog -q").err, HasSubstr("key 'type': expected external"));
}

TEST_F(AroundMethods, AMethodsFileMayNameTheMethodThatItChanges) {
  write("near.ini", "[method]\nbase = graph\n[graph]\nmax_range_m = 4\n");
  const auto ran = run("run near.ini run.rawlog -o near --json -q");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const auto manifest = nlohmann::json::parse(files::readTextFile(*shared_folder / "near/manifest.json"));
  EXPECT_EQ(manifest["config"]["graph.max_range_m"], "4");
  EXPECT_EQ(manifest["config"]["method.type"], "graph");
  write("nothing.ini", "[method]\nbase = grap\n");
  const auto unknown = run("run nothing.ini run.rawlog -o nothing");
  EXPECT_EQ(unknown.exit_code, 3);
  EXPECT_THAT(unknown.err,
              HasSubstr("nothing.ini:2: key 'base': unknown method 'grap'; did you mean 'graph'?"));
  write("ring.ini", "[method]\nbase = ring.ini\n");
  EXPECT_THAT(run("run ring.ini " + (*shared_folder / "run.rawlog")).err, HasSubstr("expected an end"));
}

TEST_F(AroundMethods, AComparisonSetsValuesOfTheMethodsThatHaveThem) {
  const auto ran =
      run("compare run.rawlog -o set --methods naive_wheel,graph --set graph.max_range_m=4 --json -q");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const auto manifest =
      nlohmann::json::parse(files::readTextFile(*shared_folder / "set/graph/manifest.json"));
  EXPECT_EQ(manifest["config"]["graph.max_range_m"], "4");
  const auto nobody = run("compare run.rawlog -o nobody --methods naive_wheel --set graph.max_range_m=4");
  EXPECT_EQ(nobody.exit_code, 3);
  EXPECT_THAT(nobody.err,
              HasSubstr("--set: found 'graph.max_range_m=4', expected a section of a method that is"));
  EXPECT_FALSE(fs::exists(*shared_folder / "nobody"));
  EXPECT_THAT(run("compare run.rawlog -o no --set lidar.beams=91").err, HasSubstr("run.rawlog is a log"));
  EXPECT_THAT(run("compare run.rawlog -o no --methods graph --set graph.max_rang_m=4").err,
              HasSubstr("did you mean 'max_range_m'?"));
}

TEST_F(AroundMethods, AReportIsOneHtmlPage) {
  ASSERT_EQ(run("run naive_wheel run.rawlog -o wheel -q").exit_code, 0);
  const auto refused = run("report wheel -o report.pdf");
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("found 'report.pdf', expected a name that ends with .html"));
}

TEST_F(AroundMethods, TheContractIsInTheHelp) {
  const auto help = run("plugin --help");
  for (const std::string word :
       {"{log}", "{output}", "{scans}", "{workdir}", "{seed}", "{here}", "graphslam-engine"})
    EXPECT_THAT(help.out, HasSubstr(word));
  for (size_t begin = 0, end = 0; (end = help.out.find('\n', begin)) != std::string::npos; begin = end + 1)
    EXPECT_LE(end - begin, 100U) << help.out.substr(begin, end - begin);
}

}  // namespace
}  // namespace slam::apps

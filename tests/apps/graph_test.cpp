#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
using nlohmann::json;
using ::testing::HasSubstr;

/// Once round a square of 4 x 5 steps of a metre, with odometry that turns a degree too far at each corner,
/// and a loop that says the truth. `wrong`: also one that does not.
void writeSquare(const std::string& path, bool wrong) {
  std::ostringstream text;
  double x = 0, y = 0, phi = 0;
  for (int i = 0; i <= 20; ++i) {
    text << "VERTEX_SE2 " << i << " " << x << " " << y << " " << phi << "\n";
    const double turn = i % 5 == 4 ? M_PI / 2 + M_PI / 180 : 0;
    if (i < 20) text << "EDGE_SE2 " << i << " " << i + 1 << " 1 0 " << turn << " 100 0 0 100 0 1000\n";
    x += std::cos(phi), y += std::sin(phi), phi += turn;
  }
  text << "EDGE_SE2 0 20 0 0 0 10000 0 0 10000 0 10000\n";
  if (wrong) text << "EDGE_SE2 0 10 0 0 0 10000 0 0 10000 0 10000\nEDGE_XY 1 2\n";
  std::ofstream(path) << text.str();
}

TEST(GraphCommand, SaysWhatAFileHolds) {
  const testing::TempFolder folder;
  writeSquare(folder / "a.g2o", true);
  const auto plain = rasterslam("graph info a.g2o", folder.path());
  EXPECT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_THAT(plain.out,
              HasSubstr("a.g2o: 21 nodes along 20.0 m, 1 fixed\n20 edges of odometry, 2 loops, 0 priors"));
  EXPECT_THAT(plain.out, HasSubstr("passed over: 1 lines EDGE_XY"));
  const auto facts = json::parse(rasterslam("graph info a.g2o --json", folder.path()).out);
  EXPECT_EQ(facts["nodes"], 21);
  EXPECT_EQ(facts["loop_edges"], 2);
  EXPECT_GT(facts["chi2"], 1000);
}

TEST(GraphCommand, SolvesAndWritesAFileThatItReadsAgain) {
  const testing::TempFolder folder;
  writeSquare(folder / "a.g2o", false);
  const auto solved = json::parse(rasterslam("graph optimise a.g2o -o b.g2o --json -q", folder.path()).out);
  EXPECT_EQ(solved["converged"], true);
  EXPECT_LT(solved["chi2"], solved["chi2_before"].get<double>() / 10);
  const auto read = json::parse(rasterslam("graph info b.g2o --json", folder.path()).out);
  EXPECT_DOUBLE_EQ(read["chi2"], solved["chi2"]);
  EXPECT_EQ(rasterslam("graph optimize a.g2o -o b.g2o", folder.path()).exit_code, 3) << "it is there already";
}

TEST(GraphCommand, ReadsWhatTheGraphMethodLeaves) {
  const testing::TempFolder folder;
  for (const char* command :
       {"simulate flat -o run.rawlog --seed 7 --duration 20", "run graph run.rawlog -o map",
        "run graph run.rawlog -o edges --set graph.refine_rounds=0"})
    ASSERT_EQ(rasterslam(command, folder.path()).exit_code, 0) << command;
  const auto facts = json::parse(rasterslam("graph info map/graph.g2o --json", folder.path()).out);
  EXPECT_GT(facts["nodes"], 5);
  EXPECT_GE(facts["odometry_edges"], facts["nodes"].get<int>() - 1);
  EXPECT_EQ(facts["fixed"], 1);
  // The method has optimised it already; bundle adjustment asks the scans then, and not the edges.
  const auto solvedOf = [&](const std::string& file) {
    return json::parse(
        rasterslam("graph optimise " + file + " -o " + file + ".b.g2o --json", folder.path()).out);
  };
  const auto of_edges = solvedOf("edges/graph.g2o"), of_scans = solvedOf("map/graph.g2o");
  EXPECT_NEAR(of_edges["chi2"], of_edges["chi2_before"], 0.1 * of_edges["chi2"].get<double>());
  EXPECT_LT(of_scans["chi2"], of_scans["chi2_before"]);
  EXPECT_NEAR(of_scans["chi2"], of_edges["chi2"], 0.1 * of_edges["chi2"].get<double>()) << "the same edges";
  if (!testing::programExists("graph-slam")) GTEST_SKIP() << "MRPT's graph-slam is not here";
  const auto read = testing::runCommand("graph-slam --2d --info -i '" + folder / "map/graph.g2o" + "'");
  EXPECT_EQ(read.exit_code, 0) << read.err;
  EXPECT_THAT(read.out, HasSubstr("entries) : " + std::to_string(facts["nodes"].get<int>()))) << read.out;
}

TEST(GraphCommand, SwitchesAWrongLoopOffWhenAsked) {
  const testing::TempFolder folder;
  writeSquare(folder / "a.g2o", true);
  const auto all =
      json::parse(rasterslam("graph optimise a.g2o --robust none -o all.g2o --json", folder.path()).out);
  EXPECT_EQ(all["switched_off"].size(), 0U);
  const auto some =
      json::parse(rasterslam("graph optimise a.g2o --robust global -o some.g2o --json", folder.path()).out);
  EXPECT_EQ(some["switched_off"], json::parse("[[0, 10]]"));
  EXPECT_LT(some["chi2"], all["chi2"].get<double>() / 10);
  const auto text = rasterslam("graph optimise a.g2o --robust global -o some.g2o --overwrite", folder.path());
  EXPECT_THAT(text.out, HasSubstr("1 loops switched off\n  off: 0 - 10\nglobally optimal: no poses have a "
                                  "lower chi2 with these loops\n  some.g2o\n"));
  EXPECT_EQ(files::readTextFile(folder / "some.g2o").find("EDGE_SE2 0 10 "), std::string::npos);
}

TEST(GraphCommand, FindsTheSameOptimumFromAnywhereAndProvesIt) {
  const testing::TempFolder folder;
  writeSquare(folder / "a.g2o", false);
  double chi2 = 0;
  for (const char* from : {"file", "odometry", "random", "relaxation"}) {
    const auto solved = json::parse(
        rasterslam("graph optimise a.g2o -o b.g2o --overwrite --seed 3 --json --from " + std::string(from),
                   folder.path())
            .out);
    EXPECT_EQ(solved["converged"], true) << from;
    EXPECT_EQ(solved["globally_optimal"], true) << from;
    EXPECT_NEAR(solved["chi2_lower_bound"], solved["chi2"], 1e-5) << from;
    if (chi2 == 0) chi2 = solved["chi2"];
    EXPECT_NEAR(solved["chi2"], chi2, 1e-6 * chi2) << from;
  }
  const auto text = rasterslam("graph optimise a.g2o -o b.g2o --overwrite", folder.path());
  EXPECT_THAT(text.out, HasSubstr("globally optimal: no poses have a lower chi2\n"));
  const auto local =
      json::parse(rasterslam("graph optimise a.g2o -o b.g2o --overwrite --local --json", folder.path()).out);
  EXPECT_FALSE(local.contains("globally_optimal")) << "nobody asked";
}

TEST(GraphCommand, UnwindsARingThatALocalSearchLeavesWoundUp) {
  // Eight poses that look the same way by their edges, wound up once: no small step is any better.
  const testing::TempFolder folder;
  {
    std::ofstream text(folder / "ring.g2o");
    for (int i = 0; i < 8; ++i) text << "VERTEX_SE2 " << i << " 0 0 " << i * M_PI / 4 << "\n";
    for (int i = 0; i < 8; ++i) text << "EDGE_SE2 " << i << " " << (i + 1) % 8 << " 0 0 0 1 0 0 1 0 1\n";
  }
  const auto local =
      json::parse(rasterslam("graph optimise ring.g2o -o b.g2o --local --json", folder.path()).out);
  EXPECT_NEAR(local["chi2"], M_PI * M_PI / 2, 1e-6);
  const auto best =
      json::parse(rasterslam("graph optimise ring.g2o -o b.g2o --overwrite --json", folder.path()).out);
  EXPECT_NEAR(best["chi2"], 0, 1e-9);
  EXPECT_EQ(best["from"], "relaxation");
  EXPECT_EQ(best["globally_optimal"], true);
}

TEST(GraphCommand, ConvertsToMrptsGraphsAndBack) {
  const testing::TempFolder folder;
  writeSquare(folder / "a.g2o", true);
  const auto facts = json::parse(rasterslam("graph convert a.g2o -o a.graph --json", folder.path()).out);
  EXPECT_EQ(facts["nodes"], 21);
  const auto back = rasterslam("graph convert a.graph -o b.g2o", folder.path());
  EXPECT_THAT(back.out, HasSubstr("21 nodes along 20.0 m, 1 fixed")) << back.err;
  EXPECT_THAT(back.out, ::testing::EndsWith("  b.g2o\n"));
  EXPECT_EQ(json::parse(rasterslam("graph info b.g2o --json", folder.path()).out)["chi2"], facts["chi2"]);
  EXPECT_EQ(rasterslam("graph optimise a.graph --robust global -o solved.graph", folder.path()).exit_code, 0);
  EXPECT_THAT(rasterslam("graph info solved.graph", folder.path()).out, HasSubstr("1 loops"));
  for (const auto& [command, said] : std::vector<std::pair<std::string, std::string>>{
           {"graph convert a.g2o -o a.toro",
            "--output: found 'a.toro', expected a name that ends in .g2o or .graph"},
           {"graph convert a.g2o", "graph convert: found no --output"},
           {"graph convert none.g2o -o c.graph", "none.g2o"},
           {"graph convert a.g2o -o a.graph", "a.graph"}}) {
    const auto refused = rasterslam(command, folder.path());
    EXPECT_EQ(refused.exit_code, 3) << command;
    EXPECT_THAT(refused.err, HasSubstr(said));
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
  }
}

TEST(GraphCommand, SaysWhatItCannotUnderstand) {
  const testing::TempFolder folder;
  writeSquare(folder / "a.g2o", false);
  std::ofstream(folder / "parts.g2o") << "VERTEX_SE2 9 0 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n";
  std::ofstream(folder / "none.g2o") << "EDGE_SE2 0 1 1 0 0 0 0 0 0 0 0\n";
  std::ofstream(folder / "minus.g2o") << "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 -1\n";
  std::ofstream(folder / "bad.g2o") << "VERTEX_SE2 0 0 zero 0\n";
  for (const auto& [arguments, words] : std::vector<std::pair<std::string, std::string>>{
           {"graph info nothing.g2o", "nothing.g2o"},
           {"graph info bad.g2o", "bad.g2o:1"},
           {"graph info none.g2o", "none.g2o:1: found an information matrix that is zero"},
           {"graph info minus.g2o", "minus.g2o:1: found an information matrix that is indefinite"},
           {"graph optimise parts.g2o -o b.g2o",
            "parts.g2o: found 2 parts that no edge ties together: 0 to 1 (2 vertices), 9 (1 vertex)"},
           {"graph optimise a.g2o", "found no --output"},
           {"graph optimise a.g2o --robust often -o b.g2o", "expected one of none, local, global"},
           {"graph optimise a.g2o --set posegraph.tolerence=1 -o b.g2o", "did you mean 'tolerance'?"}}) {
    const auto result = rasterslam(arguments, folder.path());
    EXPECT_EQ(result.exit_code, 3) << arguments;
    EXPECT_THAT(result.err, HasSubstr(words)) << arguments;
  }
  EXPECT_THROW(files::requireReadableFile(folder / "b.g2o"), core::InputError);
}

}  // namespace
}  // namespace slam::apps

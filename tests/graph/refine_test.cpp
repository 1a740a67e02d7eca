// All scans fitted together in the end: SurfaceBundle, and what goes with the keyframes that it moves.
#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"
#include "libslam/graph/graph_slam.h"
#include "tests/graph/drawn_drives.h"

namespace slam::graph {
namespace {

using namespace test_drives;

struct Refined {
  std::vector<core::Pose2> path;
  std::vector<char> is_keyframe;
  std::vector<core::JournalEntry> journal;
};

Refined mapped(const Drive& log, int rounds, keyframes::GraphOptions options = {}) {
  options.refine_rounds = rounds;
  GraphSlam graph(options);
  Refined result;
  for (size_t i = 0; i < log.scans.size(); ++i)
    result.is_keyframe.push_back(graph.process(log.scans[i], log.increments[i], true).is_keyframe);
  graph.finish();
  result.path = graph.poses(), result.journal = graph.journal();
  return result;
}

/// Along a corridor of 60 m with pillars that tell where along it one is, by a lidar that sees 8 m.
Drive alongACorridor(std::uint64_t seed) {
  auto walls = rectangle(0, 0, 60, 3);
  for (int i = 0; i < 24; ++i) {
    const double x = 1 + 2.4 * i, y = i % 2 == 0 ? 0 : 2.7;
    add(walls, rectangle(x, y, x + 0.3, y + 0.3));
  }
  Lidar lidar;
  lidar.beams = 360, lidar.fov_rad = 2 * core::kPi, lidar.noise_m = 0.03, lidar.max_range_m = 8;
  return drive(walls, along({{2, 1.5}, {58, 1.5}}, 0.1), lidar, 0, seed);
}

/// Root mean square of errors (m), of scans that became keyframes or of the others, over five drives.
double errorOf(int rounds, bool of_keyframes) {
  double squares = 0, count = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Drive log = alongACorridor(seed);
    const Refined run = mapped(log, rounds);
    for (size_t i = 0; i < log.scans.size(); ++i) {
      if (static_cast<bool>(run.is_keyframe[i]) != of_keyframes) continue;
      const double error_m = core::distance(run.path[i], log.truth[i]);
      squares += error_m * error_m, count += 1;
    }
  }
  return std::sqrt(squares / count);
}

TEST(Refining, AveragesTheNoiseOfMatches) {
  EXPECT_LT(errorOf(3, true), 0.6 * errorOf(0, true));
}

TEST(Refining, TakesOtherScansAlong) {
  EXPECT_LT(errorOf(3, false), 0.6 * errorOf(0, false));
}

/// Root mean square of what headings of scans so far apart err by against each other (rad), of those that are
/// no keyframes.
double headingNoise(const Refined& run, const Drive& log, size_t lag) {
  double squares = 0, count = 0;
  for (size_t i = lag; i < run.path.size(); ++i) {
    if (run.is_keyframe[i] || run.is_keyframe[i - lag]) continue;
    const double error = core::angleDifference(core::between(run.path[i - lag], run.path[i]).phi,
                                               core::between(log.truth[i - lag], log.truth[i]).phi);
    squares += error * error, count += 1;
  }
  return std::sqrt(squares / count);
}

// They were matched to the map, and not to the keyframe, whose own noise is none of theirs.
TEST(Refining, AddsNoNoiseToOtherScans) {
  Lidar lidar;
  lidar.beams = 360, lidar.fov_rad = 2 * core::kPi, lidar.noise_m = 0.03;
  const Drive log = drive(yard(), along({{3, 5}, {11, 5}, {11, 7}, {3, 7}, {3, 5}}, 0.1), lidar, 0);
  EXPECT_LT(headingNoise(mapped(log, 3), log, 13), 1.1 * headingNoise(mapped(log, 0), log, 13));
}

TEST(Refining, StopsWhenNothingMovesAnyMore) {
  const Refined run = mapped(drive(yard(), along({{3, 5}, {11, 5}, {11, 7}}, 0.1), {}, 0), 50);
  const auto rounds = std::count_if(run.journal.begin(), run.journal.end(),
                                    [](const auto& entry) { return entry.detail == "refinement"; });
  EXPECT_GE(rounds, 1);
  EXPECT_LT(rounds, 20);
}

/// Ends the work when a stage has told of itself so often.
struct Ended : core::Progress {
  int left;
  bool is_fitting = false;
  explicit Ended(int updates) : left(updates) {}
  void begin(const std::string& stage) override { is_fitting = stage == "fitting all scans"; }
  void update(double /*fraction*/, double /*log_time_s*/) override {
    if (is_fitting && left-- == 0) throw core::Interrupted();
  }
};

TEST(Refining, CanBeInterruptedWithinARound) {
  const Drive log = alongACorridor(1);
  const Refined without = mapped(log, 0);
  for (const int updates : {1, 2, 5}) {
    GraphSlam graph{keyframes::GraphOptions{}};
    for (size_t i = 0; i < log.scans.size(); ++i) graph.process(log.scans[i], log.increments[i], true);
    Ended progress(updates);
    EXPECT_THROW(graph.finish(progress), core::Interrupted) << updates;
    EXPECT_EQ(graph.poses(), without.path) << "in the first round, which has not moved anything yet";
  }
}

TEST(Refining, LeavesTheFirstPoseAndWhatWasGivenOnline) {
  const Drive log = alongACorridor(1);
  const Refined run = mapped(log, 2);
  EXPECT_EQ(run.path.size(), log.scans.size());
  EXPECT_LT(core::distance(run.path[0], core::Pose2{}), 1e-12);
}

}  // namespace
}  // namespace slam::graph

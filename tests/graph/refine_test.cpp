// All scans fitted together in the end: SurfaceBundle, and what goes with the keyframes that it moves.
#include <gtest/gtest.h>

#include <cmath>

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

// They were matched to the map, and not to the keyframe, whose own noise is none of theirs.
TEST(Refining, TakesOtherScansAlong) {
  EXPECT_LT(errorOf(3, false), 0.6 * errorOf(0, false));
}

// Two passes between which no loop was closed err by what they err by; they may be two floors.
TEST(Refining, DoesNotTieWhatIsNotLinked) {
  Lidar lidar;
  lidar.max_range_m = 3, lidar.noise_m = 0.03;
  const Drive log = drive(ring(), lapsAround(2), lidar, 4e-3);
  keyframes::GraphOptions options;
  options.loops = false, options.map_path_m = 10;
  const Refined before = mapped(log, 0, options), after = mapped(log, 1, options);
  const size_t lap = log.scans.size() / 2;
  const auto apart_m = [&](const Refined& run) {
    double sum_m = 0;
    for (size_t i = 0; i < lap; ++i) sum_m += core::distance(run.path[i], run.path[i + lap]);
    return sum_m / static_cast<double>(lap);
  };
  ASSERT_GT(apart_m(before), 0.1) << "nothing to tie";
  EXPECT_GT(apart_m(after), 0.5 * apart_m(before));
}

TEST(Refining, StopsWhenNothingMovesAnyMore) {
  const Refined run = mapped(drive(yard(), along({{3, 5}, {11, 5}, {11, 7}}, 0.1), {}, 0), 50);
  const auto rounds = std::count_if(run.journal.begin(), run.journal.end(),
                                    [](const auto& entry) { return entry.detail == "refinement"; });
  EXPECT_GE(rounds, 1);
  EXPECT_LT(rounds, 20);
}

TEST(Refining, LeavesTheFirstPoseAndWhatWasGivenOnline) {
  const Drive log = alongACorridor(1);
  const Refined run = mapped(log, 2);
  EXPECT_EQ(run.path.size(), log.scans.size());
  EXPECT_LT(core::distance(run.path[0], core::Pose2{}), 1e-12);
}

}  // namespace
}  // namespace slam::graph

// A loop's poses are found while the robot drives on: a piece of the work with every scan.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/graph/graph_slam.h"
#include "tests/graph/drawn_drives.h"

namespace slam::graph {
namespace {

using namespace test_drives;

/// Two laps, a keyframe every step or two.
struct Laps {
  Drive log = drive(ring(), lapsAround(2), {}, 2e-3);
  GraphSlam graph{options()};

  static keyframes::GraphOptions options() {
    keyframes::GraphOptions o;
    o.keyframe_distance_m = 0.1, o.known_views = 0, o.loop_work = 1;
    return o;
  }
  void process(size_t i) { graph.process(log.scans[i], log.increments[i], true); }
  bool hasNoted(core::JournalEvent event, size_t from) const {
    const auto& journal = graph.journal();
    return std::any_of(journal.begin() + static_cast<long>(from), journal.end(),
                       [event](const core::JournalEntry& entry) { return entry.event == event; });
  }
  /// Drives on until the event is noted; the scans that it took, -1: it never came.
  int driveUntil(core::JournalEvent event, size_t& i) {
    const size_t noted = graph.journal().size();
    for (int scans = 1; i < log.scans.size(); ++scans) {
      process(i++);
      if (hasNoted(event, noted)) return scans;
    }
    return -1;
  }
};

double farthestMoved(const GraphSlam& graph, const std::vector<core::Pose2>& before) {
  double farthest = 0;
  for (size_t k = 0; k < before.size(); ++k)
    farthest = std::max(farthest, core::distance(before[k], graph.keyframePose(static_cast<int>(k))));
  return farthest;
}

TEST(Closing, MovesTheMapSomeScansAfterTheLoopWasAccepted) {
  Laps laps;
  size_t i = 0;
  ASSERT_GT(laps.driveUntil(core::JournalEvent::kAccepted, i), 0);
  const auto before = laps.graph.graph().poses();
  const int revision = laps.graph.revision();
  laps.process(i++);
  EXPECT_EQ(laps.graph.revision(), revision);
  EXPECT_EQ(farthestMoved(laps.graph, before), 0);
  EXPECT_GT(laps.driveUntil(core::JournalEvent::kOptimised, i), 0);
  EXPECT_GT(laps.graph.revision(), revision);
  EXPECT_GT(farthestMoved(laps.graph, before), 0.01);
}

TEST(Closing, KeyframesThatCameMeanwhileStayWhereTheyWereReachedFrom) {
  Laps laps;
  size_t i = 0;
  ASSERT_GT(laps.driveUntil(core::JournalEvent::kAccepted, i), 0);
  const int known = laps.graph.keyframeCount();
  for (int scans = 0; scans < 3; ++scans) laps.process(i++);
  const int newest = laps.graph.keyframeCount() - 1;
  ASSERT_GT(newest, known) << "two keyframes since";
  const auto pair = [&] {
    return core::between(laps.graph.keyframePose(known - 1), laps.graph.keyframePose(newest));
  };
  const core::Pose2 T_known_newest = pair(), T_map_newest = laps.graph.keyframePose(newest);
  ASSERT_GT(laps.driveUntil(core::JournalEvent::kOptimised, i), 0);
  EXPECT_LT(core::distance(pair(), T_known_newest), 1e-9);
  EXPECT_GT(core::distance(laps.graph.keyframePose(newest), T_map_newest), 0.002);
}

// Two laps by one thread, and by two.
TEST(Closing, ASecondThreadChangesNothing) {
  Laps one, two;
  two.graph.useThreads(2);
  for (size_t i = 0; i < one.log.scans.size(); ++i) {
    one.process(i), two.process(i);
    ASSERT_EQ(one.graph.revision(), two.graph.revision()) << i;
  }
  for (Laps* laps : {&one, &two}) laps->graph.finish();
  ASSERT_EQ(one.graph.journal().size(), two.graph.journal().size());
  for (size_t i = 0; i < one.graph.journal().size(); ++i)
    EXPECT_EQ(one.graph.journal()[i].value, two.graph.journal()[i].value) << i;
  EXPECT_TRUE(one.hasNoted(core::JournalEvent::kOptimised, 0));
  const auto poses = one.graph.poses(), others = two.graph.poses();
  for (size_t i = 0; i < poses.size(); ++i) EXPECT_TRUE(poses[i] == others[i]) << i;
  EXPECT_EQ(one.graph.covariances(), two.graph.covariances());
  EXPECT_EQ(one.graph.threadSeconds(), 0);
  EXPECT_GT(two.graph.threadSeconds(), 0);
}

struct Impatient : core::Progress {
  int most;  ///< updates
  std::vector<double> fractions = {};
  std::string stage = {};
  std::map<std::string, std::vector<double>> by_stage = {};
  explicit Impatient(int updates) : most(updates) {}
  void begin(const std::string& name) override { stage = name; }
  void update(double fraction, double /*log_time_s*/) override {
    fractions.push_back(fraction), by_stage[stage].push_back(fraction);
    if (static_cast<int>(fractions.size()) > most) throw core::Interrupted();
  }
};

TEST(Closing, LookingForWhatIsLeftTellsHowFarItIsAndCanBeInterrupted) {
  Laps laps;
  for (size_t i = 0; i < laps.log.scans.size(); ++i) laps.process(i);
  Impatient progress(2);
  EXPECT_THROW(laps.graph.finish(progress), core::Interrupted);
  EXPECT_LT(worstError(laps.graph.poses(), laps.log.truth), 0.15);
  Impatient patient(1000);
  laps.graph.finish(patient);
  ASSERT_EQ(patient.by_stage.size(), 2U) << "loops, and all scans together";
  for (const auto& [stage, fractions] : patient.by_stage) {
    ASSERT_GE(fractions.size(), 3U) << stage;
    EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end())) << stage;
    EXPECT_EQ(fractions.front(), 0) << stage;
    EXPECT_GT(fractions.back(), 0.6) << stage;
    EXPECT_LT(fractions.back(), 1) << stage;
  }
}

// A robot is switched off, or begins anew, at any moment.
TEST(Closing, IsGivenUpWithTheMap) {
  Laps laps;
  laps.graph.useThreads(2);
  size_t i = 0;
  ASSERT_GT(laps.driveUntil(core::JournalEvent::kAccepted, i), 0);
  laps.graph = GraphSlam(Laps::options());
  laps.process(0);
  EXPECT_EQ(laps.graph.keyframeCount(), 1);
}

// A log may end before all pieces are done.
TEST(Closing, IsCompletedWhenTheLogEnds) {
  Laps laps;
  size_t i = 0;
  ASSERT_GT(laps.driveUntil(core::JournalEvent::kAccepted, i), 0);
  const size_t noted = laps.graph.journal().size();
  laps.graph.finish();
  EXPECT_TRUE(laps.hasNoted(core::JournalEvent::kOptimised, noted));
  laps.log.truth.resize(i);
  EXPECT_LT(worstError(laps.graph.poses(), laps.log.truth), 0.15);
}

// There and back through a corridor no loop is needed to know where one is, and yet what the second pass
// measured of the first says where the way went wrong.
TEST(Closing, WhatWasMeasuredSinceTheLastLoopIsSpreadOverTheWayWhenTheLogEnds) {
  std::vector<core::Pose2> path;
  path.reserve(312);
  for (int i = 0; i < 140; ++i) path.push_back({3 + 0.1 * i, 1, 0});
  for (int i = 0; i < 32; ++i) path.push_back({17, 1, 0.1 * i});
  for (int i = 0; i < 140; ++i) path.push_back({17 - 0.1 * i, 1, core::kPi});
  const auto log = drive(ring(), path, {}, 1e-3);
  keyframes::GraphOptions options;
  options.loops = false, options.refine_rounds = 0;
  GraphSlam graph(options);
  for (size_t i = 0; i < log.scans.size(); ++i) graph.process(log.scans[i], log.increments[i], true);
  const auto online = graph.graph().poses();
  const double before = graph.graph().chi2();
  graph.finish();
  EXPECT_LT(graph.graph().chi2(), before - 0.1);
  EXPECT_GT(farthestMoved(graph, online), 1e-3);
  EXPECT_LT(worstError(graph.poses(), log.truth), 0.05);
  // There is nothing left to do then.
  const int revision = graph.revision();
  graph.finish();
  EXPECT_EQ(graph.revision(), revision);
}

}  // namespace
}  // namespace slam::graph

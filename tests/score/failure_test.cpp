#include "libslam/score/failure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace slam::score {
namespace {
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kStart_s = 1000;

/// One metre per second along x from (3, 1), a pose every 0.5 s for 40 s.
core::Trajectory straightTruth() {
  core::Trajectory truth;
  for (int i = 0; i <= 80; ++i) truth.push_back({kStart_s + 0.5 * i, {3 + 0.5 * i, 1, 0}});
  return truth;
}

/// The truth seen from its start, with what `error` adds to the pose at each second.
template <class Error>
core::Trajectory estimateWith(const Error& error) {
  core::Trajectory estimate;
  for (const auto& [time_s, pose] : straightTruth()) {
    const core::Pose2 off = error(time_s - kStart_s);
    estimate.push_back({time_s, {pose.x - 3 + off.x, pose.y - 1 + off.y, off.phi}});
  }
  return estimate;
}

core::JournalLine line(double time_s, const std::string& event) {
  core::JournalLine result;
  result.scan = static_cast<int>(time_s * 2);
  result.time_s = time_s;
  result.event = core::journalEventOf(event).value();
  return result;
}

TEST(Failure, ATruePathDivergesNowhere) {
  const auto estimate = estimateWith([](double) { return core::Pose2(); });
  EXPECT_FALSE(firstDivergence(straightTruth(), estimate));
  EXPECT_FALSE(firstDivergence({}, estimate));
  EXPECT_FALSE(firstDivergence(straightTruth(), {}));
}

TEST(Failure, AJumpIsFoundWhereItHappens) {
  const auto estimate = estimateWith([](double t) { return core::Pose2{0, t >= 20 ? 2.0 : 0, 0}; });
  const auto divergence = firstDivergence(straightTruth(), estimate);
  ASSERT_TRUE(divergence);
  EXPECT_EQ(divergence->kind, Divergence::kJump);
  EXPECT_DOUBLE_EQ(divergence->time_s, 20);
  EXPECT_DOUBLE_EQ(divergence->place.x, 23);
  EXPECT_DOUBLE_EQ(divergence->place.y, 1);
  EXPECT_DOUBLE_EQ(divergence->error_m, 2);
}

TEST(Failure, AJumpThatBuildsUpIsFoundWhereItGrowsMost) {
  // 0.2 m per second between 10 and 14 s, but 0.5 m at 12 s.
  const auto estimate = estimateWith([](double t) {
    return core::Pose2{0, 0.2 * std::clamp(t - 10, 0.0, 4.0) + (t >= 12 ? 0.5 : 0), 0};
  });
  const auto divergence = firstDivergence(straightTruth(), estimate);
  ASSERT_TRUE(divergence);
  EXPECT_DOUBLE_EQ(divergence->time_s, 12);
}

TEST(Failure, AWrongTurnIsAJumpThoughThePositionIsStillTrue) {
  const auto estimate = estimateWith([](double t) { return core::Pose2{0, 0, t >= 8 ? 0.5 : 0}; });
  const auto divergence = firstDivergence(straightTruth(), estimate);
  ASSERT_TRUE(divergence);
  EXPECT_EQ(divergence->kind, Divergence::kJump);
  EXPECT_DOUBLE_EQ(divergence->time_s, 8);
}

TEST(Failure, ATurnWeighsAsMuchAsTheJumpThatItIsHeldAgainst) {
  // 0.45 m at 12 s, nine tenths of a jump; then 0.27 rad at 14 s, more than one.
  const auto estimate = estimateWith([](double t) {
    return core::Pose2{0, t >= 12 ? 0.45 : 0, t >= 14 ? 0.27 : 0};
  });
  const auto divergence = firstDivergence(straightTruth(), estimate);
  ASSERT_TRUE(divergence);
  EXPECT_DOUBLE_EQ(divergence->time_s, 14);
}

TEST(Failure, SlowDriftIsNotAJump) {
  const auto estimate = estimateWith([](double t) { return core::Pose2{0, 0.05 * t, 0}; });
  const auto divergence = firstDivergence(straightTruth(), estimate);
  ASSERT_TRUE(divergence);
  EXPECT_EQ(divergence->kind, Divergence::kDrift);
  EXPECT_NEAR(divergence->time_s, 20.5, 0.51);  // 1 m is reached at 20 s
}

TEST(Failure, AnEstimateThatIsPutRightDoesNotDiverge) {
  // 0.9 m of slow drift, put right at once by a true loop.
  const auto estimate = estimateWith([](double t) { return core::Pose2{0, t < 30 ? 0.03 * t : 0, 0}; });
  EXPECT_FALSE(firstDivergence(straightTruth(), estimate));
}

TEST(Failure, ALoopBetweenPlacesFarApartIsWrong) {
  std::vector<double> stamps_s;
  for (const auto& pose : straightTruth()) stamps_s.push_back(pose.time_s);
  auto wrong = line(20, "accepted"), right = line(20, "accepted"), unused = line(20, "rejected");
  wrong.other_scan = unused.other_scan = 4;  // 18 m away in truth
  wrong.place = wrong.other_place = unused.place = unused.other_place = {1, 1};
  right.other_scan = 39;
  right.place = {20, 0}, right.other_place = {19.5, 0};
  auto beyond = wrong;
  beyond.other_scan = 500;
  auto across = wrong;  // as far apart in the map as in truth: its places saw each other
  across.place = {20, 0}, across.other_place = {2, 0};
  const auto loops = wrongLoops(straightTruth(), {right, wrong, unused, beyond, across}, stamps_s);
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_EQ(loops[0].scan, 40);
  EXPECT_EQ(loops[0].other_scan, 4);
  EXPECT_DOUBLE_EQ(loops[0].apart_m, 18);
  EXPECT_DOUBLE_EQ(loops[0].apart_in_map_m, 0);
}

TEST(Failure, TheGravestEventAroundIsTheSuspect) {
  results::RunFolder run;
  run.estimate = estimateWith([](double t) { return core::Pose2{0, t >= 20 ? 2.0 : 0, 0}; });
  Truth truth;
  truth.trajectory = straightTruth();
  std::vector<core::JournalLine> journal = {line(3, "lost"), line(18, "degenerate"), line(19, "degenerate"),
                                            line(20, "distrusted"), line(20, "searched")};
  auto report = explainFailure(run, truth, {journal, {}, {}, {}});
  EXPECT_EQ(report.suspect, "slip");
  EXPECT_THAT(report.around, ElementsAre("degenerate 2 times, 18.0 to 19.0 s", "distrusted, 20.0 s"));
  report = explainFailure(run, truth, {journal, {{kStart_s + 21, {}}}, {}, {}});
  EXPECT_EQ(report.suspect, "collision");
  auto loop = line(20.5, "accepted");
  loop.other_scan = 0, loop.other_place = loop.place;
  journal.push_back(loop);
  report = explainFailure(run, truth, {journal, {{kStart_s + 21, {}}}, {}, {}});
  EXPECT_EQ(report.suspect, "false loop closure");
  report = explainFailure(run, truth, {});
  EXPECT_EQ(report.suspect, "unknown");
  EXPECT_TRUE(report.around.empty());
  // Odometry that jumped 0.2 m at 19 s.
  const auto odometry = estimateWith([](double t) { return core::Pose2{t >= 19 ? 0.2 : 0, 0, 0}; });
  report = explainFailure(run, truth, {{}, {}, {}, odometry});
  EXPECT_EQ(report.suspect, "slip");
  EXPECT_THAT(report.around, ElementsAre("odometry wrong 2 times, 19.0 to 19.5 s"));
}

TEST(Failure, TheWorstRegionHoldsTheWallThatIsMissingAndTheOneThatIsFalse) {
  world::Plan plan;
  plan.columns = plan.rows = 100;
  plan.resolution_m = 0.11;
  plan.cells.assign(10000, world::Cell::kFree);
  const auto cell = [](int column, int row) { return static_cast<std::size_t>(row) * 100 + column; };
  for (int column = 10; column < 90; ++column) plan.cells[cell(column, 50)] = world::Cell::kOccupied;
  metrics::SeenMask seen{100, 100, std::vector<bool>(10000), std::vector<bool>(10000)};
  for (int column = 10; column < 90; ++column) seen.wall[cell(column, 50)] = true;
  auto map = plan;
  EXPECT_FALSE(worstRegion(plan, seen, map, {}));
  // Of the wall between 4.4 and 5.5 m ten cells are missing; three false ones stand beside.
  for (int column = 40; column < 50; ++column) map.cells[cell(column, 50)] = world::Cell::kFree;
  for (int column = 41; column < 44; ++column) map.cells[cell(column, 53)] = world::Cell::kOccupied;
  const auto region = worstRegion(plan, seen, map, {});
  ASSERT_TRUE(region);
  EXPECT_NEAR(region->centre.x, 5, 1e-9);
  EXPECT_NEAR(region->centre.y, 5, 1e-9);
  EXPECT_NEAR(region->missing_wall_m, 1.1, 1e-9);
  EXPECT_NEAR(region->false_wall_m, 0.33, 1e-9);
}

TEST(Failure, ACarryIsTheGravestSuspect) {
  results::RunFolder run;
  Truth truth;
  for (int i = 0; i <= 200; ++i) {
    const double time_s = 0.1 * i, x_m = 0.05 * i;
    run.estimate.push_back({time_s, {x_m, 0, 0}});
    truth.trajectory.push_back({time_s, {x_m + (i > 100 ? 6.0 : 0.0), 0, 0}});
  }
  FailureEvidence evidence;
  evidence.collisions = {{9.5, {}}};
  evidence.carries = {{10.05, {5, 0, 0}, {11, 0, 0}}};
  const auto report = explainFailure(run, truth, evidence);
  ASSERT_TRUE(report.divergence);
  EXPECT_EQ(report.suspect, "kidnapped");
  EXPECT_THAT(report.around, ::testing::Contains(HasSubstr("kidnapped, 10.1 s")));
}

}  // namespace
}  // namespace slam::score

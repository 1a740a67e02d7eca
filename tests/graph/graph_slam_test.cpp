#include "libslam/graph/graph_slam.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "libslam/core/error.h"
#include "libslam/scanmatch/information.h"
#include "tests/graph/drawn_drives.h"

namespace slam::graph {
namespace {

using namespace test_drives;

GraphSlam run(const Drive& log, bool with_odometry = true, const keyframes::GraphOptions& options = {}) {
  GraphSlam graph(options);
  for (size_t i = 0; i < log.scans.size(); ++i) graph.process(log.scans[i], log.increments[i], with_odometry);
  graph.finish();
  return graph;
}

std::set<std::string> eventsOf(const GraphSlam& graph) {
  std::set<std::string> events;
  for (const auto& entry : graph.journal()) events.insert(core::wordOf(entry.event));
  return events;
}

TEST(GraphSlam, ClosesALoopThatOdometryMissesByMetres) {
  const auto log = drive(ring(), lapsAround(2), {}, 2e-3);
  std::vector<core::Pose2> dead_reckoning(1);
  for (size_t i = 1; i < log.increments.size(); ++i)
    dead_reckoning.push_back(dead_reckoning.back() * log.increments[i]);
  ASSERT_GT(worstError(dead_reckoning, log.truth), 5);
  const auto graph = run(log);
  EXPECT_LT(worstError(graph.poses(), log.truth), 0.06);
  EXPECT_TRUE(eventsOf(graph).count("accepted"));
}

TEST(GraphSlam, NeedsNoOdometry) {
  const auto log = drive(ring(), lapsAround(1), {}, 0);
  EXPECT_LT(worstError(run(log, false).poses(), log.truth), 0.15);
}

TEST(GraphSlam, WorksWithANarrowAndWithAFullCircleLidarAndWithOneThatLooksBackwards) {
  Lidar narrow, full, backwards;
  narrow.fov_rad = core::kPi / 2, narrow.beams = 91;
  full.fov_rad = 2 * core::kPi * 359 / 360, full.beams = 360;
  backwards.T_robot_lidar = {-0.3, 0.1, core::kPi};
  for (const Lidar& lidar : {narrow, full, backwards}) {
    const auto log = drive(ring(), lapsAround(1), lidar, 1e-3);
    EXPECT_LT(worstError(run(log).poses(), log.truth), 0.15) << lidar.beams;
  }
}

TEST(GraphSlam, GivesTheSameBytesAgain) {
  const auto log = drive(ring(), lapsAround(1), {}, 2e-3);
  const auto a = run(log).poses(), b = run(log).poses();
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].x, b[i].x);
    ASSERT_EQ(a[i].y, b[i].y);
    ASSERT_EQ(a[i].phi, b[i].phi);
  }
}

// Intel's robot turns by 3.5 degrees on each metre that its wheels call straight: between two scans 4 m apart
// that is farther than a match finds. What scans nearer to each other showed of it holds there, too.
TEST(GraphSlam, LearnsHowWheelsTurnAndNeedsFewerScansThen) {
  const auto log = everyNth(drive(ring(), lapsAround(3), {}, -6e-3), 40, lapsAround(1).size());
  const auto graph = run(log);
  EXPECT_LT(worstError(graph.poses(), log.truth), 0.2);
  EXPECT_EQ(eventsOf(graph).count("rejected"), 0U);
}

// The counter of the wheels begins anew, far away, where no map contradicts it.
TEST(GraphSlam, OdometryThatLeapsIsNone) {
  auto log = everyNth(drive(ring(), lapsAround(2), {}, 0), 8);
  for (const size_t i : {20U, 45U}) log.increments[i] = {30, -20, 2};
  const auto graph = run(log);
  EXPECT_LT(worstError(graph.poses(), log.truth), 0.1);
  EXPECT_EQ(std::count_if(graph.journal().begin(), graph.journal().end(),
                          [](const auto& line) { return line.event == core::JournalEvent::kLeapt; }),
            2);
}

// Logs without odometry are often full of zeros.
TEST(GraphSlam, WheelsThatNeverTurnAreNoOdometry) {
  auto log = everyNth(drive(ring(), lapsAround(1), {}, 0), 4);
  for (core::Pose2& increment : log.increments) increment = {};
  const auto with_zeros = run(log), without = run(log, false);
  EXPECT_LT(worstError(with_zeros.poses(), log.truth), 0.15);
  EXPECT_EQ(worstError(with_zeros.poses(), without.poses()), 0);
  EXPECT_EQ(eventsOf(with_zeros).count("silent"), 1U);
}

TEST(GraphSlam, LetsGoOfOdometryThatJumpsAndSaysSo) {
  auto log = drive(ring(), lapsAround(1), {}, 0);
  log.increments[60] = {2, -1, 0.4};
  log.increments[150] = {-0.5, 0, -0.3};
  const auto graph = run(log);
  EXPECT_LT(worstError(graph.poses(), log.truth), 0.15);
  EXPECT_TRUE(eventsOf(graph).count("distrusted") || eventsOf(graph).count("rematched"));
}

TEST(GraphSlam, CarriesOnThroughScansWithoutAnyReturn) {
  auto log = drive(ring(), lapsAround(1), {}, 0);
  for (size_t i = 40; i < 46; ++i)
    for (float& range : log.scans[i].ranges_m) range = lidar::kNoReturn;
  const auto graph = run(log);
  EXPECT_LT(worstError(graph.poses(), log.truth), 0.5);
  EXPECT_TRUE(eventsOf(graph).count("poor"));
}

TEST(GraphSlam, SaysThatACorridorIsDegenerate) {
  std::vector<core::Pose2> path;
  path.reserve(60);
  for (int i = 0; i < 60; ++i) path.push_back({0.1 * i, 0, 0});
  const auto log = drive(rectangle(-100, -1, 100, 1), path, {}, 0);
  EXPECT_TRUE(eventsOf(run(log)).count("degenerate"));
}

TEST(GraphSlam, LocalisesInAFinishedMapWithoutChangingIt) {
  const auto first = drive(ring(), lapsAround(1), {}, 1e-3);
  auto graph = run(first);
  const int keyframes = graph.keyframeCount();
  const auto second = drive(ring(), lapsAround(1), {}, 1e-3, 2);
  graph.startAt(second.truth[0]);
  double worst = 0;
  for (size_t i = 0; i < second.scans.size(); ++i)
    worst = std::max(worst,
                     core::distance(graph.localise(second.scans[i], second.increments[i], true).T_map_robot,
                                    second.truth[i]));
  EXPECT_LT(worst, 0.15);
  EXPECT_EQ(graph.keyframeCount(), keyframes);
}

TEST(GraphSlam, LocalisedPosesErrByTheirMatchAndNotByTheMapsWay) {
  const auto log = drive(ring(), lapsAround(1), {}, 1e-3);
  auto graph = run(everyNth(log, 8));
  const size_t middle = log.scans.size() / 2;
  graph.startAt(log.truth[middle - 1]);
  for (size_t i = middle; i < middle + 40; ++i) {
    const auto errs = graph.localise(log.scans[i], log.increments[i], true).pose_covariance;
    EXPECT_LT(errs(0, 0) + errs(1, 1), 0.003) << i;
  }
}

TEST(GraphSlam, ContinuesAMapOfKnownKeyframes) {
  const auto log = drive(ring(), lapsAround(1), {}, 1e-3);
  const auto first = run(log);
  GraphSlam continued{keyframes::GraphOptions()};
  for (int k = 0; k < first.keyframeCount(); ++k)
    continued.addKnownKeyframe(first.keyframeScan(k), first.keyframePose(k));
  const auto more = drive(ring(), lapsAround(1), {}, 1e-3, 2);
  continued.startAt(more.truth[0]);
  for (size_t i = 0; i < more.scans.size(); ++i)
    continued.process(more.scans[i], i ? more.increments[i] : core::Pose2{}, true);
  EXPECT_LT(worstError(continued.poses(), more.truth), 0.15);
  EXPECT_GT(continued.keyframeCount(), first.keyframeCount());
}

// The way from the map's last keyframe to where the robot starts again was never measured.
TEST(GraphSlam, ContinuesAMapFromAnyPlaceInIt) {
  const auto log = drive(ring(), lapsAround(1), {}, 1e-3);
  const auto first = run(log);
  GraphSlam continued{keyframes::GraphOptions()};
  for (int k = 0; k < first.keyframeCount(); ++k)
    continued.addKnownKeyframe(first.keyframeScan(k), first.keyframePose(k));
  const size_t middle = log.scans.size() / 2;
  ASSERT_GT(core::distance(log.truth[middle], log.truth.back()), 8);
  continued.startAt(log.truth[middle]);
  for (size_t i = middle; i < middle + 60; ++i)
    continued.process(log.scans[i], i > middle ? log.increments[i] : core::Pose2{}, true);
  const auto& graph = continued.graph();
  ASSERT_GT(graph.nodeCount(), first.keyframeCount());
  for (int edge = 0; edge < static_cast<int>(graph.edges().size()); ++edge)
    EXPECT_LT(graph.chi2(edge), 20) << graph.edges()[static_cast<size_t>(edge)].from << " "
                                    << graph.edges()[static_cast<size_t>(edge)].to;
}

TEST(GraphSlam, IsUnsureWhereTheScanSaysNothing) {
  const auto log = drive(ring(), lapsAround(1), {}, 0);
  GraphSlam graph{keyframes::GraphOptions()};
  for (size_t i = 0; i < 20; ++i) graph.process(log.scans[i], log.increments[i], true);
  const auto seen = graph.process(log.scans[20], log.increments[20], true).drift_covariance;
  auto blind = log.scans[21];
  for (float& range : blind.ranges_m) range = lidar::kNoReturn;
  const auto unseen = graph.process(blind, log.increments[21], true).drift_covariance;
  EXPECT_GT(unseen(0, 0), 4 * seen(0, 0));
  EXPECT_LT(unseen(0, 0), 1);
}

std::vector<core::Pose2> straight(double from_m, double to_m) {
  std::vector<core::Pose2> path;
  const double heading = to_m > from_m ? 0 : core::kPi;
  for (int i = 0; i <= std::lround(std::abs(to_m - from_m) / 0.1); ++i)
    path.push_back({from_m + (to_m > from_m ? 0.1 : -0.1) * i, 0, heading});
  return path;
}

TEST(GraphSlam, FollowsOdometryAlongACorridorFromTheFirstScanOn) {
  // A robot that stands still explains the first scan best: where it has come from is all that is mapped.
  Lidar lidar;
  lidar.max_range_m = 8;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const auto log = drive(rectangle(-100, -1.2, 100, 1.2), straight(0, 3), lidar, 0, seed);
    GraphSlam graph{keyframes::GraphOptions()};
    for (size_t i = 0; i < log.scans.size(); ++i) {
      const auto step = graph.process(log.scans[i], log.increments[i], true);
      // Odometry's own noise over 3 m, and what walls of noisy points hold by chance.
      EXPECT_LT(core::distance(step.T_map_robot, log.truth[i]), 0.15) << seed << " " << i;
    }
  }
}

TEST(GraphSlam, ClosesNoLoopWhosePlaceIsNotDistinctEnough) {
  const auto log = drive(ring(), lapsAround(2), {}, 0.0006);
  const auto accepted = [&](double distinctness) {
    keyframes::GraphOptions options;
    options.loop_distinctness = distinctness;
    GraphSlam graph(options);
    for (size_t i = 0; i < log.scans.size(); ++i) graph.process(log.scans[i], log.increments[i], true);
    graph.finish();
    return std::count_if(graph.journal().begin(), graph.journal().end(), [](const core::JournalEntry& entry) {
      return entry.event == core::JournalEvent::kAccepted;
    });
  };
  EXPECT_GT(accepted(keyframes::GraphOptions().loop_distinctness), 0);
  EXPECT_EQ(accepted(100), 0);
}

TEST(GraphSlam, SaysThatItIsLostWhenItIsCarriedAwayAndJoinsWhatItMapsThenToTheRest) {
  auto log = drive(ring(), lapsAround(4), {}, 0);
  // Lifted in the second lap, in the middle of a corridor, and put down in the next corner, turned; odometry
  // saw nothing of it.
  const size_t lap = log.scans.size() / 4, lifted = lap + 90, put_down = lap + 188;
  for (auto* list : {&log.truth, &log.increments})
    list->erase(list->begin() + static_cast<long>(lifted), list->begin() + static_cast<long>(put_down));
  log.scans.erase(log.scans.begin() + static_cast<long>(lifted),
                  log.scans.begin() + static_cast<long>(put_down));
  const auto graph = run(log);
  int lost_at = -1, recovered_at = -1;
  for (const auto& entry : graph.journal()) {
    if (entry.event == core::JournalEvent::kLost) {
      EXPECT_EQ(lost_at, -1);
      lost_at = entry.scan;
    }
    if (entry.event == core::JournalEvent::kRecovered) recovered_at = entry.scan;
  }
  EXPECT_GE(lost_at, static_cast<int>(lifted));
  EXPECT_LT(lost_at, static_cast<int>(lifted) + 20);
  EXPECT_GT(recovered_at, lost_at);
  EXPECT_LT(worstError(graph.poses(), log.truth), 0.15);
}

TEST(GraphSlam, IsCarriedAwayTwiceAndJoinsBothParts) {
  auto log = drive(ring(), lapsAround(4), {}, 0);
  // Both times from the middle of a corridor to its end, turned; the second time before the first part can be
  // joined.
  const size_t lap = log.scans.size() / 4;
  const std::pair<size_t, size_t> carried[] = {{lap + 230, lap + 320}, {lap + 90, lap + 188}};
  for (const auto& [lifted, put_down] : carried) {
    const auto from = static_cast<long>(lifted), to = static_cast<long>(put_down);
    for (auto* list : {&log.truth, &log.increments}) list->erase(list->begin() + from, list->begin() + to);
    log.scans.erase(log.scans.begin() + from, log.scans.begin() + to);
  }
  const auto graph = run(log);
  int lost = 0;
  for (const auto& entry : graph.journal()) lost += entry.event == core::JournalEvent::kLost;
  EXPECT_EQ(lost, 2);
  EXPECT_EQ(eventsOf(graph).count("recovered"), 1U);
  const auto poses = graph.poses();
  EXPECT_LT(core::distance(poses.back(), log.truth.back()), 0.15);
}

TEST(GraphSlam, FindsItselfInAFinishedMapFromNowhere) {
  const auto log = drive(ring(), lapsAround(1), {}, 0);
  auto graph = run(log);
  graph.startAnywhere();
  GraphSlam::Step step;
  size_t found_at = 0;
  for (size_t i = 150; i < 400; ++i) {
    step = graph.localise(log.scans[i], log.increments[i], true);
    if (found_at == 0 && eventsOf(graph).count("recovered") > 0) found_at = i;
    if (found_at > 0) {
      ASSERT_LT(core::distance(step.T_map_robot, log.truth[i]), 0.1) << i;
    }
  }
  EXPECT_GT(found_at, 150U);
}

TEST(GraphSlam, TakesAScanOrTwoOfNonsenseForNoLoss) {
  auto log = drive(ring(), lapsAround(1), {}, 0);
  const size_t middle = log.scans.size() / 2;
  for (size_t i = middle; i < middle + 2; ++i)
    for (float& range : log.scans[i].ranges_m) range = 0.3F;
  const auto graph = run(log);
  EXPECT_EQ(eventsOf(graph).count("lost"), 0U);
  EXPECT_LT(worstError(graph.poses(), log.truth), 0.1);
}

TEST(GraphSlam, JoinsWhatWasNoKidnappingNearWhereOdometryHasIt) {
  // A building that looks the same when it is turned round: no part of a map can be told by its looks alone.
  auto walls = ring();
  for (size_t i = 0, n = walls.size(); i < n; ++i)
    walls.push_back({{20 - walls[i].a.x, 14 - walls[i].a.y}, {20 - walls[i].b.x, 14 - walls[i].b.y}});
  auto log = drive(walls, lapsAround(2), {}, 0);
  // For five metres the lidar sees another building, which fits itself: a robot that tilts, a curtain that is
  // drawn.
  const size_t begin = log.scans.size() / 2 + 40, end = begin + 50;
  const auto elsewhere = rectangle(-2, -1.5, 12, 4);
  core::RandomStream chance(5, "elsewhere");
  core::Pose2 pose;
  for (size_t i = begin; i < end; ++i) {
    pose = pose * core::between(log.truth[i - 1], log.truth[i]);
    log.scans[i].ranges_m = look(elsewhere, pose, {}, chance).ranges_m;
  }
  const auto graph = run(log);
  EXPECT_EQ(eventsOf(graph).count("lost"), 1U) << "nothing to mend: the test is void";
  EXPECT_EQ(eventsOf(graph).count("recovered"), 1U);
  EXPECT_LT(worstError(graph.poses(), log.truth), 0.1);
}

TEST(GraphSlam, FindsItselfAgainInAFinishedMap) {
  const auto log = drive(ring(), lapsAround(1), {}, 0);
  auto graph = run(log);
  const int keyframes = graph.keyframeCount();
  const size_t far = 188, before = 80;
  graph.startAt(log.truth[before]);
  for (size_t i = before; i < before + 10; ++i) graph.localise(log.scans[i], log.increments[i], true);
  // Carried to a third of the lap.
  GraphSlam::Step step;
  // It has to be followed through more than a room, and the whole map to be looked at.
  for (size_t i = far; i < far + 360; ++i) step = graph.localise(log.scans[i], log.increments[i], true);
  EXPECT_LT(core::distance(step.T_map_robot, log.truth[far + 359]), 0.1);
  EXPECT_TRUE(eventsOf(graph).count("lost"));
  EXPECT_TRUE(eventsOf(graph).count("recovered"));
  EXPECT_EQ(graph.keyframeCount(), keyframes);
}

TEST(GraphSlam, FollowsOdometryWhereAFinishedMapEnds) {
  const auto log = drive(ring(), lapsAround(1), {}, 0);
  const size_t half = log.scans.size() / 2;
  GraphSlam graph{keyframes::GraphOptions()};
  for (size_t i = 0; i < half; ++i) graph.process(log.scans[i], log.increments[i], true);
  graph.startAt(log.truth[half - 1]);
  GraphSlam::Step step;
  for (size_t i = half; i < log.scans.size(); ++i)
    step = graph.localise(log.scans[i], log.increments[i], true);
  // Half a lap by wheels, which err by a few centimetres.
  EXPECT_LT(core::distance(step.T_map_robot, log.truth.back()), 0.5);
}

TEST(GraphSlam, IsLessSureTheFartherItDrivesAndSurerOnceALoopIsClosed) {
  const auto log = drive(ring(), lapsAround(2), {}, 0);
  GraphSlam graph{keyframes::GraphOptions()};
  std::vector<double> variance;
  variance.reserve(log.scans.size());
  for (size_t i = 0; i < log.scans.size(); ++i)
    variance.push_back(graph.process(log.scans[i], log.increments[i], true).pose_covariance.trace());
  EXPECT_EQ(variance[0], 0);
  const auto widest = std::max_element(variance.begin(), variance.end()) - variance.begin();
  const auto lap = static_cast<long>(log.scans.size() / 2);
  EXPECT_GT(variance[static_cast<size_t>(widest)], 4 * variance[20]);
  EXPECT_LT(widest, lap + lap / 4);
  EXPECT_LT(variance.back(), 0.5 * variance[static_cast<size_t>(widest)]);
  graph.finish();
  const auto covariances = graph.covariances();
  ASSERT_EQ(covariances.size(), log.scans.size());
  EXPECT_LT(covariances[static_cast<size_t>(widest)].trace(), variance[static_cast<size_t>(widest)]);
}

TEST(GraphSlam, GivesItsEdgesInformationThatTheGraphTakesWhereADirectionIsOpen) {
  // A wall far away: all that is known stands on one line, and rounding puts the others below zero.
  for (double phi = -3; phi < 3; phi += 0.1) {
    const Eigen::Vector3d seen(1e4 * std::cos(0.3), 1e4 * std::sin(0.3), 4e5);
    posegraph::PoseGraph graph;
    graph.addNode({});
    graph.addNode({});
    posegraph::Edge edge;
    edge.from = 0, edge.to = 1;
    Eigen::Matrix3d information = seen * seen.transpose() * 1e-3;
    information(0, 0) *= 1 - 1e-12;
    edge.information = scanmatch::edgeInformation(information, phi);
    EXPECT_NO_THROW(graph.addEdge(edge)) << phi;
  }
}

TEST(GraphSlam, RefusesWhatItsContractRulesOut) {
  GraphSlam graph{keyframes::GraphOptions()};
  EXPECT_THROW(graph.process(lidar::Scan(), {}, false), core::ContractError);
  EXPECT_THROW(graph.startAt({}), core::ContractError);
  graph.finish();
  EXPECT_TRUE(graph.poses().empty());
}

}  // namespace
}  // namespace slam::graph

// The past that all particles share once a loop is closed.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <cstring>

#include "libslam/particles/particle_filter.h"
#include "tests/graph/drawn_drives.h"

namespace slam::particles {
namespace {

using namespace graph::test_drives;

/// One and a half laps through a ring of 40 x 28 m, of which a short lidar sees little at a time.
struct LongWay {
  std::vector<Wall> walls;
  std::vector<core::Pose2> path;
};

LongWay longWay() {
  LongWay way;
  way.walls = rectangle(0, 0, 40, 28);
  const auto block = rectangle(2, 2, 38, 26);
  way.walls.insert(way.walls.end(), block.begin(), block.end());
  const auto post = [&](double x, double y, double wide, double high) {
    const auto walls = rectangle(x, y, x + wide, y + high);
    way.walls.insert(way.walls.end(), walls.begin(), walls.end());
  };
  // Not one place looks like another.
  double x = 3;
  for (int i = 0; x < 36; ++i) {
    post(x, 0, 0.3 + 0.05 * (i % 4), 0.35), post(38.5 - x, 27.6, 0.4, 0.4);
    x += 1.3 + 0.37 * ((i * 5) % 7);
  }
  double y = 3;
  for (int i = 0; y < 24; ++i) {
    post(39.65, y, 0.35, 0.4 + 0.06 * (i % 3)), post(0, 26.5 - y, 0.4, 0.5);
    y += 1.1 + 0.43 * ((i * 3) % 5);
  }
  const core::Point2 corners[] = {{1, 1}, {39, 1}, {39, 27}, {1, 27}};
  for (int side = 0; side < 6; ++side) {
    const core::Point2 a = corners[side % 4], b = corners[(side + 1) % 4];
    const double heading = std::atan2(b.y - a.y, b.x - a.x), length = core::distance(a, b);
    for (double s = 0; s < length; s += 0.2)
      way.path.push_back({a.x + s / length * (b.x - a.x), a.y + s / length * (b.y - a.y), heading});
    for (double turn = 0.15; turn < core::kPi / 2; turn += 0.15)
      way.path.push_back({b.x, b.y, heading + turn});
  }
  return way;
}

const Drive& longDrive() {
  static const Drive kDrive = [] {
    const LongWay way = longWay();
    Lidar lidar;
    lidar.beams = 91, lidar.max_range_m = 5, lidar.noise_m = 0.03;
    return drive(way.walls, way.path, lidar, 2e-3, 5);
  }();
  return kDrive;
}

Motion motionOf(const core::Pose2& wheels) {
  const double xy = 0.02 + 0.1 * std::abs(wheels.x), turn = 0.02 + 0.2 * std::abs(wheels.phi);
  return {wheels, Eigen::Vector3d(xy * xy, xy * xy, turn * turn).asDiagonal()};
}

ParticleFilter driven(bool loops, int threads = 1) {
  ParticleFilterOptions options;
  options.count = 8, options.loops = loops, options.threads = threads;
  ParticleFilter filter(options, 3);
  const Drive& log = longDrive();
  for (size_t i = 0; i < log.scans.size(); ++i) filter.update(log.scans[i], motionOf(log.increments[i]));
  filter.finish();
  return filter;
}

double worstOf(const core::Trajectory& path) {
  double worst = 0;
  for (size_t i = 0; i < path.size(); ++i)
    worst = std::max(worst, core::distance(path[i].pose, longDrive().truth[i]));
  return worst;
}

int times(const ParticleFilter& filter, core::JournalEvent event) {
  int count = 0;
  for (const auto& entry : filter.journal()) count += entry.event == event;
  return count;
}

TEST(ParticleLoops, CorrectThePast) {
  const auto without = driven(false), with = driven(true);
  ASSERT_EQ(with.path().size(), longDrive().scans.size());
  EXPECT_EQ(times(without, core::JournalEvent::kAccepted), 0);
  EXPECT_GE(times(with, core::JournalEvent::kAccepted), 1);
  RecordProperty("worst",
                 std::to_string(worstOf(without.path())) + " " + std::to_string(worstOf(with.path())));
  EXPECT_LT(worstOf(with.path()), 0.6 * worstOf(without.path()));
}

// Scans are matched to a map that was drawn of the past as it is now.
TEST(ParticleLoops, LeaveTheRobotWhereTheMapHasIt) {
  ParticleFilterOptions options;
  options.count = 8;
  ParticleFilter filter(options, 3);
  const Drive& log = longDrive();
  size_t closed_at = log.scans.size();
  double worst = 1;
  for (size_t i = 0; i < log.scans.size(); ++i) {
    const auto& step = filter.update(log.scans[i], motionOf(log.increments[i]));
    if (step.loop_closed) {
      closed_at = i;
      for (const auto& pose : filter.poses()) EXPECT_LT(core::distance(pose, step.T_map_robot), 1e-9);
    }
    if (i > closed_at && i <= closed_at + 20) worst = std::min(worst, step.score);
  }
  ASSERT_LT(closed_at, log.scans.size()) << "no loop";
  RecordProperty("worst", std::to_string(worst));
  EXPECT_GT(worst, 0.6);
}

/// Of the cells that either map has occupied, the share that both have.
double sharedWalls(const gridmap::Grid& a, const gridmap::Grid& b) {
  const auto raster = a.toRaster();
  const int first_x = static_cast<int>(std::lround(raster.x_min_m / raster.resolution_m)),
            first_y = static_cast<int>(std::lround(raster.y_min_m / raster.resolution_m));
  int both = 0, either = 0;
  for (int y = first_y; y < first_y + raster.rows; ++y)
    for (int x = first_x; x < first_x + raster.columns; ++x) {
      const bool in_a = a.probability(x, y) > 0.5, in_b = b.probability(x, y) > 0.5;
      both += in_a && in_b, either += in_a || in_b;
    }
  return static_cast<double>(both) / either;
}

// What the best particle has driven is what the keyframes say, whichever particle was the best when they
// came.
TEST(ParticleLoops, DrawTheMapWhereTheBestParticleWas) {
  ParticleFilterOptions options;
  options.count = 30, options.proposal_scale = 1;
  ParticleFilter filter(options, 3);
  const Drive& log = longDrive();
  std::vector<size_t> inserted;
  for (size_t i = 0; i < log.scans.size(); ++i) {
    const auto& step = filter.update(log.scans[i], motionOf(log.increments[i]));
    if (step.inserted) inserted.push_back(i);
    if (step.loop_closed) break;
  }
  ASSERT_TRUE(filter.lastStep().loop_closed) << "no loop";
  const auto path = filter.path();
  gridmap::Grid drawn(filter.map().options());
  for (const size_t i : inserted)
    drawn.insert(gridmap::scanRays(log.scans[i], filter.rays()),
                 ParticleFilter::rasterFromMap() * path[i].pose);
  RecordProperty("shared", std::to_string(sharedWalls(filter.map(), drawn)));
  EXPECT_GT(sharedWalls(filter.map(), drawn), 0.97);
}

// A clean corridor does not tell how far the robot has come: each step's error by the wheels is one more.
TEST(ParticleLoops, LeaveTheWheelsTheirErrorsAlongACorridor) {
  std::vector<core::Pose2> way;
  way.reserve(100);
  for (int i = 0; i < 100; ++i) way.push_back({0.1 * i, 0, 0});
  const Drive log = drive(rectangle(-100, -1, 100, 1), way, {}, 0, 3);
  ParticleFilterOptions options;
  options.count = 8;
  ParticleFilter filter(options, 3);
  for (size_t i = 0; i < log.scans.size(); ++i) filter.update(log.scans[i], motionOf(log.increments[i]));
  const Eigen::Matrix3d covariance = filter.lastStep().covariance;
  RecordProperty("along", std::to_string(std::sqrt(covariance(0, 0))));
  // 3 cm a step are 30 cm; particles that are resampled spread besides.
  EXPECT_GT(std::sqrt(covariance(0, 0)), 0.15);
  EXPECT_LT(std::sqrt(covariance(1, 1)), 0.05);
}

TEST(ParticleLoops, TellHowSureThePastIs) {
  const auto filter = driven(true);
  const auto path = filter.path();
  const auto covariances = filter.covariances();
  ASSERT_EQ(covariances.size(), path.size());
  int inside = 0;
  for (size_t i = 0; i < path.size(); ++i) {
    const core::Pose2& truth = longDrive().truth[i];
    const Eigen::Vector3d off(path[i].pose.x - truth.x, path[i].pose.y - truth.y,
                              core::angleDifference(path[i].pose.phi, truth.phi));
    const Eigen::Matrix3d covariance = covariances[i] + 1e-9 * Eigen::Matrix3d::Identity();
    inside += off.dot(covariance.inverse() * off) < 7.81;  // 95 of 100, chi-square with three degrees
  }
  RecordProperty("inside", std::to_string(inside) + " of " + std::to_string(path.size()));
  EXPECT_GT(inside, 0.9 * static_cast<double>(path.size()));
}

TEST(ParticleLoops, TellHowSurePosesAreOfOneAnother) {
  const auto filter = driven(true);
  const auto path = filter.path();
  const auto& truth = longDrive().truth;
  EXPECT_TRUE(filter.relativeCovariances({}).empty());
  // As the first pose, which is given, sees the others, so the map does.
  const auto of_map = filter.covariances();
  const int last = static_cast<int>(path.size()) - 1;
  const auto of_first = filter.relativeCovariances({{0, 40}, {0, last}});
  for (const auto& [seen, scan] : {std::pair(of_first[0], 40), {of_first[1], last}}) {
    const Eigen::Matrix3d& expected = of_map[static_cast<size_t>(scan)];
    EXPECT_LT((seen - expected).cwiseAbs().maxCoeff(), 1e-6 * expected.cwiseAbs().maxCoeff()) << scan;
  }
  // 1 m and 10 m on.
  for (const int steps : {5, 50}) {
    std::vector<std::pair<int, int>> pairs;
    for (int i = 0; i + steps <= last; ++i) pairs.emplace_back(i, i + steps);
    const auto told = filter.relativeCovariances(pairs);
    ASSERT_EQ(told.size(), pairs.size());
    int inside = 0;
    double relative = 0, absolute = 0;  // m^2
    for (size_t i = 0; i < pairs.size(); ++i) {
      const size_t j = i + static_cast<size_t>(steps);
      const core::Pose2 is = core::between(path[i].pose, path[j].pose),
                        was = core::between(truth[i], truth[j]);
      const Eigen::Vector3d off(is.x - was.x, is.y - was.y, core::angleDifference(is.phi, was.phi));
      const Eigen::Matrix3d covariance = told[i] + 1e-9 * Eigen::Matrix3d::Identity();
      inside += off.dot(covariance.inverse() * off) < 7.81;
      relative += told[i](0, 0) + told[i](1, 1), absolute += of_map[j](0, 0) + of_map[j](1, 1);
    }
    const auto count = static_cast<double>(pairs.size());
    RecordProperty("inside_" + std::to_string(steps), std::to_string(inside / count) + ", of the absolute " +
                                                          std::to_string(relative / absolute));
    EXPECT_GT(inside, 0.85 * count) << steps;
    EXPECT_LT(relative, (steps == 5 ? 0.5 : 0.9) * absolute)
        << "surer than in the map, " << steps << " steps apart";
  }
}

TEST(ParticleLoops, AreTheSameBytesWithAnyNumberOfThreads) {
  const auto one = driven(true).path(), two = driven(true, 2).path();
  ASSERT_EQ(one.size(), two.size());
  EXPECT_EQ(std::memcmp(one.data(), two.data(), one.size() * sizeof(one[0])), 0);
}

}  // namespace
}  // namespace slam::particles

#include "libslam/mapping/map_builder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/random/RandomGenerators.h>
#include <mrpt/serialization/CArchive.h>
#include <mrpt/slam/CMetricMapBuilder.h>
#include <mrpt/slam/CMetricMapBuilderRBPF.h>

#include <algorithm>
#include <filesystem>
#include <thread>

#include "libslam/builders/mrpt_compat.h"
#include "libslam/core/error.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/resources/file_hash.h"
#include "libslam/testing/temp_folder.h"
#include "tests/mapping/small_room.h"

namespace slam::mapping {
namespace {

const std::string kMethods = std::string(RASTERSLAM_SOURCE_DIR) + "/configs/methods";

MapBuilder makeMethod(const std::string& name, std::uint64_t seed = 1,
                      const std::vector<std::string>& settings = {}) {
  auto ini = loadMethodConfig(kMethods, name);
  for (const auto& setting : settings) ini.setFromArgument(setting, "test");
  return makeMapBuilder(ini, name, seed);
}

core::Trajectory runDrive(MapBuilder& method, const test::Drive& drive) {
  core::Trajectory estimate;
  for (const auto& entry : drive.entries)
    estimate.push_back(
        {entry.scan.time_s, processScan(method, entry.scan, entry.T_previous_robot, entry.has_odometry)});
  return estimate;
}

/// A run that is the same to the last bit.
std::string fingerprint(const core::Trajectory& estimate) {
  return resources::sha256(
      {reinterpret_cast<const char*>(estimate.data()), estimate.size() * sizeof(estimate[0])});
}

class EveryMethod : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryMethod, StartsAtTheIdentityAndGivesFinitePoses) {
  auto method = makeMethod(GetParam());
  auto drive = test::driveThroughRoom(5);
  // What the wheels did before the first scan is nobody's business.
  drive.entries[0].T_previous_robot = {100, 100, 1};
  const auto estimate = runDrive(method, drive);
  // MRPT's particle filter spreads even the first pose, with some millimetres and tenths of a degree.
  const bool spreads = method.type == "rbpf";
  EXPECT_NEAR(core::distance(core::position(estimate[0].pose), {}), 0, spreads ? 0.005 : 1e-9);
  EXPECT_NEAR(estimate[0].pose.phi, 0, spreads ? core::degToRad(0.3) : 1e-9);
  for (const auto& stamped : estimate) EXPECT_TRUE(core::isFinite(stamped.pose));
}

TEST_P(EveryMethod, GivesTheSameBytesForTheSameSeedWhateverElseUsesTheGenerator) {
  const auto drive = test::driveThroughRoom(30);
  const testing::TempFolder first_folder, second_folder;
  auto first = makeMethod(GetParam(), 7);
  const auto first_path = runDrive(first, drive);
  saveMaps(first, first_folder.path());

  // Another thread, whose generator has been seeded and half used by somebody else.
  core::Trajectory second_path;
  std::thread([&] {
    mrpt::random::getRandomGenerator().randomize(99);
    mrpt::random::getRandomGenerator().drawGaussian1D_normalized();
    auto second = makeMethod(GetParam(), 7);
    second_path = runDrive(second, drive);
    saveMaps(second, second_folder.path());
  }).join();

  EXPECT_EQ(fingerprint(first_path), fingerprint(second_path));
  for (const char* file : {"map.yaml", "map.png", "map.gridmap.gz", "map.simplemap"})
    EXPECT_EQ(resources::fileSha256(first_folder / file), resources::fileSha256(second_folder / file))
        << file;
}

TEST_P(EveryMethod, PrintsNothing) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  {
    // Things that make MRPT talk: matches that are never good enough, a scan that fits nothing, and a clock
    // that runs back.
    std::vector<std::string> settings;
    if (std::string(GetParam()) == "particles")
      settings = {"mapping.insert_distance_m=0"};
    else if (std::string(GetParam()).find("naive") == std::string::npos)
      settings = {"icp.min_goodness=1", "mapping.localize_distance_m=0", "mapping.insert_distance_m=0"};
    auto method = makeMethod(GetParam(), 1, settings);
    auto drive = test::driveThroughRoom(20);
    for (auto& range_m : drive.entries[10].scan.ranges_m) range_m = 0.5F;
    drive.entries[15].scan.time_s -= 10;
    runDrive(method, drive);
  }
  std::fflush(nullptr);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod,
                         ::testing::Values("naive", "naive_blind", "naive_correlation", "naive_flow",
                                           "naive_wheel", "icp", "icp_exact", "rbpf", "rbpf_exact",
                                           "particles"),
                         [](const auto& method) { return std::string(method.param); });

TEST(MapBuilder, MatchersBeatTheirOdometryInTheSmallRoom) {
  const auto drive = test::driveThroughRoom();
  auto wheel = makeMethod("naive_wheel");
  const auto& truth = drive.truth.back();
  const double wheel_error_rad =
      std::abs(core::angleDifference(runDrive(wheel, drive).back().pose.phi, truth.phi));
  // Exact scans, cells and points 5 cm apart: about a cell, and for ICP a cell seen at 4 m. The filter
  // matches every 5th point to cell centres, which errs by up to 1.6 degrees over seeds in so small a room.
  const std::map<std::string, double> tolerance_deg = {{"icp", 0.7}, {"rbpf_exact", 1.8}, {"particles", 0.5}};
  for (const auto& [name, tolerance] : tolerance_deg) {
    auto method = makeMethod(name);
    const auto pose = runDrive(method, drive).back().pose;
    EXPECT_LT(core::distance(core::position(pose), core::position(truth)), 0.06) << name;
    EXPECT_LT(std::abs(core::angleDifference(pose.phi, truth.phi)), core::degToRad(tolerance)) << name;
    EXPECT_LT(std::abs(core::angleDifference(pose.phi, truth.phi)), wheel_error_rad) << name;
  }
}

TEST(MapBuilder, WheelsFillInWhereTheScansLeaveTheMotionOpenButNotForArgmax) {
  auto drive = test::driveThroughRoom(6);
  for (auto& entry : drive.entries) {
    for (auto& range_m : entry.scan.ranges_m) range_m = lidar::kNoReturn;
    entry.T_previous_robot = {0.1, 0, 0};
  }
  for (const std::string name : {"naive_correlation", "naive_flow"}) {
    auto method = makeMethod(name);
    // The first increment is taken as null.
    EXPECT_NEAR(runDrive(method, drive).back().pose.x, 0.1 * double(drive.entries.size() - 1), 1e-6) << name;
  }
  auto original = makeMethod("naive");
  EXPECT_NEAR(runDrive(original, drive).back().pose.x, 0, 1e-6);
}

TEST(MapBuilder, WheelOdometryIsUsedFromTheFirstStepOfAnOldLog) {
  // The scans see nothing, so that nothing but the odometry can move the pose.
  auto drive = test::driveThroughRoom(6);
  core::Pose2 T_odom_robot;
  auto method = makeMethod("icp");
  core::Pose2 pose;
  for (auto& entry : drive.entries) {
    entry.scan.time_s -= 1.5e9;  // 1973
    entry.scan.ranges_m.assign(entry.scan.ranges_m.size(), lidar::kNoReturn);
    T_odom_robot = T_odom_robot * entry.T_previous_robot;
    pose = processScan(method, entry.scan, entry.T_previous_robot, true);
  }
  EXPECT_NEAR(core::distance(core::position(pose), core::position(T_odom_robot)), 0, 1e-6);
}

TEST(MapBuilder, WithoutOdometryTheWheelMethodFallsBackToTheScans) {
  auto drive = test::driveThroughRoom(24);
  auto correlation = makeMethod("naive_correlation");
  const auto expected = runDrive(correlation, drive);
  for (auto& entry : drive.entries) entry.has_odometry = false, entry.T_previous_robot = {};
  auto wheel = makeMethod("naive_wheel");
  EXPECT_EQ(fingerprint(runDrive(wheel, drive)), fingerprint(expected));
}

TEST(MapBuilder, OneStepWithoutOdometryTakesThatStepFromTheScans) {
  auto drive = test::driveThroughRoom(12);
  auto all = makeMethod("naive_wheel");
  const auto with_wheels = runDrive(all, drive);
  drive.entries[7].has_odometry = false;
  drive.entries[7].T_previous_robot = {};
  auto gap = makeMethod("naive_wheel");
  const auto with_gap = runDrive(gap, drive);
  EXPECT_EQ(with_gap[6].pose.x, with_wheels[6].pose.x);
  const auto step = core::between(with_gap[6].pose, with_gap[7].pose);
  const auto truth = core::between(drive.truth[6], drive.truth[7]);
  // Nearer to the truth than the wheels, which turn 3 % too far; a centimetre for the scan odometry.
  EXPECT_LT(core::distance(core::position(step), core::position(truth)), 0.01);
  EXPECT_LT(std::abs(core::angleDifference(step.phi, truth.phi)), core::degToRad(0.3));
}

TEST(MapBuilder, AMapThatWouldGrowWithoutBoundIsRefusedBeforeItIsMade) {
  for (const char* name : {"naive_wheel", "icp", "rbpf", "rbpf_exact", "particles"}) {
    auto method = makeMethod(name);
    const auto drive = test::driveThroughRoom(3);
    runDrive(method, drive);
    try {
      processScan(method, drive.entries[2].scan, {1e7, 1e7, 0}, true);
      FAIL() << name << ": a map of ten thousand kilometres was made";
    } catch (const core::MethodError& error) {
      EXPECT_THAT(error.what(),
                  ::testing::StartsWith("method " + std::string(name) + ", scan 4: the map would "));
    }
  }
}

TEST(MapBuilder, DotsTooFarAwayAreRefusedToo) {
  auto method = makeMethod("naive");
  auto scan = test::scanRoom({}, 1.6e9);
  scan.max_range_m = 4e6;
  scan.ranges_m[90] = 3e6F;
  EXPECT_THROW(processScan(method, scan, {}, true), core::MethodError);
}

TEST(MapBuilder, AMotionThatIsNotFiniteIsAnErrorOfTheMethod) {
  auto method = makeMethod("rbpf");
  const auto drive = test::driveThroughRoom(2);
  processScan(method, drive.entries[0].scan, {}, true);
  try {
    processScan(method, drive.entries[1].scan, {NAN, 0, 0}, true);
    FAIL();
  } catch (const core::MethodError& error) {
    EXPECT_STREQ(error.what(), "method rbpf, scan 2: the odometry is not finite");
  }
}

TEST(MapBuilder, TheParticlesShareTheLimitOfTheMap) {
  // Some 20 x 20 m at 0.07 m are 80 thousand cells: enough for one particle, too much for twenty.
  auto method = makeMethod("rbpf", 1, {"mapping.max_map_cells=500000", "mapping.resolution_m=0.07"});
  const auto drive = test::driveThroughRoom(2);
  try {
    processScan(method, drive.entries[0].scan, {}, true);
    FAIL();
  } catch (const core::MethodError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("allowed are 0.5 million ([mapping] max_map_cells)"));
  }
  auto one = makeMethod("rbpf", 1,
                        {"mapping.max_map_cells=500000", "particles.count=1", "mapping.resolution_m=0.07"});
  EXPECT_NO_THROW(processScan(one, drive.entries[0].scan, {}, true));
}

TEST(MapBuilder, DotsAreCertainAndEverythingElseIsUnknown) {
  auto method = makeMethod("naive", 1, {"mapping.draw_after=every_scan"});  // the first scan, too
  const auto drive = test::driveThroughRoom(1);
  runDrive(method, drive);
  const auto map = currentMap(method);
  ASSERT_EQ(map.occupancy.size(), static_cast<size_t>(map.columns) * static_cast<size_t>(map.rows));
  EXPECT_EQ(map.resolution_m, 0.05);
  for (const float p : map.occupancy) EXPECT_TRUE(p == 1.0F || p == 0.5F);
  // Straight ahead of the first pose.
  const double range_m = drive.entries[0].scan.ranges_m[90];
  const int column = static_cast<int>((range_m - map.x_min_m) / map.resolution_m);
  const int row = static_cast<int>((0 - map.y_min_m) / map.resolution_m);
  float nearby = 0;  // the return lies on the line between two rows
  for (int r = row - 1; r <= row; ++r)
    nearby = std::max(nearby, map.occupancy[static_cast<size_t>(r) * static_cast<size_t>(map.columns) +
                                            static_cast<size_t>(column)]);
  EXPECT_EQ(nearby, 1.0F);
}

TEST(FinalPath, IsThatOfTheBestParticleAndFollowsTheWheelsBetweenItsUpdates) {
  const auto drive = test::driveThroughRoom(60);
  auto method = makeMethod("rbpf_exact");
  const auto online = runDrive(method, drive);
  const auto path = finalPath(method, online);
  ASSERT_TRUE(path.has_value());
  ASSERT_EQ(path->size(), online.size());
  int steps_of_wheels = 0, other_steps = 0;
  for (size_t i = 0; i < online.size(); ++i) {
    EXPECT_EQ((*path)[i].time_s, online[i].time_s);
    // The particles spread by their likelihood's 0.1 m and the wheels' noise, no more.
    EXPECT_LT(core::distance((*path)[i].pose, online[i].pose), 0.15) << i;
    if (i == 0) continue;
    const auto step = core::between((*path)[i - 1].pose, (*path)[i].pose);
    const auto by_wheels = core::between(step, drive.entries[i].T_previous_robot);
    (std::hypot(by_wheels.x, by_wheels.y) < 1e-6 ? steps_of_wheels : other_steps)++;
  }
  // An update every 0.3 m or 10 degrees at 0.06 m and 3.5 degrees a scan.
  EXPECT_GT(other_steps, 10);
  EXPECT_GT(steps_of_wheels, 30);
}

TEST(FinalPath, IsThatOfTheMostLikelyParticle) {
  const auto drive = test::driveThroughRoom(60);
  auto method = makeMethod("rbpf_exact", 1, {"particles.resample_below=0"});
  const auto path = finalPath(method, runDrive(method, drive)).value();
  const auto& particles =
      dynamic_cast<mrpt::slam::CMetricMapBuilderRBPF&>(mrptBuilder(method)).mapPDF.m_particles;
  const auto [worst, best] = std::minmax_element(
      particles.begin(), particles.end(), [](const auto& a, const auto& b) { return a.log_w < b.log_w; });
  ASSERT_LT(worst->log_w, best->log_w);
  const auto isOn = [&](const auto& particle) {
    const mrpt::math::TPose2D last(particle.d->robotPath.back());
    return std::any_of(path.begin(), path.end(),
                       [&](const core::StampedPose& at) { return at.pose == lidar::fromMrpt(last); });
  };
  EXPECT_TRUE(isOn(*best));
  EXPECT_FALSE(isOn(*worst));
}

TEST(MapBuilder, AKeptMapIsNotRefined) {
  const testing::TempFolder folder;
  const auto drive = test::driveThroughRoom(20);
  auto first = makeMethod("graph");
  runDrive(first, drive);
  saveMaps(first, folder.path());
  for (const bool keep_map : {false, true}) {
    auto second = makeMethod("graph", 1, {"graph.refine_rounds=1"});
    continueMap(second, folder / "map.simplemap", core::Pose2{}, keep_map);
    runDrive(second, drive);
    finishMap(second);
    const auto journal = journalOf(second);
    EXPECT_EQ(std::count_if(journal.begin(), journal.end(),
                            [](const core::JournalEntry& one) { return one.detail == "refinement"; }),
              keep_map ? 0 : 1);
  }
}

TEST(FinalPath, IsOnlyThereWhereItDiffersFromWhatWasGivenOnline) {
  const auto drive = test::driveThroughRoom(3);
  for (const char* name : {"naive_wheel", "icp"}) {
    auto method = makeMethod(name);
    EXPECT_FALSE(finalPath(method, runDrive(method, drive)).has_value()) << name;
  }
  auto method = makeMethod("rbpf_exact");
  EXPECT_THROW(finalPath(method, {}), core::ContractError);
  runDrive(method, drive);
  EXPECT_THROW(finalPath(method, {{0, {}}}), core::ContractError);
}

TEST(MapFiles, TheRosMapHasTheMapsCellsWithTheTopRowFirst) {
  const testing::TempFolder folder;
  auto method = makeMethod("naive_wheel");
  const auto estimate = runDrive(method, test::driveThroughRoom(20));
  saveMaps(method, folder.path());
  const auto map = currentMap(method);
  // MRPT's own reader of ROS maps turns the rows back; it keeps only occupied, free and unknown.
  mrpt::maps::COccupancyGridMap2D ros(0, 1, 0, 1, 0.5F);
  ASSERT_TRUE(ros.loadFromROSMapServerYAML(folder / "map.yaml"));
  ASSERT_EQ(static_cast<int>(ros.getSizeX()), map.columns);
  ASSERT_EQ(static_cast<int>(ros.getSizeY()), map.rows);
  EXPECT_NEAR(ros.getXMin(), map.x_min_m, 1e-4);
  EXPECT_NEAR(ros.getYMin(), map.y_min_m, 1e-4);
  int occupied = 0, free = 0, wrong = 0;
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column) {
      const float p = map.occupancy[static_cast<size_t>(row) * static_cast<size_t>(map.columns) +
                                    static_cast<size_t>(column)];
      const float free_in_file = ros.getCell(column, row);
      if (p > gridmap::kOccupiedAbove) ++occupied, wrong += free_in_file > 0.3F ? 1 : 0;
      if (p < gridmap::kFreeBelow) ++free, wrong += free_in_file < 0.7F ? 1 : 0;
    }
  EXPECT_GT(occupied, 200);
  EXPECT_GT(free, 5000);
  EXPECT_EQ(wrong, 0);
}

TEST(MapFiles, TheGridFileIsAStockGridWithTheSameCells) {
  const testing::TempFolder folder;
  auto method = makeMethod("rbpf_exact");
  const auto estimate = runDrive(method, test::driveThroughRoom(10));
  saveMaps(method, folder.path());
  mrpt::io::CFileGZInputStream file(folder / "map.gridmap.gz");
  const auto object = mrpt::serialization::archiveFrom(file).ReadObject();
  ASSERT_STREQ(object->GetRuntimeClass()->className, "mrpt::maps::COccupancyGridMap2D");
  const auto& grid = dynamic_cast<const mrpt::maps::COccupancyGridMap2D&>(*object);
  const auto& maps = builders::compat::asReference(mrptBuilder(method).getCurrentlyBuiltMetricMap());
  EXPECT_EQ(grid.getRawMap(), maps.mapByClass<mrpt::maps::COccupancyGridMap2D>()->getRawMap());
}

TEST(MapFiles, TheSimpleMapHoldsTheKeyFrames) {
  const testing::TempFolder folder;
  auto method = makeMethod("icp");
  const auto estimate = runDrive(method, test::driveThroughRoom(20));
  saveMaps(method, folder.path());
  mrpt::maps::CSimpleMap key_frames;
  ASSERT_TRUE(key_frames.loadFromFile(folder / "map.simplemap"));
  EXPECT_EQ(key_frames.size(), mrptBuilder(method).getCurrentlyBuiltMapSize());
  EXPECT_GE(key_frames.size(), 2U);
}

TEST(MapFiles, AFolderThatCannotBeWrittenIsAnIoError) {
  auto method = makeMethod("naive");
  const auto estimate = runDrive(method, test::driveThroughRoom(2));
  try {
    saveMaps(method, "/nowhere/at/all");
    FAIL();
  } catch (const core::IoError& error) {
    EXPECT_THAT(error.what(), ::testing::StartsWith("/nowhere/at/all/map"));
  }
}

}  // namespace
}  // namespace slam::mapping

#include "libslam/builders/exact_grid.h"

#include <gtest/gtest.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/maps/CMultiMetricMap.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cmath>

#include "libslam/lidar/mrpt_types.h"
#include "libslam/mapping/map_builder.h"
#include "tests/mapping/small_room.h"

namespace slam::builders {
namespace {

using mrpt::maps::COccupancyGridMap2D;

constexpr double kStep_deg = 1;  // 181 beams over 180 degrees

mrpt::obs::CObservation2DRangeScan mrptScan(const core::Pose2& T_room_robot, bool right_to_left = true) {
  auto scan = *lidar::toMrpt(mapping::test::scanRoom(T_room_robot, 1.6e9));
  if (right_to_left) return scan;
  const size_t beams = scan.getScanSize();
  auto turned = scan;
  turned.rightToLeft = false;
  for (size_t i = 0; i < beams; ++i) {
    turned.setScanRange(i, scan.getScanRange(beams - 1 - i));
    turned.setScanRangeValidity(i, scan.getScanRangeValidity(beams - 1 - i));
  }
  return turned;
}

/// The room in the map: turned, and perhaps seen in a mirror (then a scan's beams swap sides).
struct Placement {
  core::Pose2 T_map_room;
  bool mirrored = false;
  bool right_to_left = true;

  mrpt::poses::CPose3D robot(core::Pose2 T_room_robot) const {
    if (mirrored) T_room_robot = {T_room_robot.x, -T_room_robot.y, -T_room_robot.phi};
    const auto pose = T_map_room * T_room_robot;
    return {pose.x, pose.y, 0, pose.phi, 0, 0};
  }
  mrpt::obs::CObservation2DRangeScan scan(const core::Pose2& T_room_robot) const {
    auto scan = mrptScan(T_room_robot, right_to_left);
    if (!mirrored) return scan;
    auto swapped = mrptScan(T_room_robot, !right_to_left);
    swapped.rightToLeft = right_to_left;
    return swapped;
  }
};

/// The heading, in degrees off the true one, around which the likelihood of a scan has its mass. (Its highest
/// sample would be quantised by the cells.)
double likelihoodPeak_deg(const COccupancyGridMap2D& grid, const Placement& place,
                          const core::Pose2& T_room_robot) {
  const auto scan = place.scan(T_room_robot);
  std::vector<std::pair<double, double>> curve;
  double best = -1e300;
  for (int i = -40; i <= 40; ++i) {
    const double offset_deg = 0.05 * i;
    auto pose = place.robot(T_room_robot);
    pose.setYawPitchRoll(pose.yaw() + core::degToRad(offset_deg), 0, 0);
    curve.emplace_back(offset_deg, grid.computeObservationLikelihood(scan, pose));
    best = std::max(best, curve.back().second);
  }
  double weight = 0, sum = 0;
  for (const auto& [offset_deg, log_likelihood] : curve) {
    const double w = std::exp(log_likelihood - best);
    weight += w, sum += w * offset_deg;
  }
  return sum / weight;
}

/// By how many degrees scans match off their true heading in a grid that holds scans at their true poses. A
/// single room pulls the peak by some tenths of a degree one way or the other, for its walls lie so or so in
/// the cells; what is left in the mean over turned rooms and their mirror images is the turn that insertion
/// adds.
template <class Grid>
double headingBias_deg(bool right_to_left = true) {
  double sum = 0;
  int count = 0;
  for (const bool mirrored : {false, true})
    for (int turn = 0; turn < 12; ++turn) {
      const Placement place{{0.013, 0.007, 0.1 + turn * core::kPi / 6}, mirrored, right_to_left};
      Grid grid(-9.017F, 9.0F, -9.023F, 9.0F, 0.05F);
      grid.insertionOptions.maxDistanceInsertion = 30;
      grid.likelihoodOptions.LF_decimation = 1;
      grid.likelihoodOptions.LF_stdHit = 0.1F;
      for (int i = 0; i < 20; ++i) {
        const core::Pose2 T_room_robot{0.062 * i, 0.1 + 0.034 * i, -0.6 + 0.0614 * i};
        grid.insertObservation(place.scan(T_room_robot), place.robot(T_room_robot));
      }
      for (int i = 0; i < 6; ++i, ++count)
        sum += likelihoodPeak_deg(grid, place, {0.1 + 0.166 * i, 0.15 + 0.082 * i, -0.5 + 0.186 * i});
    }
  return sum / count;
}

TEST(ExactGrid, PutsTheLikelihoodPeakAtTheTrueHeadingWhereTheStockGridTurnsItByHalfAStep) {
  // The squeeze grows from 0 at the first ray to a whole step at the last: half a step on average, somewhat
  // more or less by where the walls are. The standard error of these means is 0.01 degrees.
  EXPECT_NEAR(headingBias_deg<COccupancyGridMap2D>(), -0.5 * kStep_deg, 0.1 * kStep_deg);
  EXPECT_NEAR(headingBias_deg<ExactGrid>(), 0, 0.03 * kStep_deg);
}

TEST(ExactGrid, IsUnbiasedForScansFromLeftToRightToo) {
  EXPECT_NEAR(headingBias_deg<COccupancyGridMap2D>(false), 0.5 * kStep_deg, 0.1 * kStep_deg);
  EXPECT_NEAR(headingBias_deg<ExactGrid>(false), 0, 0.03 * kStep_deg);
}

TEST(ExactGrid, PutsTheLastRayWhereTheScanSaysItGoes) {
  // Three rays at -45, 0 and 45 degrees; the only return is the last, at (2, 2).
  mrpt::obs::CObservation2DRangeScan scan;
  scan.aperture = static_cast<float>(core::degToRad(90));
  scan.maxRange = 10;
  scan.resizeScan(3);
  for (size_t i = 0; i < 3; ++i) scan.setScanRange(i, 0), scan.setScanRangeValidity(i, false);
  scan.setScanRange(2, static_cast<float>(std::sqrt(8.0))), scan.setScanRangeValidity(2, true);
  ExactGrid exact(-4.05F, 4.05F, -4.05F, 4.05F, 0.1F);
  COccupancyGridMap2D stock(-4.05F, 4.05F, -4.05F, 4.05F, 0.1F);
  exact.insertObservation(scan);
  stock.insertObservation(scan);
  EXPECT_LT(exact.getPos(2.0F, 2.0F), 0.5F);
  EXPECT_GT(exact.getPos(1.0F, 1.0F), 0.5F);
  EXPECT_EQ(stock.getPos(2.0F, 2.0F), 0.5F) << "the stock grid is no longer biased: is this class needed?";
}

TEST(ExactGrid, IsMadeOnceFromAnIniWithAllTheOptionsOfTheStockGrid) {
  registerMaps();
  const mrpt::config::CConfigFileMemory ini(std::string(
      "[M]\nunbiasedGridMap_count = 1\n"
      "[M_unbiasedGridMap_00_creationOpts]\nmin_x = -3\nmax_x = 4\nmin_y = -5\nmax_y = 6\nresolution = 0.25\n"
      "enableObservationLikelihood = false\n"
      "[M_unbiasedGridMap_00_insertOpts]\nmaxOccupancyUpdateCertainty = 0.7\nmaxDistanceInsertion = 12\n"
      "[M_unbiasedGridMap_00_likelihoodOpts]\nenableLikelihoodCache = false\nLF_stdHit = 0.11\n"
      "likelihoodMethod = lmConsensus\n"));
  mrpt::maps::TSetOfMetricMapInitializers definitions;
  definitions.loadFromConfigFile(ini, "M");
  mrpt::maps::CMultiMetricMap maps;
  maps.setListOfMaps(definitions);
  ASSERT_EQ(maps.maps.size(), 1U);
  const auto grid = maps.mapByClass<ExactGrid>();
  ASSERT_TRUE(grid);
  EXPECT_TRUE(maps.mapByClass<COccupancyGridMap2D>());
  EXPECT_FLOAT_EQ(grid->getXMin(), -3);
  EXPECT_FLOAT_EQ(grid->getYMax(), 6);
  EXPECT_FLOAT_EQ(grid->getResolution(), 0.25);
  EXPECT_FALSE(grid->genericMapParams.enableObservationLikelihood);
  EXPECT_FLOAT_EQ(grid->insertionOptions.maxOccupancyUpdateCertainty, 0.7F);
  EXPECT_FLOAT_EQ(grid->insertionOptions.maxDistanceInsertion, 12);
  EXPECT_FALSE(grid->likelihoodOptions.enableLikelihoodCache);
  EXPECT_FLOAT_EQ(grid->likelihoodOptions.LF_stdHit, 0.11F);
  EXPECT_EQ(grid->likelihoodOptions.likelihoodMethod, COccupancyGridMap2D::lmConsensus);
}

TEST(ExactGrid, SurvivesAFileAndACopy) {
  registerMaps();
  ExactGrid grid(-4, 7, -4, 4, 0.1F);
  grid.likelihoodOptions.LF_stdHit = 0.123F;
  grid.insertObservation(mrptScan({}));
  mrpt::io::CMemoryStream file;
  auto archive = mrpt::serialization::archiveFrom(file);
  archive << grid;
  file.Seek(0);
  const auto read = std::dynamic_pointer_cast<ExactGrid>(archive.ReadObject());
  ASSERT_TRUE(read);
  EXPECT_EQ(read->getRawMap(), grid.getRawMap());
  EXPECT_FLOAT_EQ(read->likelihoodOptions.LF_stdHit, 0.123F);
  const auto copy = std::dynamic_pointer_cast<ExactGrid>(grid.duplicateGetSmartPtr());
  ASSERT_TRUE(copy);
  EXPECT_EQ(copy->getRawMap(), grid.getRawMap());
  copy->fill(0.5F);
  EXPECT_NE(copy->getRawMap(), grid.getRawMap());
}

// The stock grid cleared 17.5 m (half of its limit) for an 8 m lidar, and as much through a wall for a lost
// reading.
TEST(ExactGrid, ClearsNoReturnsAsFarAsTheLidarSeesAndNothingForLostReadings) {
  lidar::Scan scan;
  scan.time_s = 1.6e9;
  scan.first_angle_rad = -core::kPi / 2;
  scan.step_rad = core::kPi / 180;
  scan.max_range_m = 8;
  scan.ranges_m.assign(181, lidar::kNoReturn);
  std::fill_n(scan.ranges_m.begin(), 60, lidar::kLostReading);  // the right third
  std::fill_n(scan.ranges_m.begin() + 121, 60, 3.0F);           // the left third: a wall
  ExactGrid grid(-20, 20, -20, 20, 0.1F);
  grid.insertionOptions.maxDistanceInsertion = 15;
  grid.insertionOptions.considerInvalidRangesAsFreeSpace = true;
  grid.insertObservation(*lidar::toMrpt(scan));
  const auto at = [&](double range_m, double angle_deg) {
    const double a = core::degToRad(angle_deg);
    return grid.getPos(static_cast<float>(range_m * std::cos(a)), static_cast<float>(range_m * std::sin(a)));
  };
  const float unknown = grid.getPos(-10, 0);
  EXPECT_GT(at(7.8, 0.5), 0.6F);  // MRPT's grid holds the probability of being free
  EXPECT_EQ(at(8.2, 0.5), unknown);
  EXPECT_EQ(at(2.0, -60.5), unknown);
  EXPECT_GT(at(2.0, 60.5), 0.6F);
  // The ray ends on a cell's border or not: the wall is in one of the cells around its end.
  EXPECT_LT(std::min({at(2.95, 60), at(3.0, 60), at(3.05, 60)}), 0.4F);
  EXPECT_EQ(at(3.5, 60.5), unknown);
  // The user's options are his again, and with the option off a ray without return says nothing.
  EXPECT_EQ(grid.insertionOptions.maxDistanceInsertion, 15);
  EXPECT_TRUE(grid.insertionOptions.considerInvalidRangesAsFreeSpace);
  ExactGrid careful(-20, 20, -20, 20, 0.1F);
  careful.insertionOptions.considerInvalidRangesAsFreeSpace = false;
  careful.insertObservation(*lidar::toMrpt(scan));
  EXPECT_EQ(careful.getPos(4, 0), careful.getPos(-10, 0));
}

}  // namespace
}  // namespace slam::builders

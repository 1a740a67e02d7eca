#include "libslam/mapping/exact_grid.h"

#include <gtest/gtest.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/maps/CMultiMetricMap.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/serialization/CArchive.h>

#include "libslam/mapping/map_builder.h"
#include "libslam/robot/mrpt_types.h"
#include "tests/mapping/small_room.h"

namespace slam::mapping {
namespace {

using mrpt::maps::COccupancyGridMap2D;

constexpr double kStep_deg = 1;  // 181 beams over 180 degrees

mrpt::obs::CObservation2DRangeScan mrptScan(const core::Pose2& T_room_robot, bool right_to_left) {
  auto scan = *robot::toMrpt(test::scanRoom(T_room_robot, 1.6e9));
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

/// The heading, in degrees off the true one, at which the likelihood of a scan is highest.
double likelihoodPeak_deg(const COccupancyGridMap2D& grid, const core::Pose2& T_room_robot,
                          bool right_to_left) {
  const auto scan = mrptScan(T_room_robot, right_to_left);
  std::vector<std::pair<double, double>> curve;
  double best = -1e300;
  for (int i = -150; i <= 150; ++i) {
    const double offset_deg = 0.02 * i;
    const mrpt::poses::CPose3D pose(T_room_robot.x, T_room_robot.y, 0,
                                    T_room_robot.phi + core::degToRad(offset_deg), 0, 0);
    curve.emplace_back(offset_deg, grid.computeObservationLikelihood(scan, pose));
    best = std::max(best, curve.back().second);
  }
  // The centre of mass of the likelihood is steadier than its highest sample, which cells quantise.
  double weight = 0, sum = 0;
  for (const auto& [offset_deg, log_likelihood] : curve) {
    const double w = std::exp(log_likelihood - best);
    weight += w, sum += w * offset_deg;
  }
  return sum / weight;
}

/// By how many degrees scans are matched off their true heading, on average, in a grid that holds scans from
/// around the same places at their true poses.
double headingBias_deg(COccupancyGridMap2D& grid, bool right_to_left = true) {
  grid.insertionOptions.maxDistanceInsertion = 30;
  grid.likelihoodOptions.LF_decimation = 1;
  grid.likelihoodOptions.LF_stdHit = 0.1F;
  for (int i = 0; i < 40; ++i) {
    const core::Pose2 pose{0.031 * i, 0.1 + 0.017 * i, -0.6 + 0.0307 * i};
    grid.insertObservation(mrptScan(pose, right_to_left),
                           mrpt::poses::CPose3D(pose.x, pose.y, 0, pose.phi, 0, 0));
  }
  double sum = 0;
  const int places = 12;
  for (int i = 0; i < places; ++i)
    sum += likelihoodPeak_deg(grid, {0.1 + 0.083 * i, 0.15 + 0.041 * i, -0.5 + 0.093 * i}, right_to_left);
  return sum / places;
}

/// No wall on a line between cells, where the last bit of a range would choose the cell.
template <class Grid>
Grid makeGrid() {
  return Grid(-5.017F, 8.0F, -5.023F, 5.0F, 0.05F);
}

TEST(ExactGrid, PutsTheLikelihoodPeakAtTheTrueHeadingWhereTheStockGridTurnsItByAboutHalfAStep) {
  auto stock = makeGrid<COccupancyGridMap2D>();
  auto exact = makeGrid<ExactGrid>();
  const double stock_deg = headingBias_deg(stock), exact_deg = headingBias_deg(exact);
  RecordProperty("stock_bias_deg", std::to_string(stock_deg));
  RecordProperty("exact_bias_deg", std::to_string(exact_deg));
  // The squeeze grows from 0 at the first ray to a whole step at the last: half a step on average, a little
  // more or less by where the walls are. Cells of 0.05 m at about 3 m leave some hundredths of a degree.
  EXPECT_NEAR(stock_deg, -0.5 * kStep_deg, 0.2 * kStep_deg);
  EXPECT_NEAR(exact_deg, 0, 0.1 * kStep_deg);
}

TEST(ExactGrid, IsUnbiasedForScansFromLeftToRightToo) {
  auto stock = makeGrid<COccupancyGridMap2D>();
  auto exact = makeGrid<ExactGrid>();
  EXPECT_NEAR(headingBias_deg(stock, false), 0.5 * kStep_deg, 0.2 * kStep_deg);
  EXPECT_NEAR(headingBias_deg(exact, false), 0, 0.1 * kStep_deg);
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
  grid.insertObservation(mrptScan({}, true));
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

}  // namespace
}  // namespace slam::mapping

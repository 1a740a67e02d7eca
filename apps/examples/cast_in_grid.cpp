// Exact ray casting in MRPT's occupancy grid: cast_in_grid [MAP.gridmap.gz]
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/serialization/CArchive.h>

#include <cstdio>

#include "libslam/mrptworld/grid_caster.h"

int main(int argc, char** argv) try {
  mrpt::maps::COccupancyGridMap2D grid(-5, 5, -5, 5, 0.05F);
  if (argc > 1) {
    mrpt::io::CFileGZInputStream file(argv[1]);
    mrpt::serialization::archiveFrom(file) >> grid;
  } else {  // a free field with a wall 2 m ahead
    grid.fill(0.9F);
    for (int y = 0; y < static_cast<int>(grid.getSizeY()); ++y) grid.setCell(grid.x2idx(2.0F), y, 0);
  }
  // Where laserScanSimulator() of the grid itself steps along each ray, this one finds the wall's face.
  const slam::mrptworld::GridCaster caster(grid);
  mrpt::obs::CObservation2DRangeScan scan;
  scan.aperture = static_cast<float>(M_PI);
  scan.maxRange = 20;
  scan.rightToLeft = true;
  caster.laserScanSimulator(scan, mrpt::poses::CPose2D(0, 0, 0), /*N=*/181);
  int returns = 0;
  for (size_t ray = 0; ray < scan.getScanSize(); ++ray) returns += scan.getScanRangeValidity(ray) ? 1 : 0;
  std::printf("%d of %zu rays meet a wall; straight ahead %.3f m\n", returns, scan.getScanSize(),
              scan.getScanRange(90));
} catch (const std::exception& error) {
  std::fprintf(stderr, "cast_in_grid: %s\n", error.what());
  return 1;
}

#pragma once
#include <opencv2/core.hpp>
#include <vector>

namespace slam::drafting {

/// A way that is clearly narrower than the spaces it joins: a door, for what a raster shows.
struct Passage {
  cv::Point at;
  double width = 0;  ///< cells
};

struct Passages {
  std::vector<Passage> passages;  ///< widest first; of two ways between the same spaces only the wider
  int rooms = 0;                  ///< spaces of at least `least_area` between them
};

/// Free space taken apart at its passages. A side counts as a space when it is `least_area` large and its
/// clearance half as much again as the passage's. Large rasters are looked at with every second cell, or
/// fewer.
Passages findPassages(const cv::Mat& free, double least_area);

/// Width of a gap of `clearance`: n free cells have their middle (n + 1) / 2 from the walls.
inline double widthOfGap(double clearance) {
  return 2 * clearance - 0.75;  // between an odd and an even n
}

}  // namespace slam::drafting

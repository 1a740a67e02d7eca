#pragma once
#include <opencv2/core.hpp>
#include <vector>

namespace slam::drafting {

/// A door as architects draw it: a leaf that stands open and the quarter circle that its edge sweeps.
struct DoorArc {
  cv::Point2d hinge;                     ///< pixels
  double radius = 0;                     ///< length of the leaf, pixels
  double leaf_rad = 0, opening_rad = 0;  ///< from the hinge, x right and y down; a right angle apart
};

/// All quarter circles whose one end is joined to their centre by a line, the leaf, and whose other lies on
/// the far side of a doorway. Centres are voted for along the normals of thin lines (Ballard, "Generalizing
/// the Hough transform to detect arbitrary shapes", Pattern Recognition 13(2), 1981), radius by radius, and
/// each candidate is then held against the ink. Radii from 11 pixels to a fifth of the picture.
std::vector<DoorArc> findDoorArcs(const cv::Mat& ink);

/// Adds those of `more`, a less sure list, that are none of `doors` and about as large as all usually are.
void addDoorArcs(std::vector<DoorArc>& doors, const std::vector<DoorArc>& more);

/// The radius that most others are within 15 % of, of equals the largest; their median. 0 without doors.
double usualRadius(const std::vector<DoorArc>& doors);

}  // namespace slam::drafting

#pragma once
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::draw {

/// The points of a line that draw the same to within `tolerance_m`: the ends, and between two that are kept
/// none lies farther from the straight piece between them (Douglas and Peucker, Cartographica 10(2), 1973).
/// From the piece, not from the line through its ends: a path that goes on and comes back keeps its turn.
/// REQUIRES finite points. Cost: n log n for paths, n squared at worst.
std::vector<core::Point2> fewerPoints(const std::vector<core::Point2>& points, double tolerance_m);

/// The pieces between points that are not finite, each with fewerPoints().
std::vector<std::vector<core::Point2>> outline(const std::vector<core::Point2>& points, double tolerance_m);

}  // namespace slam::draw

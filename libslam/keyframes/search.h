#pragma once
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/scanmatch/scan_points.h"
#include "libslam/scanmatch/surfel_matcher.h"

namespace slam::keyframes {

/// The raster of searches by branch and bound, and its surfaces' width.
inline constexpr double kSearchCell_m = 0.1, kSearchSigma_m = 0.12;
inline constexpr int kSearchLevels = 6;
inline constexpr double kQuerySpacing_m = 0.4, kQueryMatchSpacing_m = 0.1;
/// The old map around a place: within this path and radius of a keyframe.
inline constexpr double kPlacePath_m = 15, kPlaceRadius_m = 10;
/// The scan of a keyframe that was known before: journal entries refer to none then.
inline constexpr int kOfEarlierRun = -1;
/// Places that are looked at one by one: headings, one after the other, so that no scan waits long; how far
/// apart they are, half the window of positions, and which points are asked.
inline constexpr int kHeadings = 6;
inline constexpr double kHeadingStep_rad = 2 * core::kPi / kHeadings;
inline constexpr double kPlaceStep_m = 4, kPlaceHalf_m = 5, kPlaceReach_m = 12;
/// The local map reaches this far from the robot.
inline constexpr double kMapReach_m = 30;
/// Multiplications in one of loop_work.
inline constexpr double kWorkPerUnit = 1e6;
/// What being kidnapped counts as driven.
inline constexpr double kGapPath_m = 1000;
/// Of the newest path, at most so many are searched for together.
inline constexpr int kMostQueryKeyframes = 30;
/// Old keyframes whose view of the new points is asked, and how near they are.
inline constexpr int kViewers = 6;
inline constexpr double kViewerDistance_m = 4;

/// Keyframes see the same as one that lies within so many of their distances.
inline constexpr double kNearby = 2;
/// Two views of one surface both err.
inline constexpr double kBothViews = 2;
/// A place that is followed may be corrected by this much from keyframe to keyframe, and fail so often.
inline constexpr double kConfirmStep_m = 0.3, kConfirmTurn_rad = 0.06;
inline constexpr int kMostFailures = 2;
/// Edges that one match makes.
inline constexpr int kConfirmEdges = 4;

/// What a scan says for a place, in nats, when all of it is explained and nothing contradicted; neighbouring
/// beams err together, so that a scan stands for some ten independent points.
inline constexpr double kNatsPerScan = 10;
/// What is contradicted says more than what is explained: ln(0.3 / 0.04) to ln(0.9 / 0.55), of how often a
/// point is either at a wrong place and at the right one, where some furniture was moved.
inline constexpr double kContradicted = 4;
/// The best place of a part must be ahead of every other by so much: one wrong join in a million.
inline constexpr double kAhead = 14;
/// A scan of which a map says less than this share says nothing of where it lies there.
inline constexpr double kToldToJoin = 0.3;
/// Keyframes that make the map that a keyframe of another part is matched to.
inline constexpr int kJoinKeyframes = 16;

/// The share of what a place explains that no other may reach when what was followed fits it over such an
/// extent.
double twinShare(double fits_m);

/// Where the next keyframe of what is followed is expected, weakly; and whether a match is near enough to
/// that.
scanmatch::PosePrior followedTo(const core::Pose2& T_map_robot);
bool isFollowed(const core::Pose2& T_map_matched, const core::Pose2& T_map_expected);

/// One point per square of this side, in the order they come.
std::vector<scanmatch::PatchPoint> thinned(const std::vector<scanmatch::PatchPoint>& points, double side_m);

/// What a search asks: one point per kQuerySpacing_m, at most so many, evenly of all.
std::vector<core::Point2> searchPoints(const std::vector<scanmatch::PatchPoint>& points, size_t most);

}  // namespace slam::keyframes

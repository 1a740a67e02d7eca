#pragma once
#include <vector>

#include "libslam/keyframes/types.h"
#include "libslam/lidar/scan.h"
#include "libslam/scanmatch/information.h"

/// How scans are matched to the surfels of keyframes. For the rooms of graph SLAM only.
namespace slam::keyframes {

/// In standard deviations of a surfel: farther points hardly count.
inline constexpr double kKernel = 3;
/// Poses are compared on every third point.
inline constexpr int kStride = 3;
/// Keyframes that are asked what of a scan they should have seen.
inline constexpr int kAskedViewers = 4;

scanmatch::MatchOptions matchOptions(int max_iterations);
std::vector<scanmatch::PatchPoint> pointsOf(const lidar::Scan& scan, const GraphOptions& options);
/// (0, 0) without points.
core::Point2 centreOf(const std::vector<scanmatch::PatchPoint>& points);
/// From coarse to fine.
scanmatch::MatchResult match(const std::vector<scanmatch::PatchPoint>& points, const LevelMaps& maps,
                             const core::Pose2& T_start, const scanmatch::PosePrior& prior,
                             double prior_kernel, bool with_coarse);
/// What a scan tells of its pose in a map, over (x, y, phi), map frame.
Eigen::Matrix3d toldInformation(const scanmatch::MatchEvidence& evidence);
/// The same where it was matched.
Eigen::Matrix3d toldInformation(const std::vector<scanmatch::PatchPoint>& points,
                                const scanmatch::SurfelMap& map, const core::Pose2& T_map_robot);
/// By how much a match explains more than the same moved along the direction of movement that it holds least:
/// what makes the place unlike its neighbours along a corridor.
double distinctness(const std::vector<scanmatch::PatchPoint>& points, const LevelMaps& maps,
                    const scanmatch::MatchResult& matched);
std::vector<int> firstOf(std::vector<int> keyframes, int most);

/// What a scan says of points that T_viewer_points takes to its robot; of every `stride`-th.
View view(const lidar::Scan& scan, const core::Pose2& T_viewer_points,
          const std::vector<scanmatch::PatchPoint>& points, size_t stride = 1);

/// The share of what a scan looks at that another one from nearby looks at, too: of directions.
double sharedView(const lidar::Scan& scan, const core::Pose2& T_map_robot, const lidar::Scan& other,
                  const core::Pose2& T_map_other);

/// How the error of a pose at `from` shows in one that is firmly joined to it and lies at `to`; map frame.
Eigen::Matrix3d moved(const core::Point2& from, const core::Point2& to);
/// Of a covariance's eigenvalues, against the largest: below, they are rounding.
inline constexpr double kLeastShare = 1e-15;

}  // namespace slam::keyframes

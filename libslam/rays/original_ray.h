#pragma once
#include "libslam/core/pose2.h"
#include "libslam/world/plan.h"

namespace slam::rays {

/// The ray of the original raster lidar, where castRay() is exact. From the pixel that holds the origin the
/// ray is walked one pixel at a time along its longer axis; the other coordinate is rounded to the nearest
/// pixel (a half away from the origin). The range is the Euclidean distance from that pixel's centre to the
/// centre of the first obstacle pixel, rounded to whole pixels; here in metres.
///
/// What follows from it. Where the origin lies in its pixel does not matter: a robot that moves by less sees
/// no change. The walk steps over the corner where two pixels touch, so it can slip through a wall that is
/// one pixel thin and runs aslant. It measures to the middle of the pixel and not to its face: against a wall
/// across the longer axis that is 0.5 / max(|cos|, |sin|) pixels more than exact from the pixel's centre,
/// 0.56 pixels on average over the directions. Measured in the five committed worlds from 300 random places
/// in free space each, 360 rays from a place: longer than castRay()'s by 0.54 pixels in the median, and by
/// 0.53 on average over the 96 % of rays that differ by at most 2 pixels; the others pass an edge that the
/// exact ray meets, or the other way round, and bring the average of all to 0.96.
///
/// As the original document has it there is no end where no obstacle is; here nothing met before the plan's
/// edge or up to max_range_m is +infinity, max_range_m <= 0 means no limit, unknown cells are transparent,
/// and the answer is 0 in an occupied cell and +infinity for a pose outside the plan or not finite, as for
/// castRay(). How the document makes a whole number of the distance it does not say; we round.
double castOriginalRay(const world::Plan& plan, const core::Point2& origin_world, double angle_rad,
                       double max_range_m);

}  // namespace slam::rays

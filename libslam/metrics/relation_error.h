#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::metrics {

/// Over the relations that could be scored; NaN without any.
struct RelationStatistics {
  double mean, deviation;                ///< of the errors; the deviation is that of the sample (n - 1)
  double mean_square, square_deviation;  ///< of their squares
  double median, max;
};

/// Error of a trajectory against relations (Kümmerle et al., Autonomous Robots 27(4), 2009): for each
/// relation E = T_from_to^-1 (x_from^-1 x_to) with x the estimate; its translational error is the length of
/// E's translation, its rotational error |angle of E|. No alignment, and a distortion far away costs nothing
/// here.
///
/// The pose at a relation's stamp is that of the estimate's pose with the same stamp (to 1 microsecond, the
/// benchmark's resolution; of several the first). Where there is none it is interpolated between the
/// neighbouring stamps, and counted; outside the estimate's time span the relation is not scored, and
/// counted. Stamps may be in any order.
struct RelationError {
  RelationStatistics translation_m, rotation_rad;
  std::size_t scored = 0;
  std::size_t interpolated = 0;  ///< of these, how many with a pose between two stamps
  std::size_t unmatched = 0;     ///< not scored
  struct Scored {
    std::size_t index;  ///< into the relations
    double translation_m, rotation_rad;
    core::Pose2 T_from_to;  ///< as the estimate has it
  };
  std::vector<Scored> worst;  ///< by translation, of equals the first
};
RelationError relationError(const core::Relations& relations, const core::Trajectory& estimate,
                            std::size_t worst = 5);

/// What relations err by themselves, without any path: three of them that join three stamps lead round to
/// where they began, but for their errors. Taken as independent and of one size, along x, along y and in
/// turning, such a triangle's gap has three times a relation's variance; a turn's error that shows as a gap
/// at the end of a long relation counts as one along x and y.
struct AnnotationError {
  double sigma_xy_m, sigma_turn_rad;  ///< of one relation
  std::size_t triangles;
};
/// Of relations with the same two stamps (to 1 microsecond) the first counts. Nothing with fewer than 30
/// triangles.
std::optional<AnnotationError> annotationError(const core::Relations& relations);

/// Relations that a truth gives: from each pose to the next one at least `step_m` of path away, and to the
/// nearest earlier pose within `near_m` that is more than `apart_s` before it (a place seen again), where
/// there is one. Stamps must not run back. REQUIRES step_m > 0.
core::Relations relationsOf(const core::Trajectory& truth, double step_m, double near_m, double apart_s);

}  // namespace slam::metrics

#pragma once
#include <vector>

#include "libslam/posegraph/pose_graph.h"

namespace slam::certified {

/// Poses, in the map's frame, to start a descent from that owe nothing to the graph's own poses but where its
/// fixed nodes are: first all headings at once, as complex numbers whose lengths are free (least squares of
/// chords, linear), then all positions given these headings (linear too). Rotation-first or chordal
/// initialisation: Martinec and Pajdla, CVPR 2007; Carlone et al., "Initialization techniques for 3D SLAM",
/// ICRA 2015. Where a descent from chained odometry ends in a wrong minimum, from here it hardly does.
///
/// Only edges that are on count; what an edge's information couples between heading and position is left out.
/// A node whose heading the edges do not tell gets that of the map. Deterministic. Cost: two factorisations.
/// Errors: InputError as optimize().
std::vector<core::Pose2> relaxedPoses(const posegraph::PoseGraph& graph);

}  // namespace slam::certified

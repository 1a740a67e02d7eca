#pragma once
#include "libslam/posegraph/pose_graph.h"

namespace slam::certified {

/// What is proved about how low the chi2 of a graph's edges that are on can be, whatever the poses.
struct Certificate {
  double chi2 = 0;         ///< at the poses that were asked about
  double lower_bound = 0;  ///< no poses have less; 0 when nothing is proved
  /// chi2 - lower_bound is at most kCertified of 1 + chi2.
  bool is_optimal = false;
};
/// One in a million: of no meaning beside a chi2's standard deviation, well above rounding.
inline constexpr double kCertified = 1e-6;

/// Asks whether the graph's poses have the least chi2 that any poses have. REQUIRES poses where a descent
/// ended: at others the bound is worth little.
///
/// With headings as complex numbers of length 1, a quadratic form q in headings and positions is found that
/// is chi2 at these poses and below it everywhere else; and its Lagrangian with the multipliers of these
/// poses, which bounds q from below when it is positive semidefinite, as its Cholesky factor says. That is
/// the dual of the relaxation of Carlone et al. ("Lagrangian duality in 3D SLAM", IROS 2015) and Rosen et al.
/// ("SE-Sync", IJRR 2019). Theirs takes errors of heading as chords and positions that are equally sure along
/// all directions. Ours bounds chi2 itself, edge by edge:
///   w theta^2 >= w (theta*^2 - 2 b (1 - cos theta*) + 2 b (1 - cos theta)),   b = theta* / sin theta*,
/// with equality at the edge's own theta*, as sin(x) / x falls on [0, pi]; and where information D is left
/// above diag(s, s, w), e' D e >= 2 e*' D e - e*' D e*, which bends the less the more unlike the axes of the
/// information are. So a graph may be at its optimum and yet not be certified: that happens when errors are
/// large.
///
/// An edge of singular information adds its tangent alone; where that pulls at a heading, nothing is proved.
/// Fixed nodes and priors hold the map's frame. Deterministic. Cost: one to a few factorisations of a complex
/// matrix of twice as many rows as there are nodes. Errors: InputError as optimize().
Certificate certify(const posegraph::PoseGraph& graph);

}  // namespace slam::certified

#pragma once
#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "libslam/core/journal.h"
#include "libslam/core/pose2.h"

namespace slam::results {

/// How sure a method is of one of its final poses as another one sees it: of x (m), y (m), phi (rad) of the
/// second in the first one's frame.
struct RelativeCovariance {
  enum class Kind { kMetre, kTenMetres, kLoop, kRelation };
  Kind kind;
  double first_s, second_s;  ///< stamps of the poses
  Eigen::Matrix3d covariance;
};

inline constexpr std::size_t kMostPairs = 500;
/// Pairs of a path's poses, by index, of which a method is asked: one and ten metres of path apart, from
/// every pose that begins another metre (or ten); and the two ends of every loop that the journal says was
/// accepted. Where there are more than kMostPairs of a kind, as many, evenly spread.
std::vector<std::pair<int, int>> pairsApart(const core::Trajectory& path, double apart_m);
std::vector<std::pair<int, int>> loopEnds(const std::vector<core::JournalEntry>& journal, std::size_t poses);

/// The poses of every relation, where the path has both stamps (to 1 microsecond; of several the first).
std::vector<std::pair<int, int>> pairsOf(const core::Relations& relations, const core::Trajectory& path);

/// A file "kind,first_s,second_s,xx,xy,xphi,yy,yphi,phiphi", kind 1m, 10m, loop
/// or relation. Errors: IoError;
/// InputError with file and line for what is no such row, and for a file that ends amid a line.
void writeRelativeCovariances(const std::vector<RelativeCovariance>& covariances, const std::string& path);
std::vector<RelativeCovariance> readRelativeCovariances(const std::string& path);

/// NEES (stats::normalizedErrorSquared()) of each pair of a kind: the estimate's second pose as its first
/// sees it against the truth's. A covariance that is not positive definite: infinite. Left out: pairs of
/// which a stamp has no pose in the estimate or no truth. No alignment.
std::vector<double> relativeNees(const core::Trajectory& truth, const core::Trajectory& estimate,
                                 const std::vector<RelativeCovariance>& covariances,
                                 RelativeCovariance::Kind kind);
/// The same of the relations that have a covariance (of kind kRelation), against what they say. With a
/// covariance of zero for a relation itself what its annotation errs by counts as the method's error.
std::vector<double> relationNees(const core::Relations& relations, const core::Trajectory& estimate,
                                 const std::vector<RelativeCovariance>& covariances,
                                 const Eigen::Matrix3d& of_relation = Eigen::Matrix3d::Zero());

}  // namespace slam::results

#include <utility>

#include "libslam/graph/surface_bundle.h"
#include "libslam/scanmatch/information.h"
#include "libslam/sparse/block_cholesky.h"

/// The equations of a SurfaceBundle, and their solution.
namespace slam::graph {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Information by which a keyframe is held where surfaces tell nothing of it, 1/m^2 and 1/rad^2.
constexpr double kHeld = 1;
constexpr double kFixed = 1e12;
constexpr int kMostIterations = 500;
constexpr double kSolved = 1e-4;  ///< of the right side

double dot(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

}  // namespace

void SurfaceBundle::hold(Vectors& v) const {
  for (const int k : held_) of(v, k).setZero();
}

/// Of each keyframe, as if all others stood.
std::vector<Matrix3d> SurfaceBundle::toldBySurfaces() const {
  std::vector<Matrix3d> told(static_cast<std::size_t>(map_.size()), kHeld * Matrix3d::Identity());
  for (const Seen& seen : seen_) {
    const Vector3d J(seen.x, seen.y, seen.phi);
    Matrix3d& of_keyframe = told[static_cast<std::size_t>(seen.keyframe)];
    of_keyframe += static_cast<double>(seen.weight) * J * J.transpose();
    of_keyframe(2, 2) += static_cast<double>(seen.weight) * seen.spread2;
  }
  return told;
}

SurfaceBundle::Vectors SurfaceBundle::rightSide() const {
  Vectors b(static_cast<std::size_t>(map_.size()), Vector3d::Zero());
  for (const Seen& seen : seen_) of(b, seen.keyframe) -= pullOf(seen, {seen.off_m, seen.slope});
  for (const Tie& tie : ties_) {
    if (!tie.is_measured) continue;
    const Vector3d pull = tie.information * tie.off;
    of(b, tie.to) -= pull;
    of(b, tie.from) += tie.J.transpose() * pull;
  }
  hold(b);
  return b;
}

void SurfaceBundle::addSurfacesTimes(const Vectors& v, Vectors& result) const {
  const auto moved = [&](const Seen& seen) {
    const Vector3d& pose = of(v, seen.keyframe);
    return Line{seen.x * pose.x() + seen.y * pose.y() + seen.phi * pose.z(), pose.z()};
  };
  for (const Surface& surface : surfaces_) {
    const Line common = lineOf(surface, moved);
    for (std::size_t i = surface.begin; i < surface.end; ++i) {
      const Seen& seen = seen_[i];
      const Line line = moved(seen);
      of(result, seen.keyframe) +=
          pullOf(seen, {line.off_m - common.off_m - common.slope * seen.along_m, line.slope - common.slope});
    }
  }
}

/// On a keyframe's pose, of points that are off so much.
Vector3d SurfaceBundle::pullOf(const Seen& seen, const Line& off) {
  const double across = seen.weight * off.off_m;
  return {across * seen.x, across * seen.y, across * seen.phi + seen.weight * seen.spread2 * off.slope};
}

void SurfaceBundle::addTiesTimes(const Vectors& v, Vectors& result) const {
  for (const Tie& tie : ties_) {
    if (!tie.is_measured) continue;
    const Vector3d pull = tie.information * (of(v, tie.to) - tie.J * of(v, tie.from));
    of(result, tie.to) += pull;
    of(result, tie.from) -= tie.J.transpose() * pull;
  }
}

std::vector<Vector3d> SurfaceBundle::step() const {
  std::vector<std::pair<int, int>> blocks;
  blocks.reserve(ties_.size());
  for (const Tie& tie : ties_) blocks.emplace_back(tie.to, tie.from);
  sparse::BlockCholesky about;
  about.analyse(map_.size(), blocks);
  about.setZero();
  for (const int k : held_) about.addDiagonal(k, kFixed * Matrix3d::Identity());
  for (std::size_t i = 0; i < ties_.size(); ++i) {
    const Tie& tie = ties_[i];
    const Matrix3d told = tie.information * tie.J;
    about.addDiagonal(tie.to, tie.information);
    about.addDiagonal(tie.from, tie.J.transpose() * told);
    about.addBlock(static_cast<int>(i), -told);
  }
  if (!about.factorizeRaised()) return {};
  const auto preconditioned = [&](Vectors v) {
    about.solve(v);
    hold(v);
    return v;
  };
  Vectors x(static_cast<std::size_t>(map_.size()), Vector3d::Zero()), Ap = x, left = rightSide(),
                                                                      z = preconditioned(left), p = z;
  double size2 = dot(left, z);
  const double enough = kSolved * kSolved * size2;
  for (int i = 0; i < kMostIterations && size2 > enough; ++i) {
    for (auto& one : Ap) one.setZero();
    addSurfacesTimes(p, Ap);
    addTiesTimes(p, Ap);
    hold(Ap);
    const double stiffness = dot(p, Ap);
    if (!(stiffness > 0)) break;
    const double far = size2 / stiffness;
    for (std::size_t k = 0; k < x.size(); ++k) x[k] += far * p[k], left[k] -= far * Ap[k];
    z = preconditioned(left);
    const double before = std::exchange(size2, dot(left, z));
    for (std::size_t k = 0; k < x.size(); ++k) p[k] = z[k] + size2 / before * p[k];
  }
  return x;
}

std::vector<Vector3d> SurfaceBundle::stepAround(const std::vector<Vector3d>& step) const {
  const auto told = toldBySurfaces();
  Vectors around(step.size(), Vector3d::Zero());
  addSurfacesTimes(step, around);
  // What moves a keyframe against all that lies around it is its own match's noise.
  for (std::size_t k = 0; k < step.size(); ++k)
    around[k] = step[k] - scanmatch::covarianceOf(told[k] + by_odometry_[k]) * around[k];
  return around;
}

}  // namespace slam::graph

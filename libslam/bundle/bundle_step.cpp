#include <algorithm>
#include <utility>

#include "libslam/bundle/surface_bundle.h"
#include "libslam/keyframes/matching.h"
#include "libslam/scanmatch/information.h"
#include "libslam/sparse/block_cholesky.h"

/// The equations of a SurfaceBundle, and their solution.
namespace slam::bundle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Information by which a keyframe is held where surfaces tell nothing of it, 1/m^2 and 1/rad^2.
constexpr double kHeld = 1;
constexpr double kFixed = 1e12;
constexpr int kMostIterations = 500;
constexpr double kSolved = 1e-2;  ///< of the right side: the next round does the rest

double dot(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

}  // namespace

void SurfaceBundle::hold(Vectors& v) const {
  for (const int k : held_) of(v, k).setZero();
}

/// What moves a pose about itself moves it so about the map's origin.
Matrix3d SurfaceBundle::aboutOrigin(int keyframe) const {
  const core::Pose2& T = map_.pose(keyframe);
  Matrix3d A = Matrix3d::Identity();
  A(0, 2) = T.y, A(1, 2) = -T.x;
  return A;
}

/// The error of a way's first keyframe, at the second.
Matrix3d SurfaceBundle::movedToEnd(const Tie& tie) const {
  return keyframes::moved(core::position(map_.pose(tie.from)), core::position(map_.pose(tie.to)));
}

SurfaceBundle::Vectors SurfaceBundle::toPoses(Vectors about_origin) const {
  for (int k = 0; k < map_.size(); ++k)
    of(about_origin, k) = aboutOrigin(k).transpose() * of(about_origin, k);
  return about_origin;
}

/// Of each keyframe, as if all others stood.
std::vector<Matrix3d> SurfaceBundle::toldBySurfaces() const {
  std::vector<Matrix3d> told(told_.size());
  for (int k = 0; k < map_.size(); ++k) {
    const auto& [xx, xy, yy, xz, yz, zz] = told_[static_cast<std::size_t>(k)];
    Matrix3d about_origin;
    about_origin << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    const Matrix3d A = aboutOrigin(k);
    told[static_cast<std::size_t>(k)] = kHeld * Matrix3d::Identity() + A.transpose() * about_origin * A;
  }
  return told;
}

SurfaceBundle::Vectors SurfaceBundle::rightSide() const {
  Vectors b = toPoses(pulls_);
  for (Vector3d& of_keyframe : b) of_keyframe = -of_keyframe;
  for (std::size_t i = 0; i < measured_; ++i) {
    const Tie& tie = ties_[i];
    const Vector3d pull = tie.information * tie.off;
    of(b, tie.to) -= pull;
    of(b, tie.from) += movedToEnd(tie).transpose() * pull;
  }
  hold(b);
  return b;
}

SurfaceBundle::Vectors SurfaceBundle::surfacesTimes(const Vectors& v) const {
  Vectors moved(v.size()), pulls(v.size(), Vector3d::Zero());
  for (int k = 0; k < map_.size(); ++k) of(moved, k) = aboutOrigin(k) * of(v, k);
  std::vector<Moved> lines;
  for (const Piece& piece : pieces_)
    for (const Surface& surface : piece.surfaces) {
      lines.resize(std::max(lines.size(), surface.end - surface.begin));
      pullBack(surface, &piece.seen[surface.begin], moved, lines.data(), pulls);
    }
  return toPoses(std::move(pulls));
}

/// To the line that fits best how keyframes were moved.
void SurfaceBundle::pullBack(const Surface& surface, const Seen* seen, const Vectors& moved, Moved* lines,
                             Vectors& pulls) {
  const double ax = surface.across.x(), ay = surface.across.y(), lever_m = surface.lever_m;
  const std::size_t count = surface.end - surface.begin;
  double common_m = 0, common_slope = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double weight = seen[i].weight, along_m = seen[i].along_m, hold = weight * seen[i].spread2;
    const Vector3d& by = of(moved, seen[i].keyframe);
    const double slope = by.z(), own_m = ax * by.x() + ay * by.y() + (lever_m + along_m) * slope;
    lines[i] = {own_m, slope, weight, along_m, hold};
    common_m += weight * own_m;
    common_slope += weight * along_m * own_m + hold * slope;
  }
  common_m *= surface.by_weight, common_slope *= surface.by_rotation;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [own_m, slope, weight, along_m, hold] = lines[i];
    const double pull = weight * (own_m - common_m - common_slope * along_m);
    Vector3d& pulled = of(pulls, seen[i].keyframe);
    pulled.x() += pull * ax, pulled.y() += pull * ay;
    pulled.z() += pull * (lever_m + along_m) + hold * (slope - common_slope);
  }
}

void SurfaceBundle::addTiesTimes(const Vectors& v, Vectors& result) const {
  for (std::size_t i = 0; i < measured_; ++i) {
    const Tie& tie = ties_[i];
    const Matrix3d J = movedToEnd(tie);
    const Vector3d pull = tie.information * (of(v, tie.to) - J * of(v, tie.from));
    of(result, tie.to) += pull;
    of(result, tie.from) -= J.transpose() * pull;
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
    const Matrix3d J = movedToEnd(tie), told = tie.information * J;
    about.addDiagonal(tie.to, tie.information);
    about.addDiagonal(tie.from, J.transpose() * told);
    about.addBlock(static_cast<int>(i), -told);
  }
  if (!about.factorizeRaised()) return {};
  const auto preconditioned = [&](Vectors v) {
    about.solve(v);
    hold(v);
    return v;
  };
  Vectors x(static_cast<std::size_t>(map_.size()), Vector3d::Zero()), left = rightSide(),
                                                                      z = preconditioned(left), p = z;
  double size2 = dot(left, z);
  const double enough = kSolved * kSolved * size2;
  for (int i = 0; i < kMostIterations && size2 > enough; ++i) {
    often_();
    Vectors Ap = surfacesTimes(p);
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
  Vectors around = surfacesTimes(step);
  // What moves a keyframe against all that lies around it is its own match's noise.
  for (std::size_t k = 0; k < step.size(); ++k)
    around[k] = step[k] - scanmatch::covarianceOf(told[k] + by_odometry_[k]) * around[k];
  return around;
}

}  // namespace slam::bundle

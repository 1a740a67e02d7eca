#include "libslam/uncertainty/error_flow.h"

#include <cmath>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/keyframes/matching.h"
#include "libslam/posegraph/marginals.h"
#include "libslam/scanmatch/information.h"

namespace slam::uncertainty {
namespace {

using core::position;
using Eigen::Matrix3d;
using keyframes::Inheritance;
using keyframes::KeyframeMap;
using keyframes::kLeastShare;
using keyframes::LoopEdge;
using keyframes::moved;

/// What is new in a keyframe is at least this share of its largest direction, and so much (m^2, rad^2).
constexpr double kLeastOwnShare = 1e-9, kLeastOwn = 1e-12;

/// A root of the information: one times its transpose. The same surfaces give the same root, whatever
/// keyframe is matched to them.
Matrix3d rootOfInformation(const Matrix3d& information) {
  const double of_position = information.topLeftCorner<2, 2>().trace();
  if (!(of_position > 0)) return Matrix3d::Zero();
  const double length_m = std::sqrt(2 * information(2, 2) / of_position);
  if (!(length_m > 0)) return scanmatch::rootOf(information);
  // In equal units, so that the root does not mix them.
  const Matrix3d unit = Eigen::Vector3d(1, 1, 1 / length_m).asDiagonal(),
                 back = Eigen::Vector3d(1, 1, length_m).asDiagonal();
  return back * scanmatch::rootOf(unit * information * unit);
}

/// Of a match's noise what its points do not tell: see Inheritance::points_err.
Matrix3d beyondPoints(const Matrix3d& noise, double points_err) {
  return noise * (1 - 1 / (points_err * points_err));
}

}  // namespace

ErrorFlow::ErrorFlow(const KeyframeMap& map, Poses poses) : poses_(map.graph().poses()), found_(poses) {
  numberUnknowns(map);
  own_.assign(poses_.size(), Matrix3d::Zero());
  for (size_t k = 1; k < own_.size() && found_ == Poses::kFitted; ++k) {
    const auto& keyframe = map.keyframe(static_cast<int>(k));
    if (keyframe.inherited.points_err > 1)
      own_[k] = beyondPoints(keyframe.noise, keyframe.inherited.points_err);
  }
  analyse(map);
  fill(map);
  if (!cholesky_.factorizeRaised())
    throw core::MethodError("map: its keyframes do not determine one another; there is no covariance");
}

/// Made one after the other, so that they are never all there at once.
void ErrorFlow::forEachEquation(const KeyframeMap& map, const Use& use) const {
  for (int k = 0; k < map.size(); ++k) {
    if (pose_[static_cast<size_t>(k)] >= 0 && found_ == Poses::kTracked) use(inherited(map, k));
    if (pose_[static_cast<size_t>(k)] >= 0 && found_ == Poses::kFitted) useMeasured(map, k, use);
    Equation noise{{}, Matrix3d::Identity()};
    addPart(noise, seen_first_[static_cast<size_t>(k)], Matrix3d::Identity());
    use(noise);
  }
  for (const LoopEdge& one : map.loopEdges()) use(way(map, map.graph().edges()[one.edge], one.share));
}

void ErrorFlow::numberUnknowns(const KeyframeMap& map) {
  std::vector<char> is_view(poses_.size(), 0);
  for (const auto& keyframe : map.keyframes())
    for (const auto& view : keyframe.inherited.views) is_view[static_cast<size_t>(view.keyframe)] = 1;
  pose_.assign(poses_.size(), -1), seen_first_.assign(poses_.size(), -1);
  for (size_t k = 0; k < poses_.size(); ++k) {
    if (k > 0) pose_[k] = unknowns_++;
    if (is_view[k]) seen_first_[k] = unknowns_++;
  }
}

void ErrorFlow::addPart(Equation& equation, int unknown, const Matrix3d& factor) {
  if (unknown >= 0) equation.parts.push_back({unknown, factor});
}

/// That a keyframe errs by what it has inherited, and something new.
ErrorFlow::Equation ErrorFlow::inherited(const KeyframeMap& map, int k) const {
  const Inheritance& from = map.keyframe(k).inherited;
  const core::Point2 here = position(map.pose(k));
  const posegraph::Edge& step = map.graph().edges()[static_cast<size_t>(map.keyframe(k).odometry_edge)];
  const auto unknownOf = [](const std::vector<int>& of, int keyframe) {
    return of[static_cast<size_t>(keyframe)];
  };
  Equation equation;
  addPart(equation, unknownOf(pose_, k), Matrix3d::Identity());
  Matrix3d left = Matrix3d::Identity();
  if (from.own.isZero()) {
    equation.information = scanmatch::turned(step.information, -map.pose(k).phi);
  } else {
    equation.information =
        scanmatch::covarianceOf(scanmatch::withoutNegatives(from.own.matrix(), kLeastOwnShare, kLeastOwn));
    const double noise = std::sqrt(map.pointNoise().variance());
    for (const auto& view : from.views) {
      const Matrix3d J = moved(position(map.pose(view.keyframe)), here), H = view.information.matrix();
      const Matrix3d share = from.gain * H;
      left -= share;
      addPart(equation, unknownOf(pose_, view.keyframe), -share * J);
      // Of the view's points: their information is the inverse of what they err by.
      const Matrix3d root = rootOfInformation(J.transpose() * H * J);
      const double points_err = noise * map.keyframe(view.keyframe).inherited.points_err;
      addPart(equation, unknownOf(seen_first_, view.keyframe),
              -points_err * from.gain * moved(here, position(map.pose(view.keyframe))).transpose() * root);
    }
  }
  const int before = from.own.isZero() || from.before < 0 ? step.from : from.before;
  addPart(equation, unknownOf(pose_, before), -left * moved(position(map.pose(before)), here));
  return equation;
}

/// That odometry, and each view by itself, measure how a keyframe lies to others.
void ErrorFlow::useMeasured(const KeyframeMap& map, int k, const Use& use) const {
  const Inheritance& from = map.keyframe(k).inherited;
  use(way(map, map.graph().edges()[static_cast<size_t>(map.keyframe(k).odometry_edge)], 1));
  const double noise = std::sqrt(map.pointNoise().variance()), own = noise * from.points_err;
  for (const auto& view : from.views) {
    const core::Point2 here = position(map.pose(k)), there = position(map.pose(view.keyframe));
    const Matrix3d J = moved(there, here), H = view.information.matrix(),
                   root = rootOfInformation(J.transpose() * H * J);
    const double of_view = noise * map.keyframe(view.keyframe).inherited.points_err;
    Equation equation{{}, Matrix3d::Identity() / (own * own)};
    addPart(equation, pose_[static_cast<size_t>(k)], root.transpose() * moved(here, there));
    addPart(equation, pose_[static_cast<size_t>(view.keyframe)], -root.transpose());
    addPart(equation, seen_first_[static_cast<size_t>(view.keyframe)], -of_view * Matrix3d::Identity());
    use(equation);
  }
}

/// That the way between an edge's ends is as it was measured.
ErrorFlow::Equation ErrorFlow::way(const KeyframeMap& map, const posegraph::Edge& edge, double share) const {
  Equation equation;
  equation.information = share * scanmatch::turned(edge.information, -map.pose(edge.to).phi);
  addPart(equation, pose_[static_cast<size_t>(edge.to)], Matrix3d::Identity());
  addPart(equation, pose_[static_cast<size_t>(edge.from)],
          -moved(position(map.pose(edge.from)), position(map.pose(edge.to))));
  return equation;
}

void ErrorFlow::analyse(const KeyframeMap& map) {
  std::vector<std::pair<int, int>> blocks;
  forEachEquation(map, [&blocks](const Equation& equation) {
    for (size_t i = 0; i < equation.parts.size(); ++i)
      for (size_t j = 0; j < i; ++j)
        if (equation.parts[i].unknown != equation.parts[j].unknown)
          blocks.emplace_back(equation.parts[i].unknown, equation.parts[j].unknown);
  });
  cholesky_.analyse(unknowns_, blocks);
}

void ErrorFlow::fill(const KeyframeMap& map) {
  cholesky_.setZero();
  int block = 0;
  forEachEquation(map, [&](const Equation& equation) {
    for (size_t i = 0; i < equation.parts.size(); ++i) {
      const Part& a = equation.parts[i];
      const Matrix3d told = a.factor.transpose() * equation.information;
      cholesky_.addDiagonal(a.unknown, told * a.factor);
      for (size_t j = 0; j < i; ++j) {
        const Part& b = equation.parts[j];
        const Matrix3d both = told * b.factor;
        if (a.unknown != b.unknown)
          cholesky_.addBlock(block++, both);
        else
          cholesky_.addDiagonal(a.unknown, both + both.transpose());
      }
    }
  });
}

std::vector<Matrix3d> ErrorFlow::covariances() const {
  const auto of_unknowns = cholesky_.sparseInverse().diagonal;
  std::vector<Matrix3d> result(pose_.size(), Matrix3d::Zero());
  for (size_t k = 0; k < result.size(); ++k)
    if (pose_[k] >= 0)
      result[k] =
          scanmatch::withoutNegatives(of_unknowns[static_cast<size_t>(pose_[k])], kLeastShare, 0) + own_[k];
  return result;
}

Matrix3d ErrorFlow::relative(int a, int b) const {
  const auto halfColumn = [this](int k) {
    const int unknown = pose_[static_cast<size_t>(k)];
    return unknown < 0 ? sparse::BlockCholesky::HalfColumn() : cholesky_.halfColumn(unknown);
  };
  const auto of_a = halfColumn(a), of_b = halfColumn(b);
  const Matrix3d ab = sparse::BlockCholesky::inverseBlock(of_a, of_b);
  Eigen::Matrix<double, 6, 6> joint;
  joint << sparse::BlockCholesky::inverseBlock(of_a, of_a) + own_[static_cast<size_t>(a)], ab, ab.transpose(),
      sparse::BlockCholesky::inverseBlock(of_b, of_b) + own_[static_cast<size_t>(b)];
  return posegraph::relativeCovariance(joint, poses_[static_cast<size_t>(a)], poses_[static_cast<size_t>(b)]);
}

}  // namespace slam::uncertainty

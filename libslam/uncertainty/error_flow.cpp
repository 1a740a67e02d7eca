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
using keyframes::kLeastShare;
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

ErrorFlow::ErrorFlow(const keyframes::KeyframeMap& map, Poses poses)
    : ErrorFlow(ErrorSources(map), map.graph().poses(), poses, ViewNoise::kShared) {}

ErrorFlow::ErrorFlow(const ErrorSources& sources, std::vector<core::Pose2> T_map_keyframes, Poses poses,
                     ViewNoise noise)
    : poses_(std::move(T_map_keyframes)), found_(poses) {
  numberUnknowns(sources, noise);
  own_.assign(poses_.size(), Matrix3d::Zero());
  for (size_t k = 1; k < own_.size() && found_ == Poses::kFitted; ++k)
    if (const double points_err = sources.inherited[k].points_err; points_err > 1)
      own_[k] = beyondPoints(sources.noise[k], points_err);
  analyse(sources);
  fill(sources);
  if (!cholesky_.factorizeRaised())
    throw core::MethodError("map: its keyframes do not determine one another; there is no covariance");
}

/// Made one after the other, so that they are never all there at once.
void ErrorFlow::forEachEquation(const ErrorSources& sources, const Use& use) const {
  for (int k = 0; k < static_cast<int>(poses_.size()); ++k) {
    if (pose_[static_cast<size_t>(k)] >= 0 && found_ == Poses::kTracked) use(inherited(sources, k));
    if (pose_[static_cast<size_t>(k)] >= 0 && found_ == Poses::kFitted) useMeasured(sources, k, use);
    Equation noise{{}, Matrix3d::Identity()};
    addPart(noise, seen_first_[static_cast<size_t>(k)], Matrix3d::Identity());
    use(noise);
  }
  for (const ErrorSources::Way& loop : sources.loops) use(way(loop));
}

void ErrorFlow::numberUnknowns(const ErrorSources& sources, ViewNoise noise) {
  std::vector<char> is_view(poses_.size(), 0);
  for (const Inheritance& from : sources.inherited)
    for (const auto& view : from.views)
      is_view[static_cast<size_t>(view.keyframe)] = noise == ViewNoise::kShared;
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
ErrorFlow::Equation ErrorFlow::inherited(const ErrorSources& sources, int k) const {
  const auto i = static_cast<size_t>(k);
  const Inheritance& from = sources.inherited[i];
  const core::Point2 here = position(poses_[i]);
  Equation equation;
  addPart(equation, pose_[i], Matrix3d::Identity());
  const std::vector<PoseShare> shares = poseShares(from, poses_[i], sources.steps[i].from, poses_);
  const size_t views = shares.size() - 1;
  Matrix3d own = from.own.matrix();
  for (size_t v = 0; v < views; ++v) {
    const Inheritance::View& view = from.views[v];
    const auto seen_by = static_cast<size_t>(view.keyframe);
    addPart(equation, pose_[seen_by], -shares[v].of_pose);
    const double view_err = sources.inherited[seen_by].points_err;
    if (seen_first_[seen_by] < 0) {
      own += noiseOfView(from, view, view_err, sources.point_variance);
      continue;
    }
    // Of the view's points: their information is the inverse of what they err by.
    const Matrix3d back = moved(here, position(poses_[seen_by])).transpose(), H = view.information.matrix(),
                   J = moved(position(poses_[seen_by]), here),
                   root = rootOfInformation(J.transpose() * H * J);
    const double points_err = std::sqrt(sources.point_variance) * view_err;
    addPart(equation, seen_first_[seen_by], -points_err * from.gain * back * root);
  }
  equation.information =
      from.own.isZero()
          ? scanmatch::turned(sources.steps[i].information, -poses_[i].phi)
          : scanmatch::covarianceOf(scanmatch::withoutNegatives(own, kLeastOwnShare, kLeastOwn));
  addPart(equation, pose_[static_cast<size_t>(shares[views].keyframe)], -shares[views].of_pose);
  return equation;
}

/// That odometry, and each view by itself, measure how a keyframe lies to others.
void ErrorFlow::useMeasured(const ErrorSources& sources, int k, const Use& use) const {
  const auto i = static_cast<size_t>(k);
  const Inheritance& from = sources.inherited[i];
  use(way(sources.steps[i]));
  const double noise = std::sqrt(sources.point_variance), own = noise * from.points_err;
  for (const auto& view : from.views) {
    const auto seen_by = static_cast<size_t>(view.keyframe);
    const core::Point2 here = position(poses_[i]), there = position(poses_[seen_by]);
    const Matrix3d J = moved(there, here), H = view.information.matrix(),
                   root = rootOfInformation(J.transpose() * H * J);
    const double of_view = noise * sources.inherited[seen_by].points_err;
    Equation equation{{}, Matrix3d::Identity() / (own * own)};
    addPart(equation, pose_[i], root.transpose() * moved(here, there));
    addPart(equation, pose_[seen_by], -root.transpose());
    addPart(equation, seen_first_[seen_by], -of_view * Matrix3d::Identity());
    use(equation);
  }
}

/// That the way between an edge's ends is as it was measured.
ErrorFlow::Equation ErrorFlow::way(const ErrorSources::Way& way) const {
  const core::Pose2 &from = poses_[static_cast<size_t>(way.from)], &to = poses_[static_cast<size_t>(way.to)];
  Equation equation;
  equation.information = scanmatch::turned(way.information, -to.phi);
  addPart(equation, pose_[static_cast<size_t>(way.to)], Matrix3d::Identity());
  addPart(equation, pose_[static_cast<size_t>(way.from)], -moved(position(from), position(to)));
  return equation;
}

void ErrorFlow::analyse(const ErrorSources& sources) {
  std::vector<std::pair<int, int>> blocks;
  forEachEquation(sources, [&blocks](const Equation& equation) {
    for (size_t i = 0; i < equation.parts.size(); ++i)
      for (size_t j = 0; j < i; ++j)
        if (equation.parts[i].unknown != equation.parts[j].unknown)
          blocks.emplace_back(equation.parts[i].unknown, equation.parts[j].unknown);
  });
  cholesky_.analyse(unknowns_, blocks);
}

void ErrorFlow::fill(const ErrorSources& sources) {
  cholesky_.setZero();
  int block = 0;
  forEachEquation(sources, [&](const Equation& equation) {
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

void ErrorFlow::draw(std::vector<keyframes::ErrorSamples>& samples, int piece) const {
  constexpr int kWidth = sparse::BlockCholesky::Columns::ColsAtCompileTime;
  static_assert(kWidth * kPieces == keyframes::ErrorSamples::kCount);
  std::vector<sparse::BlockCholesky::Columns> columns(static_cast<size_t>(unknowns_));
  const auto forEach = [&](const auto& use) {
    for (size_t k = 0; k < pose_.size(); ++k)
      for (int i = 0; i < kWidth && pose_[k] >= 0; ++i)
        use(samples[k], piece * kWidth + i, columns[static_cast<size_t>(pose_[k])].col(i));
  };
  forEach([](const keyframes::ErrorSamples& of_k, int i, auto column) { column = of_k.sample(i); });
  cholesky_.spread(columns);
  forEach([](keyframes::ErrorSamples& of_k, int i, auto column) { of_k.setSample(i, column); });
}

}  // namespace slam::uncertainty

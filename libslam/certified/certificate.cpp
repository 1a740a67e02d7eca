#include "libslam/certified/certificate.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>

#include "libslam/certified/unit_complex.h"
#include "libslam/core/elementary.h"
#include "libslam/posegraph/edge_error.h"
#include "libslam/posegraph/parts.h"

namespace slam::certified {
namespace {

using Complex = std::complex<double>;

using Vector = Eigen::VectorXcd;
using Matrix = Eigen::SparseMatrix<Complex>;

/// A complex number that is linear in the unknowns: at most four of them.
class Linear {
 public:
  void add(int unknown, const Complex& factor) {
    for (int i = 0; i < size_; ++i)
      if (terms_[static_cast<size_t>(i)].first == unknown) {
        terms_[static_cast<size_t>(i)].second += factor;
        return;
      }
    terms_[static_cast<size_t>(size_++)] = {unknown, factor};
  }
  void add(const Linear& other, const Complex& factor) {
    for (int i = 0; i < other.size_; ++i) add(other.term(i).first, factor * other.term(i).second);
  }
  int size() const { return size_; }
  const std::pair<int, Complex>& term(int i) const { return terms_[static_cast<size_t>(i)]; }

 private:
  std::array<std::pair<int, Complex>, 6> terms_;
  int size_ = 0;
};

/// Which unknowns a node's heading and position are made of. Unknown 0 is the heading of the map's frame,
/// whose position is the origin; a free node has two of its own: heading, position.
class Unknowns {
 public:
  explicit Unknowns(const posegraph::PoseGraph& graph) : graph_(graph) {
    for (int node = 0; node < graph.nodeCount(); ++node)
      first_.push_back(graph.isFixed(node) ? -1 : 1 + 2 * free_++);
  }
  int count() const { return 1 + 2 * free_; }
  bool isHeading(int unknown) const { return unknown == 0 || unknown % 2 == 1; }

  Linear heading(int node) const {
    Linear out;
    if (node == posegraph::kMap)
      out.add(0, 1);
    else if (first(node) < 0)
      out.add(0, unitComplex(graph_.pose(node).phi));
    else
      out.add(first(node), 1);
    return out;
  }
  Linear position(int node) const {
    Linear out;
    if (node == posegraph::kMap) return out;
    if (first(node) < 0)
      out.add(0, {graph_.pose(node).x, graph_.pose(node).y});
    else
      out.add(first(node) + 1, 1);
    return out;
  }
  Vector values() const {
    Vector out(count());
    out[0] = 1;
    for (int node = 0; node < graph_.nodeCount(); ++node)
      if (first(node) >= 0) {
        const core::Pose2& pose = graph_.pose(node);
        out[first(node)] = unitComplex(pose.phi);
        out[first(node) + 1] = {pose.x, pose.y};
      }
    return out;
  }

 private:
  int first(int node) const { return first_[static_cast<size_t>(node)]; }
  const posegraph::PoseGraph& graph_;
  std::vector<int> first_;
  int free_ = 0;
};

/// A Hermitian form as it is summed up, and its product with the unknowns' values: edge by edge, so that it
/// keeps its digits.
class Form {
 public:
  explicit Form(Vector values) : values_(std::move(values)), product_(Vector::Zero(values_.size())) {}

  /// 2 Re(conj(a) k b), or k |a|^2 when a is b and k half of it.
  void add(const Linear& a, const Complex& k, const Linear& b) {
    const Complex at_a = at(a), at_b = at(b);
    for (int i = 0; i < a.size(); ++i) product_[a.term(i).first] += std::conj(a.term(i).second) * k * at_b;
    for (int j = 0; j < b.size(); ++j)
      product_[b.term(j).first] += std::conj(b.term(j).second) * std::conj(k) * at_a;
    for (int i = 0; i < a.size(); ++i)
      for (int j = 0; j < b.size(); ++j) {
        const Complex entry = std::conj(a.term(i).second) * k * b.term(j).second;
        entries_.emplace_back(a.term(i).first, b.term(j).first, entry);
        entries_.emplace_back(b.term(j).first, a.term(i).first, std::conj(entry));
      }
  }
  const Vector& product() const { return product_; }
  const Vector& values() const { return values_; }
  Matrix matrix() const {
    Matrix out(values_.size(), values_.size());
    out.setFromTriplets(entries_.begin(), entries_.end());
    return out;
  }

 private:
  Complex at(const Linear& linear) const {
    Complex sum = 0;
    for (int i = 0; i < linear.size(); ++i) sum += linear.term(i).second * values_[linear.term(i).first];
    return sum;
  }
  Vector values_, product_;
  std::vector<Eigen::Triplet<Complex>> entries_;
};

/// The largest diag(s, s, w), as a share of (least of the information's positions, its heading), below the
/// information.
Eigen::Vector3d roundPart(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> positions(information.topLeftCorner<2, 2>(),
                                                                 Eigen::EigenvaluesOnly);
  const double s = std::max(0.0, positions.eigenvalues()[0]), w = std::max(0.0, information(2, 2));
  if (s == 0 || w == 0) return {s, s, information.topRightCorner<2, 1>().isZero(0) ? w : 0};
  const Eigen::Vector3d root(std::sqrt(s), std::sqrt(s), std::sqrt(w));
  const Eigen::Matrix3d scaled =
      root.cwiseInverse().asDiagonal() * information * root.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> all(scaled, Eigen::EigenvaluesOnly);
  const double share = std::clamp(all.eigenvalues()[0], 0.0, 1.0);
  return Eigen::Vector3d(s, s, w) * share;
}

/// Adds the form that bounds an edge's chi2 from below and meets it at the graph's poses. False: there is
/// none.
bool addEdge(const posegraph::PoseGraph& graph, const Unknowns& unknowns, const posegraph::Edge& edge,
             Form& form) {
  const Eigen::Vector3d e = posegraph::edgeError(edge, graph.poses());
  const Eigen::Vector3d round = roundPart(edge.information);
  const Eigen::Vector3d tangent = (edge.information - Eigen::Matrix3d(round.asDiagonal())) * e;
  const Linear a = unknowns.heading(edge.from), b = unknowns.heading(edge.to);
  const Complex z = unitComplex(edge.T_from_to.phi);
  // In the map's frame: t_b - t_a - a t_z.
  Linear r = unknowns.position(edge.to);
  r.add(unknowns.position(edge.from), -1);
  r.add(a, -Complex(edge.T_from_to.x, edge.T_from_to.y));
  form.add(r, round[0] / 2, r);
  // The error is conj(a z) r, and a + bi times a' + b'i, one of them conjugate, has a dot product for its
  // real part.
  form.add(a, std::conj(Complex(tangent[0], tangent[1]) * z), r);
  // w theta^2 + 2 d theta is w (theta - shift)^2 and a constant.
  const double w = round[2];
  if (w == 0) return tangent[2] == 0;
  const double shift = -tangent[2] / w, off = e[2] - shift;
  if (!(std::abs(off) < core::kPi)) return false;
  const double bend = std::abs(off) < 1e-8 ? 1 : off / core::sin(off);
  Linear turn = b;
  turn.add(a, -z * unitComplex(shift));
  form.add(turn, w * bend / 2, turn);
  return true;
}

/// The least addition to the diagonal's headings, of a few tried, that makes the form positive definite.
std::optional<double> leastAddition(const Matrix& lagrangian, const Unknowns& unknowns, double first,
                                    double most) {
  Eigen::SimplicialLLT<Matrix> factor;
  factor.analyzePattern(lagrangian);
  double addition = first;
  while (addition < most) {
    Matrix trial = lagrangian;
    for (int i = 0; i < unknowns.count(); ++i)
      if (unknowns.isHeading(i)) trial.coeffRef(i, i) += addition;
    factor.factorize(trial);
    if (factor.info() == Eigen::Success) return addition;
    addition *= 10;
  }
  return std::nullopt;
}

}  // namespace

Certificate certify(const posegraph::PoseGraph& graph) {
  std::vector<char> is_used;
  for (const posegraph::Edge& edge : graph.edges()) is_used.push_back(edge.on);
  posegraph::requireHeld(graph, is_used);
  Certificate out;
  out.chi2 = graph.chi2();
  const double allowed = kCertified * (1 + out.chi2);
  out.is_optimal = out.chi2 <= allowed;  // none is below 0
  const Unknowns unknowns(graph);
  Form form(unknowns.values());
  for (const posegraph::Edge& edge : graph.edges())
    if (edge.on && !addEdge(graph, unknowns, edge, form)) return out;
  Matrix lagrangian = form.matrix();
  double headings = 0, slack = 0;
  for (int i = 0; i < unknowns.count(); ++i) {
    const double pull = (std::conj(form.values()[i]) * form.product()[i]).real();
    if (unknowns.isHeading(i)) {
      lagrangian.coeffRef(i, i) -= pull;
      ++headings;
    } else {
      slack += pull;  // 0 at a minimum
    }
  }
  const auto addition =
      leastAddition(lagrangian, unknowns, 1e-3 * allowed / headings, (1 + out.chi2) / headings);
  if (!addition) return out;
  const double gap = std::abs(slack) + headings * *addition;
  out.lower_bound = std::max(0.0, out.chi2 - gap);
  out.is_optimal = out.is_optimal || gap <= allowed;
  return out;
}

}  // namespace slam::certified

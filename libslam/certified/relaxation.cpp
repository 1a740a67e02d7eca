#include "libslam/certified/relaxation.h"

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cmath>
#include <complex>

#include "libslam/certified/unit_complex.h"
#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/posegraph/parts.h"

namespace slam::certified {
namespace {

using Complex = std::complex<double>;

Eigen::Matrix2d rotation(double phi_rad) {
  const auto [sine, cosine] = core::sinCos(phi_rad);
  Eigen::Matrix2d R;
  R << cosine, -sine, sine, cosine;
  return R;
}

/// Of the largest entry of the diagonal: what a heading or a position keeps that no edge tells.
constexpr double kLeast = 1e-12;

/// Linear least squares in complex or real unknowns.
template <typename Number>
class LeastSquares {
 public:
  explicit LeastSquares(int size) : size_(size), right_(Vector::Zero(size)) {}
  /// Adds conj(row) * column for the unknowns' form; both below size.
  void add(int row, int column, const Number& value) { entries_.emplace_back(row, column, value); }
  void addRight(int row, const Number& value) { right_[row] += value; }
  using Vector = Eigen::Matrix<Number, Eigen::Dynamic, 1>;
  Vector solve() {
    Eigen::SparseMatrix<Number> equations(size_, size_);
    equations.setFromTriplets(entries_.begin(), entries_.end());
    double largest = 0;
    for (int i = 0; i < size_; ++i) largest = std::max(largest, std::abs(equations.coeff(i, i)));
    for (int i = 0; i < size_; ++i) equations.coeffRef(i, i) += kLeast * (largest > 0 ? largest : 1);
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<Number>> factor(equations);
    if (factor.info() != Eigen::Success)
      throw core::InputError(
          "pose graph: found edges that do not tell the poses, expected better information");
    return factor.solve(right_);
  }

 private:
  int size_;
  std::vector<Eigen::Triplet<Number>> entries_;
  Vector right_;
};

class Relaxation {
 public:
  explicit Relaxation(const posegraph::PoseGraph& graph)
      : graph_(graph), headings_(static_cast<size_t>(graph.nodeCount())) {
    for (int node = 0; node < graph.nodeCount(); ++node)
      variable_.push_back(graph.isFixed(node) ? -1 : free_++);
  }
  std::vector<core::Pose2> solve() {
    findHeadings();
    return positions();
  }

 private:
  static size_t at(int node) { return static_cast<size_t>(node); }
  int variable(int node) const { return node == posegraph::kMap ? -1 : variable_[at(node)]; }

  /// The least of w |b - a z|^2 over all edges.
  void findHeadings() {
    LeastSquares<Complex> equations(free_);
    for (const posegraph::Edge& edge : graph_.edges()) {
      const double w = edge.information(2, 2);
      if (!edge.on || w <= 0) continue;
      const Complex z = unitComplex(edge.T_from_to.phi);
      const int a = variable(edge.from), b = variable(edge.to);
      if (a >= 0) equations.add(a, a, w);
      if (b >= 0) equations.add(b, b, w);
      if (a >= 0 && b >= 0) {
        equations.add(b, a, -w * z);
        equations.add(a, b, -w * std::conj(z));
      } else if (b >= 0) {
        equations.addRight(b, w * z * unitComplex(knownHeading(edge.from)));
      } else if (a >= 0) {
        equations.addRight(a, w * std::conj(z) * unitComplex(knownHeading(edge.to)));
      }
    }
    const auto found = equations.solve();
    for (int node = 0; node < graph_.nodeCount(); ++node)
      headings_[at(node)] = variable(node) < 0
                                ? knownHeading(node)
                                : core::atan2(found[variable(node)].imag(), found[variable(node)].real());
  }
  double knownHeading(int node) const { return node == posegraph::kMap ? 0 : graph_.pose(node).phi; }

  /// The least of e' W e over all edges, e = t_b - t_a - R_a t_z, W the positions' information in the map's
  /// frame.
  std::vector<core::Pose2> positions() {
    LeastSquares<double> equations(2 * free_);
    for (const posegraph::Edge& edge : graph_.edges())
      if (edge.on) addPositions(edge, equations);
    const Eigen::VectorXd found = equations.solve();
    std::vector<core::Pose2> out = graph_.poses();
    for (int node = 0; node < graph_.nodeCount(); ++node)
      if (const int i = 2 * variable(node); i >= 0)
        out[at(node)] = {found[i], found[i + 1], headings_[at(node)]};
    return out;
  }
  void addPositions(const posegraph::Edge& edge, LeastSquares<double>& equations) const {
    const double heading = edge.from == posegraph::kMap ? 0 : headings_[at(edge.from)];
    const Eigen::Matrix2d R = rotation(heading + edge.T_from_to.phi);
    const Eigen::Matrix2d W = R * edge.information.topLeftCorner<2, 2>() * R.transpose();
    Eigen::Vector2d measured = rotation(heading) * Eigen::Vector2d(edge.T_from_to.x, edge.T_from_to.y);
    const int ends[] = {variable(edge.from), variable(edge.to)};
    const int nodes[] = {edge.from, edge.to};
    for (const int end : {0, 1})
      if (ends[end] < 0 && nodes[end] != posegraph::kMap) {
        const core::Pose2& known = graph_.pose(nodes[end]);
        measured += (end == 0 ? 1 : -1) * Eigen::Vector2d(known.x, known.y);
      }
    for (const int i : {0, 1})
      for (const int row : {0, 1}) {
        if (ends[i] < 0) continue;
        const double sign = i == 0 ? -1 : 1;
        equations.addRight(2 * ends[i] + row, sign * W.row(row).dot(measured));
        for (const int j : {0, 1})
          for (const int column : {0, 1})
            if (ends[j] >= 0)
              equations.add(2 * ends[i] + row, 2 * ends[j] + column, (i == j ? 1 : -1) * W(row, column));
      }
  }

  const posegraph::PoseGraph& graph_;
  std::vector<int> variable_;
  int free_ = 0;
  std::vector<double> headings_;
};

}  // namespace

std::vector<core::Pose2> relaxedPoses(const posegraph::PoseGraph& graph) {
  std::vector<char> is_used;
  for (const posegraph::Edge& edge : graph.edges()) is_used.push_back(edge.on);
  posegraph::requireHeld(graph, is_used);
  return Relaxation(graph).solve();
}

}  // namespace slam::certified

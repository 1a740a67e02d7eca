#pragma once
#include <Eigen/Core>
#include <utility>
#include <vector>

#include "libslam/sparse/elimination.h"

namespace slam::sparse {

/// Sparse Cholesky factorisation of a symmetric positive definite matrix of 3 x 3 blocks, one block row per
/// pose; see Elimination. Columns with the same pattern are stored together, densely, and taken off the
/// columns after them together (supernodes: Ng and Peyton, SIAM J. Sci. Comput. 14(5), 1993).
///
/// Use: analyse() once per pattern; then setZero(), add..., factorize(), solve() as often as wanted, in this
/// order. Deterministic: the same calls give the same bytes, on every processor.
class BlockCholesky {
 public:
  /// `blocks`: (row, column) of the off-diagonal blocks that may be other than zero, either triangle,
  /// repetitions allowed. REQUIRES indices within 0 .. size-1 and row != column. Cost: about that of one
  /// factorisation, a third of it when setZero() is called first.
  void analyse(int size, const std::vector<std::pair<int, int>>& blocks);

  void setZero();
  void addDiagonal(int row, const Eigen::Matrix3d& value) {
    diagonal_[at(elimination_.position(row))] += value;
  }
  /// `block`: index into analyse()'s list; `value` stands at its (row, column), and its transpose at (column,
  /// row).
  void addBlock(int block, const Eigen::Matrix3d& value) {
    const Slot slot = slots_[at(block)];
    if (slot.transposed)
      values_[at(slot.index)] += value.transpose();
    else
      values_[at(slot.index)] += value;
  }

  /// Factorises what was added, its scalar diagonal multiplied by 1 + damping. False when it is not positive
  /// definite (to rounding); then there is no factor. What was added stays.
  bool factorize(double damping = 0);
  /// The same with the least damping that gives a factor: none, else 1e-14, and ten times as much as long as
  /// that is below 1. So what is open gets a large variance. False where none does.
  bool factorizeRaised();
  /// The same in pieces: begin(), then advance() while it says kGoing. `work`: about how many multiplications
  /// are left for this piece (at least one supernode is done, or some of the factor's memory touched for the
  /// first time); what was done is taken off. Between them nothing is added.
  enum class Progress { kGoing, kDone, kFailed };
  void beginFactorization(double damping);
  Progress advance(double& work);

  /// Solves in place. REQUIRES a factor, here and below.
  void solve(std::vector<Eigen::Vector3d>& b) const;
  /// L^-T times columns, in place, a block of them per row: of independent draws with variance 1 it makes
  /// draws whose covariance is the inverse.
  using Columns = Eigen::Matrix<double, 3, 16>;
  void spread(std::vector<Columns>& columns) const;
  /// What solve() costs, as advance() counts.
  double workOfSolving() const;

  /// A column block of L^-1, which is sparse: what the rows of the inverse are made of.
  struct HalfColumn {
    std::vector<int> rows;  ///< in the order of elimination, ascending
    std::vector<Eigen::Matrix3d> blocks;
  };
  HalfColumn halfColumn(int row) const;
  /// Block (a, b) of the inverse from the half columns of a and b.
  static Eigen::Matrix3d inverseBlock(const HalfColumn& a, const HalfColumn& b);
  /// Of the inverse: all diagonal blocks, and those at the places of analyse()'s list. By Takahashi's
  /// recursion over the factor's pattern (Erisman and Tinney, Comm. ACM 18(3), 1975). Cost: two to three
  /// factorisations.
  struct SparseInverse {
    std::vector<Eigen::Matrix3d> diagonal, blocks;
  };
  SparseInverse sparseInverse() const;

  int size() const { return elimination_.size(); }
  /// Off-diagonal blocks of the factor: what memory and time grow with.
  long factorBlocks() const { return elimination_.entries(); }

 private:
  struct Slot {
    int index;
    bool transposed;
  };
  /// A supernode's columns of the factor: scalars by columns, `height` apart.
  struct Panel {
    size_t begin = 0;
    long height = 0;
  };
  std::vector<std::pair<int, int>> listValues(int size, const std::vector<std::pair<int, int>>& blocks);
  void placeValues();
  template <class Visit>
  void forColumn(int s, int c, const Visit& visit) const;
  template <class Block>
  void solveUpper(std::vector<Block>& y) const;
  size_t placeOf(int row, int column) const;
  bool makeRoom(double& work);
  void setPanels();
  bool factorizePanel(int s);
  double workOf(int s) const;
  void update(int s);
  void gatherBelow(int s, const std::vector<double>& inverse, double* square) const;
  void invertPanel(int s, double* square, double* column) const;
  static size_t at(long i) { return static_cast<size_t>(i); }

  Elimination elimination_;
  std::vector<std::pair<int, int>> pairs_;  ///< of values_, until they have places in the factor
  bool has_places_ = false;
  std::vector<Slot> slots_;
  std::vector<Eigen::Matrix3d> diagonal_, values_;  ///< of the matrix; by columns, and as listed
  std::vector<size_t> value_places_;                ///< of values_, in factor_
  std::vector<long> value_heights_;
  std::vector<Panel> panels_;
  size_t scalars_ = 0;  ///< of the factor
  std::vector<double> factor_;
  static constexpr int kNothingSet = -1;
  double damping_ = 0;  ///< of the factorisation that goes on, and its next supernode
  int next_ = kNothingSet;
  std::vector<Eigen::Matrix3d> inverse_pivot_;  ///< of the factor's diagonal blocks, by columns
};

}  // namespace slam::sparse

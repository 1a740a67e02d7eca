#pragma once
#include <Eigen/Core>
#include <utility>
#include <vector>

namespace slam::posegraph {

/// Sparse Cholesky factorisation of a symmetric positive definite matrix of 3 x 3 blocks, one block row per
/// pose. Rows are eliminated in the order of approximate minimum degree (Amestoy, Davis and Duff, SIAM J.
/// Matrix Anal. Appl. 17(4), 1996, as Eigen has it), row by row along the elimination tree (Davis, "Direct
/// methods for sparse linear systems", 2006, chapter 4). A whole block is one entry of the pattern, so there
/// is a ninth of the indices that Eigen's SimplicialLLT has to follow.
///
/// Use: analyse() once per pattern; then setZero(), add..., factorize(), solve() as often as wanted.
/// Deterministic: the same calls give the same bytes.
class BlockCholesky {
 public:
  /// `blocks`: (row, column) of the off-diagonal blocks that may be other than zero, either triangle,
  /// repetitions allowed. REQUIRES indices within 0 .. size-1 and row != column. Cost: about that of one
  /// factorisation.
  void analyse(int size, const std::vector<std::pair<int, int>>& blocks);

  void setZero();
  void addDiagonal(int row, const Eigen::Matrix3d& value) { diagonal_[at(position_[at(row)])] += value; }
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

  /// Solves in place. REQUIRES a factor, here and below.
  void solve(std::vector<Eigen::Vector3d>& b) const;

  /// A column block of L^-1, which is sparse: what the rows of the inverse are made of.
  struct HalfColumn {
    std::vector<int> rows;  ///< in the order of elimination, ascending
    std::vector<Eigen::Matrix3d> blocks;
  };
  HalfColumn halfColumn(int row) const;
  /// Block (a, b) of the inverse from the half columns of a and b.
  static Eigen::Matrix3d inverseBlock(const HalfColumn& a, const HalfColumn& b);
  /// Of the inverse: all diagonal blocks, and those at the places of analyse()'s list. By Takahashi's
  /// recursion over the factor's pattern (Erisman and Tinney, Comm. ACM 18(3), 1975). Cost: about three
  /// factorisations.
  struct SparseInverse {
    std::vector<Eigen::Matrix3d> diagonal, blocks;
  };
  SparseInverse sparseInverse() const;

  int size() const { return static_cast<int>(order_.size()); }
  /// Off-diagonal blocks of the factor: what memory and time grow with.
  int factorBlocks() const { return static_cast<int>(row_of_.size()); }

 private:
  struct Slot {
    int index;
    bool transposed;
  };
  /// An entry of a row of L: its column, and where it lies in L's storage.
  struct RowEntry {
    int column, at;
  };
  void storeByRows(const std::vector<std::pair<int, int>>& blocks);
  std::vector<int> eliminate();
  void listByColumns(const std::vector<int>& count);
  static size_t at(int i) { return static_cast<size_t>(i); }

  std::vector<int> order_, position_;  // order_[k]: the row eliminated k-th; position_ is its inverse
  // The matrix, permuted: lower triangle by rows.
  std::vector<Slot> slots_;
  std::vector<int> value_start_, value_column_;
  std::vector<Eigen::Matrix3d> diagonal_, values_;
  // The factor: by columns, rows ascending; and the same entries listed by rows.
  std::vector<int> parent_, column_start_, row_of_, row_start_;
  std::vector<RowEntry> row_entries_;
  std::vector<Eigen::Matrix3d> factor_, inverse_pivot_, work_;
};

}  // namespace slam::posegraph

#pragma once
#include <cstddef>
#include <utility>
#include <vector>

namespace slam::sparse {

/// In what order the rows of a symmetric matrix are eliminated, and which entries its Cholesky factor has. An
/// entry stands for a block of whatever size.
///
/// Rows are ordered by approximate minimum degree (Amestoy, Davis and Duff, SIAM J. Matrix Anal. Appl. 17(4),
/// 1996, as Eigen has it), then by the elimination tree, children first (Davis, "Direct methods for sparse
/// linear systems", 2006, chapter 4). Columns in a row with the same entries below them make a supernode;
/// small ones are joined where that stores few zeros (Ashcraft and Grimes, ACM Trans. Math. Software 15(4),
/// 1989).
///
/// Below, rows and columns are counted in that order. Deterministic.
class Elimination {
 public:
  /// Columns `first` .. `first + width - 1`, and the rows below them, ascending: rows()[rows_begin] ..
  /// rows()[rows_end - 1].
  struct Supernode {
    int first = 0, width = 0, rows_begin = 0, rows_end = 0;
    int updates_begin = 0, updates_end = 0;
    int below() const { return rows_end - rows_begin; }
  };
  /// Rows `from` .. `to - 1` below a supernode, counted from its rows_begin, are columns of supernode
  /// `target`. places()[places_begin + i] is where its row from + i lies there: 0 for the first column,
  /// `width` for the first row below.
  struct Update {
    int target = 0, from = 0, to = 0, places_begin = 0;
  };

  Elimination() = default;
  /// `entries`: (row, column) beside the diagonal that may be other than zero, of either triangle, each once.
  /// REQUIRES indices within 0 .. size-1 and row != column.
  Elimination(int size, const std::vector<std::pair<int, int>>& entries);

  int size() const { return static_cast<int>(order_.size()); }
  /// The row that is eliminated k-th; and when a row is.
  int rowAt(int k) const { return order_[static_cast<std::size_t>(k)]; }
  int position(int row) const { return position_[static_cast<std::size_t>(row)]; }

  const std::vector<Supernode>& supernodes() const { return supernodes_; }
  const Supernode& supernode(int s) const { return supernodes_[static_cast<std::size_t>(s)]; }
  const std::vector<int>& rows() const { return rows_; }
  const std::vector<Update>& updates() const { return updates_; }
  const std::vector<int>& places() const { return places_; }
  int supernodeOf(int column) const { return supernode_of_[static_cast<std::size_t>(column)]; }
  /// Where a row lies in supernode s, as in places(). REQUIRES that it is one of it.
  int placeIn(int s, int row) const;
  /// Entries of the factor beside the diagonal, without the zeros that supernodes store.
  long entries() const { return entries_; }

 private:
  /// Lists of numbers, one after the other: list i from begin[i] to begin[i + 1].
  struct Lists {
    std::vector<int> begin, numbers;
  };
  Lists lowerRows(const std::vector<std::pair<int, int>>& entries) const;
  static std::vector<int> tree(const Lists& lower);
  std::vector<int> orderByTree(const std::vector<int>& parent);
  Lists columnsOfFactor(const Lists& lower, const std::vector<int>& parent, const std::vector<int>& before);
  void gatherSupernodes(const Lists& columns);
  void listUpdates();

  std::vector<int> order_, position_, supernode_of_, rows_, places_;
  std::vector<Supernode> supernodes_;
  std::vector<Update> updates_;
  long entries_ = 0;
};

}  // namespace slam::sparse

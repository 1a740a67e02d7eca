#include "libslam/posegraph/block_cholesky.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace slam::posegraph {
namespace {

/// A pivot below this share of the diagonal entry that it came from is rounding.
constexpr double kSmallestPivot = 1e-14;

std::vector<int> minimumDegreeOrder(int size, const std::vector<std::pair<int, int>>& blocks) {
  std::vector<Eigen::Triplet<float>> entries;
  entries.reserve(blocks.size() + static_cast<size_t>(size));
  for (int i = 0; i < size; ++i) entries.emplace_back(i, i, 1.0F);
  for (const auto& [row, column] : blocks)
    entries.emplace_back(std::max(row, column), std::min(row, column), 1.0F);
  Eigen::SparseMatrix<float> pattern(size, size);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(pattern.selfadjointView<Eigen::Lower>(), permutation);
  const auto& indices = permutation.indices();
  return {indices.data(), indices.data() + indices.size()};
}

/// Inverse of the lower Cholesky factor of a block. `original`: the diagonal before anything was taken off
/// it. False when not positive definite.
bool invertPivot(const Eigen::Matrix3d& a, const Eigen::Matrix3d& original, Eigen::Matrix3d& inverse) {
  const double d0 = a(0, 0);
  if (!(d0 > kSmallestPivot * original(0, 0))) return false;
  const double l00 = std::sqrt(d0), l10 = a(1, 0) / l00, l20 = a(2, 0) / l00;
  const double d1 = a(1, 1) - l10 * l10;
  if (!(d1 > kSmallestPivot * original(1, 1))) return false;
  const double l11 = std::sqrt(d1), l21 = (a(2, 1) - l20 * l10) / l11;
  const double d2 = a(2, 2) - l20 * l20 - l21 * l21;
  if (!(d2 > kSmallestPivot * original(2, 2))) return false;
  const double i00 = 1 / l00, i11 = 1 / l11, i22 = 1 / std::sqrt(d2);
  const double i10 = -l10 * i00 * i11;
  inverse << i00, 0, 0, i10, i11, 0, -(l20 * i00 + l21 * i10) * i22, -l21 * i11 * i22, i22;
  return true;
}

}  // namespace

/// The permuted lower triangle by rows, repetitions sharing a slot.
void BlockCholesky::storeByRows(const std::vector<std::pair<int, int>>& blocks) {
  struct Entry {
    int row, column, block;
    bool transposed;
  };
  std::vector<Entry> entries;
  entries.reserve(blocks.size());
  for (size_t b = 0; b < blocks.size(); ++b) {
    const int row = position_[at(blocks[b].first)], column = position_[at(blocks[b].second)];
    entries.push_back({std::max(row, column), std::min(row, column), static_cast<int>(b), row < column});
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.row != b.row ? a.row < b.row : a.column != b.column ? a.column < b.column : a.block < b.block;
  });
  slots_.resize(blocks.size());
  value_column_.clear();
  value_start_.assign(at(size()) + 1, 0);
  int last_row = -1;
  for (const Entry& entry : entries) {
    if (entry.row != last_row || entry.column != value_column_.back()) {
      value_column_.push_back(entry.column);
      ++value_start_[at(entry.row) + 1];
      last_row = entry.row;
    }
    slots_[at(entry.block)] = {static_cast<int>(value_column_.size()) - 1, entry.transposed};
  }
  std::partial_sum(value_start_.begin(), value_start_.end(), value_start_.begin());
}

/// Elimination tree and rows of the factor (Davis 2006, sections 4.1 and 4.2). How many entries each column
/// has.
std::vector<int> BlockCholesky::eliminate() {
  parent_.assign(at(size()), -1);
  std::vector<int> ancestor(at(size()), -1), seen(at(size()), -1), count(at(size()), 0);
  row_start_.assign(1, 0);
  row_entries_.clear();
  for (int k = 0; k < size(); ++k) {
    seen[at(k)] = k;
    for (int v = value_start_[at(k)]; v < value_start_[at(k) + 1]; ++v)
      for (int i = value_column_[at(v)], next = 0; i != -1 && i < k; i = next) {
        next = ancestor[at(i)];
        ancestor[at(i)] = k;
        if (next == -1) parent_[at(i)] = k;
      }
    const auto row_begin = static_cast<long>(row_entries_.size());
    for (int v = value_start_[at(k)]; v < value_start_[at(k) + 1]; ++v)
      for (int i = value_column_[at(v)]; seen[at(i)] != k; i = parent_[at(i)]) {
        seen[at(i)] = k;
        row_entries_.push_back({i, count[at(i)]++});
      }
    std::sort(row_entries_.begin() + row_begin, row_entries_.end(),
              [](const RowEntry& a, const RowEntry& b) { return a.column < b.column; });
    row_start_.push_back(static_cast<int>(row_entries_.size()));
  }
  return count;
}

/// The factor's entries, listed by rows so far, into columns.
void BlockCholesky::listByColumns(const std::vector<int>& count) {
  column_start_.assign(at(size()) + 1, 0);
  std::partial_sum(count.begin(), count.end(), column_start_.begin() + 1);
  row_of_.resize(row_entries_.size());
  for (int k = 0; k < size(); ++k)
    for (int r = row_start_[at(k)]; r < row_start_[at(k) + 1]; ++r) {
      RowEntry& entry = row_entries_[at(r)];
      entry.at += column_start_[at(entry.column)];
      row_of_[at(entry.at)] = k;
    }
}

void BlockCholesky::analyse(int size, const std::vector<std::pair<int, int>>& blocks) {
  order_ = minimumDegreeOrder(size, blocks);
  position_.assign(at(size), 0);
  for (int k = 0; k < size; ++k) position_[at(order_[at(k)])] = k;
  storeByRows(blocks);
  listByColumns(eliminate());
  diagonal_.resize(at(size));
  values_.resize(value_column_.size());
  factor_.resize(row_of_.size());
  inverse_pivot_.resize(at(size));
  work_.resize(at(size));
  setZero();
}

void BlockCholesky::setZero() {
  std::fill(diagonal_.begin(), diagonal_.end(), Eigen::Matrix3d::Zero());
  std::fill(values_.begin(), values_.end(), Eigen::Matrix3d::Zero());
}

bool BlockCholesky::factorize(double damping) {
  for (int k = 0; k < size(); ++k) {
    const int row_begin = row_start_[at(k)], row_end = row_start_[at(k) + 1];
    for (int r = row_begin; r < row_end; ++r) work_[at(row_entries_[at(r)].column)].setZero();
    for (int v = value_start_[at(k)]; v < value_start_[at(k) + 1]; ++v)
      work_[at(value_column_[at(v)])] = values_[at(v)];
    Eigen::Matrix3d pivot = diagonal_[at(k)];
    pivot.diagonal() *= 1 + damping;
    const Eigen::Matrix3d original = pivot;
    for (int r = row_begin; r < row_end; ++r) {
      const RowEntry entry = row_entries_[at(r)];
      const int j = entry.column;
      Eigen::Matrix3d& L_kj = factor_[at(entry.at)];
      L_kj.noalias() = work_[at(j)] * inverse_pivot_[at(j)].transpose();
      for (int p = column_start_[at(j)]; p < entry.at; ++p)
        work_[at(row_of_[at(p)])].noalias() -= L_kj * factor_[at(p)].transpose();
      pivot.noalias() -= L_kj * L_kj.transpose();
    }
    if (!invertPivot(pivot, original, inverse_pivot_[at(k)])) return false;
  }
  return true;
}

void BlockCholesky::solve(std::vector<Eigen::Vector3d>& b) const {
  std::vector<Eigen::Vector3d> y(b.size());
  for (int k = 0; k < size(); ++k) y[at(k)] = b[at(order_[at(k)])];
  for (int j = 0; j < size(); ++j) {
    y[at(j)] = inverse_pivot_[at(j)] * y[at(j)];
    for (int p = column_start_[at(j)]; p < column_start_[at(j) + 1]; ++p)
      y[at(row_of_[at(p)])].noalias() -= factor_[at(p)] * y[at(j)];
  }
  for (int j = size() - 1; j >= 0; --j) {
    Eigen::Vector3d sum = y[at(j)];
    for (int p = column_start_[at(j)]; p < column_start_[at(j) + 1]; ++p)
      sum.noalias() -= factor_[at(p)].transpose() * y[at(row_of_[at(p)])];
    y[at(j)].noalias() = inverse_pivot_[at(j)].transpose() * sum;
  }
  for (int k = 0; k < size(); ++k) b[at(order_[at(k)])] = y[at(k)];
}

BlockCholesky::HalfColumn BlockCholesky::halfColumn(int row) const {
  HalfColumn out;
  const int first = position_[at(row)];
  for (int j = first; j != -1; j = parent_[at(j)]) out.rows.push_back(j);
  // The rows that a column of the factor names are all on the way to the root (Davis 2006, section 4.1).
  std::vector<Eigen::Matrix3d> sums(out.rows.size(), Eigen::Matrix3d::Zero());
  sums[0].setIdentity();
  out.blocks.reserve(out.rows.size());
  for (size_t n = 0; n < out.rows.size(); ++n) {
    const int j = out.rows[n];
    out.blocks.push_back(inverse_pivot_[at(j)] * sums[n]);
    size_t m = n;
    for (int p = column_start_[at(j)]; p < column_start_[at(j) + 1]; ++p) {
      while (out.rows[m] != row_of_[at(p)]) ++m;
      sums[m].noalias() -= factor_[at(p)] * out.blocks[n];
    }
  }
  return out;
}

Eigen::Matrix3d BlockCholesky::inverseBlock(const HalfColumn& a, const HalfColumn& b) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (size_t i = 0, j = 0; i < a.rows.size() && j < b.rows.size();) {
    if (a.rows[i] == b.rows[j])
      sum.noalias() += a.blocks[i++].transpose() * b.blocks[j++];
    else if (a.rows[i] < b.rows[j])
      ++i;
    else
      ++j;
  }
  return sum;
}

BlockCholesky::SparseInverse BlockCholesky::sparseInverse() const {
  std::vector<Eigen::Matrix3d> diagonal(at(size()));  // in the order of elimination
  std::vector<Eigen::Matrix3d> inverse(factor_.size());
  std::vector<int> place(at(size()), -1);  // of a row within column j, by p
  for (int j = size() - 1; j >= 0; --j) {
    const int begin = column_start_[at(j)], end = column_start_[at(j) + 1];
    const Eigen::Matrix3d& pivot = inverse_pivot_[at(j)];
    for (int p = begin; p < end; ++p) {
      place[at(row_of_[at(p)])] = p;
      inverse[at(p)].setZero();
    }
    // sum over k of inverse(i, k) L(k, j), each unordered pair of rows met once, in the column of the
    // smaller.
    for (int p = begin; p < end; ++p) {
      const int i = row_of_[at(p)];
      inverse[at(p)].noalias() -= diagonal[at(i)] * factor_[at(p)];
      for (int q = column_start_[at(i)]; q < column_start_[at(i) + 1]; ++q) {
        const int other = place[at(row_of_[at(q)])];
        if (other < 0) continue;
        inverse[at(other)].noalias() -= inverse[at(q)] * factor_[at(p)];
        inverse[at(p)].noalias() -= inverse[at(q)].transpose() * factor_[at(other)];
      }
    }
    Eigen::Matrix3d sum = pivot.transpose();
    for (int p = begin; p < end; ++p) {
      inverse[at(p)] = (inverse[at(p)] * pivot).eval();
      sum.noalias() -= inverse[at(p)].transpose() * factor_[at(p)];
      place[at(row_of_[at(p)])] = -1;
    }
    diagonal[at(j)].noalias() = sum * pivot;
  }
  SparseInverse out;
  out.diagonal.resize(diagonal.size());
  for (int k = 0; k < size(); ++k) out.diagonal[at(order_[at(k)])] = diagonal[at(k)];
  // Every entry of the matrix is one of the factor's pattern.
  std::vector<Eigen::Matrix3d> at_value(values_.size());
  for (int k = 0; k < size(); ++k) {
    int r = row_start_[at(k)];
    for (int v = value_start_[at(k)]; v < value_start_[at(k) + 1]; ++v) {
      while (row_entries_[at(r)].column != value_column_[at(v)]) ++r;
      at_value[at(v)] = inverse[at(row_entries_[at(r)].at)];
    }
  }
  out.blocks.reserve(slots_.size());
  for (const Slot slot : slots_) {
    out.blocks.push_back(at_value[at(slot.index)]);
    if (slot.transposed) out.blocks.back().transposeInPlace();
  }
  return out;
}

}  // namespace slam::posegraph

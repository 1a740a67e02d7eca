#include <algorithm>
#include <map>

#include "libslam/sparse/block_cholesky.h"
#include "libslam/sparse/blocks.h"

namespace slam::sparse {
namespace {

using Eigen::Matrix3d;

/// Three columns of scalars times a lower triangular block.
void timesLower(const double* column, long height, long rows, const Matrix3d& lower, double* out,
                long out_height) {
  const double *c0 = column, *c1 = column + height, *c2 = column + 2 * height;
  for (long r = 0; r < rows; ++r) {
    out[r] = c0[r] * lower(0, 0) + c1[r] * lower(1, 0) + c2[r] * lower(2, 0);
    out[r + out_height] = c1[r] * lower(1, 1) + c2[r] * lower(2, 1);
    out[r + 2 * out_height] = c2[r] * lower(2, 2);
  }
}

}  // namespace

BlockCholesky::HalfColumn BlockCholesky::halfColumn(int row) const {
  const int first = elimination_.position(row);
  std::map<int, Matrix3d> sums;  // of the columns to come
  sums[first].setIdentity();
  HalfColumn out;
  while (!sums.empty()) {
    const int k = sums.begin()->first;
    const Matrix3d block = inverse_pivot_[at(k)] * sums.begin()->second;
    sums.erase(sums.begin());
    out.rows.push_back(k);
    out.blocks.push_back(block);
    const int s = elimination_.supernodeOf(k);
    const auto& supernode = elimination_.supernode(s);
    const long height = panels_[at(s)].height;
    const double* column = &factor_[panels_[at(s)].begin] + height * 3 * (k - supernode.first);
    const auto take = [&](int r, int place) {
      const auto [known, is_new] = sums.try_emplace(r, Matrix3d::Zero());
      known->second.noalias() -= blockAt(column + 3L * place, height) * block;
    };
    for (int r = k + 1; r < supernode.first + supernode.width; ++r) take(r, r - supernode.first);
    for (int r = 0; r < supernode.below(); ++r)
      take(elimination_.rows()[at(supernode.rows_begin + r)], supernode.width + r);
  }
  return out;
}

Matrix3d BlockCholesky::inverseBlock(const HalfColumn& a, const HalfColumn& b) {
  Matrix3d sum = Matrix3d::Zero();
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

/// What of the inverse is known of the rows below supernode s, into the square of its whole height.
void BlockCholesky::gatherBelow(int s, const std::vector<double>& inverse, double* square) const {
  const auto& supernode = elimination_.supernode(s);
  const long height = panels_[at(s)].height, width = supernode.width;
  for (int u = supernode.updates_begin; u < supernode.updates_end; ++u) {
    const auto& update = elimination_.updates()[at(u)];
    const Panel& target = panels_[at(update.target)];
    for (int j = update.from; j < update.to; ++j) {
      const int* places = &elimination_.places()[at(update.places_begin + j - update.from)];
      const double* column = &inverse[target.begin + at(target.height * 3L * places[0])];
      for (int i = j; i < supernode.below(); ++i) {
        const auto block = blockAt(column + 3L * places[i - j], target.height);
        blockAt(square + 3 * (width + i) + height * 3 * (width + j), height) = block;
        blockAt(square + 3 * (width + j) + height * 3 * (width + i), height) = block.transpose();
      }
    }
  }
}

/// Fills what is missing of the square: its first columns, the last of them first. `column`: room for three.
void BlockCholesky::invertPanel(int s, double* square, double* column) const {
  const auto& supernode = elimination_.supernode(s);
  const long height = panels_[at(s)].height;
  const double* const panel = &factor_[panels_[at(s)].begin];
  for (long b = supernode.width - 1; b >= 0; --b) {
    const Matrix3d& pivot = inverse_pivot_[at(supernode.first + b)];
    const long first = 3 * (b + 1), rows = height - first;
    timesLower(panel + first + height * 3 * b, height, rows, pivot, column, rows);
    double* const out = square + height * 3 * b;
    std::fill_n(out, 3 * height, 0);
    takeOffProduct(square + first + height * first, height, rows / 3, {column, rows, 1}, rows, out + first,
                   height, [](long i) { return i; });
    Matrix3d corner = pivot.transpose() * pivot;
    for (long r = 0; r < rows; r += 3) {
      const auto block = blockAt(out + first + r, height);
      corner.noalias() -= block.transpose() * blockAt(static_cast<const double*>(column) + r, rows);
      blockAt(square + 3 * b + height * (first + r), height) = block.transpose();
    }
    blockAt(out + 3 * b, height) = corner;
  }
}

BlockCholesky::SparseInverse BlockCholesky::sparseInverse() const {
  std::vector<double> inverse(factor_.size());  // in the factor's places
  long highest = 0;
  for (const Panel& panel : panels_) highest = std::max(highest, panel.height);
  std::vector<double> square(at(highest * highest)), column(at(3 * highest));
  for (int s = static_cast<int>(panels_.size()) - 1; s >= 0; --s) {
    gatherBelow(s, inverse, square.data());
    invertPanel(s, square.data(), column.data());
    const long count = panels_[at(s)].height * 3 * elimination_.supernode(s).width;
    std::copy_n(square.begin(), count, inverse.begin() + static_cast<long>(panels_[at(s)].begin));
  }
  SparseInverse out;
  out.diagonal.resize(diagonal_.size());
  for (int k = 0; k < size(); ++k)
    out.diagonal[at(elimination_.rowAt(k))] =
        blockAt(&inverse[placeOf(k, k)], panels_[at(elimination_.supernodeOf(k))].height);
  out.blocks.reserve(slots_.size());
  for (const Slot slot : slots_) {
    out.blocks.emplace_back(blockAt(&inverse[value_places_[at(slot.index)]], value_heights_[at(slot.index)]));
    if (slot.transposed) out.blocks.back().transposeInPlace();
  }
  return out;
}

}  // namespace slam::sparse

#include "libslam/sparse/block_cholesky.h"
#include "libslam/sparse/blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace slam::sparse {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Memory that is touched for the first time takes the system as long as so many multiplications per scalar:
/// a page takes it some microseconds.
constexpr double kWorkPerNewScalar = 30;
constexpr size_t kScalarsAtOnce = 4096;
/// The factor is read twice, forth and back.
constexpr double kWorkPerScalarSolved = 15;

/// A pivot below this share of the diagonal entry that it came from is rounding.
constexpr double kSmallestPivot = 1e-14;

/// Inverse of the lower Cholesky factor of a block. `original`: the diagonal before anything was taken off
/// it. False when not positive definite.
bool invertPivot(const Matrix3d& a, const Vector3d& original, Matrix3d& inverse) {
  const double d0 = a(0, 0);
  if (!(d0 > kSmallestPivot * original[0])) return false;
  const double l00 = std::sqrt(d0), l10 = a(1, 0) / l00, l20 = a(2, 0) / l00;
  const double d1 = a(1, 1) - l10 * l10;
  if (!(d1 > kSmallestPivot * original[1])) return false;
  const double l11 = std::sqrt(d1), l21 = (a(2, 1) - l20 * l10) / l11;
  const double d2 = a(2, 2) - l20 * l20 - l21 * l21;
  if (!(d2 > kSmallestPivot * original[2])) return false;
  const double i00 = 1 / l00, i11 = 1 / l11, i22 = 1 / std::sqrt(d2);
  const double i10 = -l10 * i00 * i11;
  inverse << i00, 0, 0, i10, i11, 0, -(l20 * i00 + l21 * i10) * i22, -l21 * i11 * i22, i22;
  return true;
}

/// Three columns of scalars times the transpose of a lower triangular block.
void timesTransposed(double* column, long height, long rows, const Matrix3d& lower) {
  double *c0 = column, *c1 = column + height, *c2 = column + 2 * height;
  for (long r = 0; r < rows; ++r) {
    c2[r] = c0[r] * lower(2, 0) + c1[r] * lower(2, 1) + c2[r] * lower(2, 2);
    c1[r] = c0[r] * lower(1, 0) + c1[r] * lower(1, 1);
    c0[r] *= lower(0, 0);
  }
}

}  // namespace

/// Gives repeated blocks one value each: the pairs that there are.
std::vector<std::pair<int, int>> BlockCholesky::listValues(int size,
                                                           const std::vector<std::pair<int, int>>& blocks) {
  std::vector<int> begin(at(size) + 2, 0), by_first(blocks.size()), value_of(at(size), -1);
  for (const auto& [a, b] : blocks) ++begin[at(std::min(a, b)) + 2];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  for (size_t b = 0; b < blocks.size(); ++b)
    by_first[at(begin[at(std::min(blocks[b].first, blocks[b].second)) + 1]++)] = static_cast<int>(b);
  std::vector<std::pair<int, int>> pairs;
  slots_.resize(blocks.size());
  for (int first = 0; first < size; ++first) {
    const int known = static_cast<int>(pairs.size());
    for (int i = begin[at(first)]; i < begin[at(first) + 1]; ++i) {
      const auto& [a, b] = blocks[at(by_first[at(i)])];
      int& value = value_of[at(std::max(a, b))];
      if (value < known) {
        value = static_cast<int>(pairs.size());
        pairs.emplace_back(first, std::max(a, b));
      }
      slots_[at(by_first[at(i)])].index = value;
    }
  }
  return pairs;
}

/// Gives every value its place in the factor.
void BlockCholesky::placeValues() {
  values_.resize(pairs_.size());
  value_places_.clear();
  value_places_.reserve(pairs_.size());
  value_heights_.clear();
  value_heights_.reserve(pairs_.size());
  for (const auto& [a, b] : pairs_) {
    const int row = std::max(elimination_.position(a), elimination_.position(b)),
              column = std::min(elimination_.position(a), elimination_.position(b));
    value_places_.push_back(placeOf(row, column));
    value_heights_.push_back(panels_[at(elimination_.supernodeOf(column))].height);
  }
  pairs_ = {};
  has_places_ = true;
}

/// Of a block of the factor. REQUIRES row >= column.
size_t BlockCholesky::placeOf(int row, int column) const {
  const int s = elimination_.supernodeOf(column);
  const Panel& panel = panels_[at(s)];
  return panel.begin + at(3L * elimination_.placeIn(s, row) +
                          panel.height * 3L * (column - elimination_.supernode(s).first));
}

void BlockCholesky::analyse(int size, const std::vector<std::pair<int, int>>& blocks) {
  pairs_ = listValues(size, blocks);
  has_places_ = false;
  elimination_ = Elimination(size, pairs_);
  for (size_t b = 0; b < blocks.size(); ++b)
    slots_[b].transposed = elimination_.position(blocks[b].first) < elimination_.position(blocks[b].second);
  panels_.clear();
  scalars_ = 0;
  for (const auto& supernode : elimination_.supernodes()) {
    const long height = 3L * (supernode.width + supernode.below());
    panels_.push_back({scalars_, height});
    scalars_ += at(height * 3 * supernode.width);
  }
  factor_.clear();
  factor_.reserve(scalars_);
  diagonal_.resize(at(size));
  inverse_pivot_.resize(at(size));
}

void BlockCholesky::setZero() {
  if (!has_places_) placeValues();
  std::fill(diagonal_.begin(), diagonal_.end(), Matrix3d::Zero());
  std::fill(values_.begin(), values_.end(), Matrix3d::Zero());
}

/// Room for the factor, zero, while there is work; true when all is there. Memory that is new is touched
/// here, not where it is reserved.
bool BlockCholesky::makeRoom(double& work) {
  while (factor_.size() < scalars_ && work > 0) {
    const size_t more = std::min(kScalarsAtOnce, scalars_ - factor_.size());
    factor_.resize(factor_.size() + more, 0);
    work -= kWorkPerNewScalar * static_cast<double>(more);
  }
  return factor_.size() == scalars_;
}

/// The matrix where its factor will stand.
void BlockCholesky::setPanels() {
  for (int k = 0; k < size(); ++k) {
    auto block = blockAt(&factor_[placeOf(k, k)], panels_[at(elimination_.supernodeOf(k))].height);
    block = diagonal_[at(k)];
    block.diagonal() *= 1 + damping_;
  }
  for (size_t v = 0; v < values_.size(); ++v)
    blockAt(&factor_[value_places_[v]], value_heights_[v]) = values_[v];
}

/// Once all before it were taken off.
bool BlockCholesky::factorizePanel(int s) {
  const auto& supernode = elimination_.supernode(s);
  const long height = panels_[at(s)].height;
  double* const panel = &factor_[panels_[at(s)].begin];
  for (int b = 0; b < supernode.width; ++b) {
    double* const column = panel + height * 3 * b + 3L * b;
    const long rows = height / 3 - b;
    takeOffProduct(panel + 3L * b, height, rows, {panel + 3L * b, 1, height}, 3L * b, column, height,
                   [](long i) { return i; });
    const int k = supernode.first + b;
    const Vector3d original = (1 + damping_) * diagonal_[at(k)].diagonal();
    if (!invertPivot(blockAt(column, height), original, inverse_pivot_[at(k)])) return false;
    timesTransposed(column + 3, height, 3 * (rows - 1), inverse_pivot_[at(k)]);
  }
  return true;
}

/// Takes a factorised panel off the columns that its rows are.
void BlockCholesky::update(int s) {
  const auto& supernode = elimination_.supernode(s);
  const long height = panels_[at(s)].height;
  const double* const below = &factor_[panels_[at(s)].begin] + 3L * supernode.width;
  for (int u = supernode.updates_begin; u < supernode.updates_end; ++u) {
    const auto& update = elimination_.updates()[at(u)];
    const Panel& target = panels_[at(update.target)];
    for (int j = update.from; j < update.to; ++j) {
      const int* places = &elimination_.places()[at(update.places_begin + j - update.from)];
      takeOffProduct(below + 3L * j, height, supernode.below() - j, {below + 3L * j, 1, height},
                     3L * supernode.width, &factor_[target.begin + at(target.height * 3L * places[0])],
                     target.height, [places](long i) { return long{places[i]}; });
    }
  }
}

/// Multiplications that a supernode costs, about; whole ones.
double BlockCholesky::workOf(int s) const {
  const double width = 3.0 * elimination_.supernode(s).width, below = 3.0 * elimination_.supernode(s).below();
  return std::floor(width * (width * width / 6 + width * below / 2 + below * below / 2));
}

void BlockCholesky::beginFactorization(double damping) {
  damping_ = damping;
  next_ = kNothingSet;
  std::fill(factor_.begin(), factor_.end(), 0);
}

BlockCholesky::Progress BlockCholesky::advance(double& work) {
  const int count = static_cast<int>(panels_.size());
  if (next_ == kNothingSet) {
    if (!makeRoom(work)) return Progress::kGoing;
    setPanels();
    next_ = 0;
  }
  while (next_ < count) {
    if (!factorizePanel(next_)) return Progress::kFailed;
    update(next_);
    work -= workOf(next_++);
    if (work <= 0) break;
  }
  return next_ < count ? Progress::kGoing : Progress::kDone;
}

bool BlockCholesky::factorize(double damping) {
  beginFactorization(damping);
  double unlimited = std::numeric_limits<double>::infinity();
  return advance(unlimited) == Progress::kDone;
}

bool BlockCholesky::factorizeRaised() {
  constexpr double kFirst = 1e-14;
  bool is_done = factorize();
  for (double damping = kFirst; !is_done && damping < 1; damping *= 10) is_done = factorize(damping);
  return is_done;
}

double BlockCholesky::workOfSolving() const {
  return kWorkPerScalarSolved * static_cast<double>(scalars_);
}

/// Calls visit(row, block of the factor) for every block below the diagonal of column c of supernode s.
template <class Visit>
void BlockCholesky::forColumn(int s, int c, const Visit& visit) const {
  const auto& supernode = elimination_.supernode(s);
  const long height = panels_[at(s)].height;
  const double* column = &factor_[panels_[at(s)].begin] + height * 3 * c;
  for (int r = c + 1; r < supernode.width; ++r) visit(supernode.first + r, blockAt(column + 3L * r, height));
  for (int r = 0; r < supernode.below(); ++r)
    visit(elimination_.rows()[at(supernode.rows_begin + r)],
          blockAt(column + 3L * (supernode.width + r), height));
}

/// L^-T times y, in place; by columns.
template <class Block>
void BlockCholesky::solveUpper(std::vector<Block>& y) const {
  for (int s = static_cast<int>(panels_.size()) - 1; s >= 0; --s)
    for (int c = elimination_.supernode(s).width - 1; c >= 0; --c) {
      const int k = elimination_.supernode(s).first + c;
      Block sum = y[at(k)];
      forColumn(s, c, [&](int row, const ConstBlockRef& block) {
        sum.noalias() -= block.transpose() * y[at(row)];
      });
      y[at(k)].noalias() = inverse_pivot_[at(k)].transpose() * sum;
    }
}

void BlockCholesky::solve(std::vector<Vector3d>& b) const {
  std::vector<Vector3d> y(b.size());
  for (int k = 0; k < size(); ++k) y[at(k)] = b[at(elimination_.rowAt(k))];
  const int count = static_cast<int>(panels_.size());
  for (int s = 0; s < count; ++s)
    for (int c = 0; c < elimination_.supernode(s).width; ++c) {
      const int k = elimination_.supernode(s).first + c;
      const Vector3d value = inverse_pivot_[at(k)] * y[at(k)];
      y[at(k)] = value;
      forColumn(s, c, [&](int row, const ConstBlockRef& block) { y[at(row)].noalias() -= block * value; });
    }
  solveUpper(y);
  for (int k = 0; k < size(); ++k) b[at(elimination_.rowAt(k))] = y[at(k)];
}

void BlockCholesky::spread(std::vector<Columns>& columns) const {
  std::vector<Columns> y(columns.size());
  for (int k = 0; k < size(); ++k) y[at(k)] = columns[at(elimination_.rowAt(k))];
  solveUpper(y);
  for (int k = 0; k < size(); ++k) columns[at(elimination_.rowAt(k))] = y[at(k)];
}

}  // namespace slam::sparse

#include "libslam/sparse/elimination.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <numeric>

namespace slam::sparse {
namespace {

/// A supernode may be joined with the next if it is no wider than this, or if no more of what is stored are
/// zeros than that.
constexpr int kNarrow = 2, kWide = 16;
constexpr double kZeros = 0.25, kZerosOfWide = 0.08;

size_t at(int i) {
  return static_cast<size_t>(i);
}

std::vector<int> minimumDegreeOrder(int size, const std::vector<std::pair<int, int>>& entries) {
  Eigen::SparseMatrix<float> pattern(size, size);
  std::vector<int> count(at(size), 1);
  for (const auto& [a, b] : entries) ++count[at(std::min(a, b))];
  pattern.reserve(count);
  for (int i = 0; i < size; ++i) pattern.insert(i, i) = 1;
  for (const auto& [a, b] : entries) pattern.insert(std::max(a, b), std::min(a, b)) = 1;
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(pattern.selfadjointView<Eigen::Lower>(), permutation);
  const auto& indices = permutation.indices();
  return {indices.data(), indices.data() + indices.size()};
}

std::vector<int> inverted(const std::vector<int>& order) {
  std::vector<int> position(order.size());
  for (size_t k = 0; k < order.size(); ++k) position[at(order[k])] = static_cast<int>(k);
  return position;
}

/// Blocks that a supernode stores.
double stored(double width, double below) {
  return width * (width + 1) / 2 + width * below;
}

}  // namespace

Elimination::Elimination(int size, const std::vector<std::pair<int, int>>& entries)
    : order_(minimumDegreeOrder(size, entries)), position_(inverted(order_)) {
  const Lists lower = lowerRows(entries);
  const std::vector<int> parent = tree(lower);
  const std::vector<int> before = orderByTree(parent);
  gatherSupernodes(columnsOfFactor(lower, parent, before));
  listUpdates();
}

/// Of each row, the columns before the diagonal.
Elimination::Lists Elimination::lowerRows(const std::vector<std::pair<int, int>>& entries) const {
  Lists lower;
  lower.begin.assign(order_.size() + 2, 0);
  for (const auto& [a, b] : entries) ++lower.begin[at(std::max(position(a), position(b))) + 2];
  std::partial_sum(lower.begin.begin(), lower.begin.end(), lower.begin.begin());
  lower.numbers.resize(entries.size());
  for (const auto& [a, b] : entries) {
    const int row = std::max(position(a), position(b));
    lower.numbers[at(lower.begin[at(row) + 1]++)] = std::min(position(a), position(b));
  }
  lower.begin.pop_back();
  return lower;
}

/// The elimination tree: each column's parent, -1 at a root (Davis 2006, section 4.1).
std::vector<int> Elimination::tree(const Lists& lower) {
  const int size = static_cast<int>(lower.begin.size()) - 1;
  std::vector<int> parent(at(size), -1), ancestor(at(size), -1);
  for (int k = 0; k < size; ++k)
    for (int e = lower.begin[at(k)]; e < lower.begin[at(k) + 1]; ++e)
      for (int i = lower.numbers[at(e)], next = 0; i != -1 && i < k; i = next) {
        next = ancestor[at(i)];
        ancestor[at(i)] = k;
        if (next == -1) parent[at(i)] = k;
      }
  return parent;
}

/// Makes every column follow its children, which changes nothing else. Where each was before.
std::vector<int> Elimination::orderByTree(const std::vector<int>& parent) {
  const int size = static_cast<int>(parent.size());
  std::vector<int> first_child(parent.size(), -1), sibling(parent.size(), -1), stack, before;
  for (int k = size - 1; k >= 0; --k) {
    if (parent[at(k)] < 0) continue;
    sibling[at(k)] = first_child[at(parent[at(k)])];
    first_child[at(parent[at(k)])] = k;
  }
  before.reserve(parent.size());
  for (int root = 0; root < size; ++root) {
    if (parent[at(root)] >= 0) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const int k = stack.back();
      if (const int child = first_child[at(k)]; child >= 0) {
        first_child[at(k)] = sibling[at(child)];
        stack.push_back(child);
      } else {
        before.push_back(k);
        stack.pop_back();
      }
    }
  }
  std::vector<int> order;
  order.reserve(before.size());
  for (const int k : before) order.push_back(order_[at(k)]);
  order_ = std::move(order);
  position_ = inverted(order_);
  return before;
}

/// Of each column of the factor, the rows below the diagonal, ascending (Davis 2006, section 4.2). `lower`
/// and `parent` are counted as before.
Elimination::Lists Elimination::columnsOfFactor(const Lists& lower, const std::vector<int>& parent,
                                                const std::vector<int>& before) {
  const std::vector<int> after = inverted(before);
  std::vector<int> seen(before.size(), -1), rows_begin(1, 0), by_rows;
  Lists columns;
  columns.begin.assign(before.size() + 2, 0);
  for (const int k : before) {
    seen[at(k)] = k;
    for (int e = lower.begin[at(k)]; e < lower.begin[at(k) + 1]; ++e)
      for (int i = lower.numbers[at(e)]; seen[at(i)] != k; i = parent[at(i)]) {
        seen[at(i)] = k;
        by_rows.push_back(after[at(i)]);
        ++columns.begin[at(after[at(i)]) + 2];
      }
    rows_begin.push_back(static_cast<int>(by_rows.size()));
  }
  std::partial_sum(columns.begin.begin(), columns.begin.end(), columns.begin.begin());
  columns.numbers.resize(by_rows.size());
  for (int k = 0; k < size(); ++k)
    for (int e = rows_begin[at(k)]; e < rows_begin[at(k) + 1]; ++e)
      columns.numbers[at(columns.begin[at(by_rows[at(e)]) + 1]++)] = k;
  columns.begin.pop_back();
  entries_ = static_cast<long>(by_rows.size());
  return columns;
}

void Elimination::gatherSupernodes(const Lists& columns) {
  struct Gathered {
    int first, width;
    double zeros;
    int end() const { return first + width; }
  };
  const auto below = [&](const Gathered& one) {
    return columns.begin[at(one.end())] - columns.begin[at(one.end()) - 1];
  };
  const auto firstBelow = [&](const Gathered& one) {
    return columns.numbers.begin() + columns.begin[at(one.end()) - 1];
  };
  std::vector<Gathered> gathered;
  for (int k = 0; k < size(); ++k) {
    Gathered next{k, 1, 0};
    while (!gathered.empty()) {
      const Gathered& last = gathered.back();
      if (below(last) == 0 || *firstBelow(last) >= next.end()) break;  // not its child
      const int width = last.width + next.width;
      const double all = stored(width, below(next));
      const double zeros =
          last.zeros + next.zeros + all - stored(last.width, below(last)) - stored(next.width, below(next));
      if (width > kNarrow && zeros > (width > kWide ? kZerosOfWide : kZeros) * all) break;
      next = {last.first, width, zeros};
      gathered.pop_back();
    }
    gathered.push_back(next);
  }
  supernode_of_.resize(order_.size());
  for (const Gathered& one : gathered) {
    Supernode supernode;
    supernode.first = one.first, supernode.width = one.width;
    supernode.rows_begin = static_cast<int>(rows_.size());
    rows_.insert(rows_.end(), firstBelow(one), firstBelow(one) + below(one));
    supernode.rows_end = static_cast<int>(rows_.size());
    for (int k = one.first; k < one.end(); ++k) supernode_of_[at(k)] = static_cast<int>(supernodes_.size());
    supernodes_.push_back(supernode);
  }
}

void Elimination::listUpdates() {
  for (Supernode& supernode : supernodes_) {
    supernode.updates_begin = static_cast<int>(updates_.size());
    for (int from = 0, to = 0; from < supernode.below(); from = to) {
      const int* rows = &rows_[at(supernode.rows_begin)];
      Update update;
      update.target = supernodeOf(rows[from]);
      const Supernode& target = supernodes_[at(update.target)];
      while (to < supernode.below() && rows[to] < target.first + target.width) ++to;
      update.from = from, update.to = to;
      update.places_begin = static_cast<int>(places_.size());
      for (int i = from, place = target.width; i < supernode.below(); ++i) {
        if (i < to) {
          places_.push_back(rows[i] - target.first);
          continue;
        }
        while (rows_[at(target.rows_begin + place - target.width)] != rows[i]) ++place;
        places_.push_back(place);
      }
      updates_.push_back(update);
    }
    supernode.updates_end = static_cast<int>(updates_.size());
  }
}

int Elimination::placeIn(int s, int row) const {
  const Supernode& one = supernode(s);
  if (row < one.first + one.width) return row - one.first;
  const auto begin = rows_.begin() + one.rows_begin, end = rows_.begin() + one.rows_end;
  return one.width + static_cast<int>(std::lower_bound(begin, end, row) - begin);
}

}  // namespace slam::sparse

#include "libslam/paths/coarse_ways.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace slam::paths {
namespace {

// As PathPlanner: a diagonal step is 7 where a straight one is 5.
constexpr int kStraight = 5, kDiagonal = 7;
constexpr std::size_t kBuckets = 8;  // above the dearest step
constexpr std::array<int, 8> kColumn = {1, 0, -1, 0, 1, -1, -1, 1}, kRow = {0, 1, 0, -1, 1, 1, -1, -1};

/// Of the neighbour at (dc, dr), row by row from below left.
constexpr std::array<std::uint8_t, 9> kBitOf = {1U << 6, 1U << 3, 1U << 7, 1U << 2, 0,
                                                1U << 0, 1U << 5, 1U << 1, 1U << 4};

}  // namespace

CoarseWays::CoarseWays(const PathPlanner& planner, std::size_t most_blocks)
    : node_columns_(planner.nodeColumns()) {
  const double reached = static_cast<double>(planner.reachedCount());
  const int wanted = static_cast<int>(std::ceil(std::sqrt(reached / static_cast<double>(most_blocks))));
  side_ = std::clamp(wanted, 1, std::max(1, static_cast<int>(kMostBlock_m / planner.nodeSide_m() + 1e-9)));
  block_m_ = side_ * planner.nodeSide_m();
  columns_ = (planner.nodeColumns() + side_ - 1) / side_ + 2;
  const int rows = (planner.nodeRows() + side_ - 1) / side_ + 2;
  open_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows), 0);
  const auto isInside = [&](int at) { return at % side_ != 0 && at % side_ != side_ - 1; };
  std::vector<int> block_at(static_cast<std::size_t>(std::max(node_columns_, planner.nodeRows())));
  for (std::size_t i = 0; i < block_at.size(); ++i) block_at[i] = static_cast<int>(i) / side_;
  const auto blockAt = [&](int at) { return block_at[static_cast<std::size_t>(at)]; };
  std::vector<int> all, at_sides;  // columns
  for (int column = 1; column + 1 < node_columns_; ++column) {
    all.push_back(column);
    if (!isInside(column)) at_sides.push_back(column);
  }
  for (int row = 1; row + 1 < planner.nodeRows(); ++row)
    for (const int column : isInside(row) ? at_sides : all) {
      const PathPlanner::Node node = row * node_columns_ + column;
      if (!planner.isReached(node)) continue;
      const std::size_t block =
          static_cast<std::size_t>(blockAt(row) + 1) * static_cast<std::size_t>(columns_) +
          static_cast<std::size_t>(blockAt(column) + 1);
      for (std::size_t d = 0; d < 8; ++d) {
        const int dc = blockAt(column + kColumn[d]) - blockAt(column);
        const int dr = blockAt(row + kRow[d]) - blockAt(row);
        const int neighbour = 3 * (dr + 1) + dc + 1;
        const std::uint8_t bit = kBitOf[static_cast<std::size_t>(neighbour)];
        if ((open_[block] & bit) != bit && planner.isReached(node + kRow[d] * node_columns_ + kColumn[d]))
          open_[block] |= bit;
      }
    }
}

std::size_t CoarseWays::blockOf(PathPlanner::Node node) const {
  const int column = node % node_columns_ / side_ + 1, row = node / node_columns_ / side_ + 1;
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
         static_cast<std::size_t>(column);
}

std::vector<double> CoarseWays::lengths(PathPlanner::Node from,
                                        const std::vector<PathPlanner::Node>& to) const {
  constexpr std::int32_t kFar = std::numeric_limits<std::int32_t>::max();
  std::vector<std::int32_t> cost(open_.size(), kFar);
  std::vector<std::size_t> wanted;
  wanted.reserve(to.size());
  for (const auto node : to) wanted.push_back(blockOf(node));
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  std::size_t waiting = wanted.size(), queued = 1;
  std::array<std::vector<std::size_t>, kBuckets> buckets;
  cost[blockOf(from)] = 0;
  buckets[0].push_back(blockOf(from));
  for (std::int32_t now = 0; queued > 0 && waiting > 0; ++now) {
    auto& bucket = buckets[static_cast<std::size_t>(now) % kBuckets];
    for (const std::size_t block : bucket) {
      if (cost[block] != now) continue;
      waiting -= std::binary_search(wanted.begin(), wanted.end(), block) ? 1U : 0U;
      for (std::size_t d = 0; d < 8; ++d) {
        if ((open_[block] >> d & 1U) == 0) continue;
        const auto next = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(block) +
                                                   std::ptrdiff_t{kRow[d]} * columns_ + kColumn[d]);
        const std::int32_t then = now + (d < 4 ? kStraight : kDiagonal);
        if (then >= cost[next]) continue;
        cost[next] = then;
        buckets[static_cast<std::size_t>(then) % kBuckets].push_back(next);
        ++queued;
      }
    }
    queued -= bucket.size();
    bucket.clear();
  }
  std::vector<double> lengths_m;
  for (const auto node : to) {
    const std::int32_t units = cost[blockOf(node)];
    lengths_m.push_back(units == kFar ? std::numeric_limits<double>::infinity()
                                      : units * block_m_ / kStraight);
  }
  return lengths_m;
}

}  // namespace slam::paths

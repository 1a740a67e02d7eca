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

std::size_t directionOf(int dc, int dr) {
  for (std::size_t d = 0; d < 8; ++d)
    if (kColumn[d] == dc && kRow[d] == dr) return d;
  return 8;
}

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
  for (int row = 1; row + 1 < planner.nodeRows(); ++row)
    for (int column = 1; column + 1 < node_columns_; ++column) {
      const PathPlanner::Node node = row * node_columns_ + column;
      if (!planner.isReached(node)) continue;
      for (std::size_t d = 0; d < 8; ++d) {
        const int dc = (column + kColumn[d]) / side_ - column / side_;
        const int dr = (row + kRow[d]) / side_ - row / side_;
        if ((dc != 0 || dr != 0) && planner.isReached(node + kRow[d] * node_columns_ + kColumn[d]))
          open_[blockOf(node)] |= static_cast<std::uint8_t>(1U << directionOf(dc, dr));
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

#include "libslam/oracle/drive_graph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "libslam/world/clearance.h"

namespace slam::oracle {
namespace {

constexpr int kEdges = 16;
constexpr std::array<std::pair<int, int>, kEdges> kMoves = {{{1, 0},
                                                             {0, 1},
                                                             {-1, 0},
                                                             {0, -1},
                                                             {1, 1},
                                                             {-1, 1},
                                                             {-1, -1},
                                                             {1, -1},
                                                             {2, 1},
                                                             {1, 2},
                                                             {-1, 2},
                                                             {-2, 1},
                                                             {-2, -1},
                                                             {-1, -2},
                                                             {1, -2},
                                                             {2, -1}}};

std::vector<char> floodFrom(const world::Plan& plan, const std::vector<char>& admits,
                            const core::Point2& start_cell) {
  std::vector<char> reached(plan.cells.size(), 0);
  if (!(start_cell.x >= 0 && start_cell.y >= 0 && start_cell.x < plan.columns && start_cell.y < plan.rows))
    return reached;
  const int column = static_cast<int>(start_cell.x), row = static_cast<int>(start_cell.y);
  const auto columns = static_cast<std::size_t>(plan.columns);
  const auto index = [&](int c, int r) {
    return static_cast<std::size_t>(r) * columns + static_cast<std::size_t>(c);
  };
  if (plan.at(column, row) == world::Cell::kOccupied) return reached;
  std::vector<std::size_t> open;
  const auto enter = [&](std::size_t cell) {
    if (admits[cell] && !reached[cell]) reached[cell] = 1, open.push_back(cell);
  };
  for (int dr = -1; dr <= 1; ++dr)
    for (int dc = -1; dc <= 1; ++dc)
      if (plan.contains(column + dc, row + dr)) enter(index(column + dc, row + dr));
  while (!open.empty()) {
    const std::size_t cell = open.back();
    open.pop_back();
    if (cell % columns > 0) enter(cell - 1);
    if (cell % columns + 1 < columns) enter(cell + 1);
    if (cell >= columns) enter(cell - columns);
    if (cell + columns < reached.size()) enter(cell + columns);
  }
  reached[index(column, row)] = 1;
  return reached;
}

}  // namespace

int DriveGraph::blockFor(const world::Plan& plan, std::size_t most_nodes) {
  int block = 2;
  while (plan.cells.size() / static_cast<std::size_t>(block * block) > most_nodes) ++block;
  return block;
}

DriveGraph::DriveGraph(const world::Plan& plan, const core::Point2& start_world, double radius_m,
                       int block_cells)
    : plan_(plan),
      block_(std::max(1, block_cells)),
      blocks_across_((plan.columns + block_ - 1) / block_),
      blocks_up_((plan.rows + block_ - 1) / block_) {
  const core::Point2 start = world::pointToCells(plan, start_world);
  auto admits = world::admissibleCells(plan, radius_m / plan.resolution_m);
  reachable_ = floodFrom(plan, admits, start);
  node_of_block_.assign(static_cast<std::size_t>(blocks_across_) * blocks_up_, -1);
  const auto columns = static_cast<std::size_t>(plan.columns);
  const auto blockOf = [&](std::size_t cell) {
    return cell / columns / static_cast<std::size_t>(block_) * static_cast<std::size_t>(blocks_across_) +
           cell % columns / static_cast<std::size_t>(block_);
  };
  // From the middle of its block, in half cells.
  const auto aside = [&](std::size_t cell) {
    const int c = 2 * (static_cast<int>(cell % columns) % block_) + 1 - block_;
    const int r = 2 * (static_cast<int>(cell / columns) % block_) + 1 - block_;
    return c * c + r * r;
  };
  const auto take = [&](std::size_t cell) {
    Node& node = node_of_block_[blockOf(cell)];
    if (node < 0) {
      node = static_cast<Node>(cell_of_.size());
      cell_of_.push_back(cell);
    } else if (node > 0 && aside(cell) < aside(cell_of_[static_cast<std::size_t>(node)])) {
      cell_of_[static_cast<std::size_t>(node)] = cell;
    }
  };
  if (std::none_of(reachable_.begin(), reachable_.end(), [](char c) { return c != 0; })) return;
  take(static_cast<std::size_t>(start.y) * columns + static_cast<std::size_t>(start.x));
  for (std::size_t cell = 0; cell < reachable_.size(); ++cell)
    if (reachable_[cell]) take(cell);
  edges_.assign(cell_of_.size() * kEdges, -1);
  length_m_.assign(cell_of_.size() * kEdges, 0);
  for (Node node = 0; node < static_cast<Node>(cell_of_.size()); ++node)
    for (int e = 0; e < kEdges; ++e) {
      const Node to = neighbour(node, e);
      if (to < 0 || !seesStraight(pointOf(node), pointOf(to))) continue;
      edges_[static_cast<std::size_t>(node) * kEdges + static_cast<std::size_t>(e)] = to;
      length_m_[static_cast<std::size_t>(node) * kEdges + static_cast<std::size_t>(e)] =
          static_cast<float>(core::distance(pointOf(node), pointOf(to)));
    }
}

core::Point2 DriveGraph::pointOf(Node node) const {
  const auto columns = static_cast<std::size_t>(plan_.columns);
  const std::size_t cell = cellOf(node), row = cell / columns;
  return world::cellsToPoint(plan_,
                             {static_cast<double>(cell % columns) + 0.5, static_cast<double>(row) + 0.5});
}

DriveGraph::Node DriveGraph::nodeAt(std::size_t cell) const {
  const auto columns = static_cast<std::size_t>(plan_.columns);
  return node_of_block_[cell / columns / static_cast<std::size_t>(block_) *
                            static_cast<std::size_t>(blocks_across_) +
                        cell % columns / static_cast<std::size_t>(block_)];
}

DriveGraph::Node DriveGraph::neighbour(Node node, int edge) const {
  const std::size_t cell = cellOf(node);
  const auto columns = static_cast<std::size_t>(plan_.columns);
  const int c = static_cast<int>(cell % columns) / block_ + kMoves[static_cast<std::size_t>(edge)].first;
  const int r = static_cast<int>(cell / columns) / block_ + kMoves[static_cast<std::size_t>(edge)].second;
  if (c < 0 || r < 0 || c >= blocks_across_ || r >= blocks_up_) return -1;
  return node_of_block_[static_cast<std::size_t>(r) * blocks_across_ + c];
}

bool DriveGraph::seesStraight(const core::Point2& a_world, const core::Point2& b_world) const {
  const core::Point2 a = world::pointToCells(plan_, a_world), b = world::pointToCells(plan_, b_world);
  const int steps = static_cast<int>(std::ceil(2 * core::distance(a, b)));
  for (int i = 0; i <= steps; ++i) {
    const double s = steps > 0 ? static_cast<double>(i) / steps : 0;
    const int column = static_cast<int>(std::floor(a.x + s * (b.x - a.x)));
    const int row = static_cast<int>(std::floor(a.y + s * (b.y - a.y)));
    if (!plan_.contains(column, row) ||
        !reachable_[static_cast<std::size_t>(row) * static_cast<std::size_t>(plan_.columns) +
                    static_cast<std::size_t>(column)])
      return false;
  }
  return true;
}

DriveGraph::Ways DriveGraph::waysFrom(Node node) const {
  return waysFrom(node, std::vector<float>(size(), std::numeric_limits<float>::infinity()));
}

DriveGraph::Ways DriveGraph::waysFrom(Node node, const std::vector<float>& below_m) const {
  Ways ways;
  ways.length_m.assign(size(), std::numeric_limits<float>::infinity());
  ways.from.assign(size(), kNoEdge);
  using Entry = std::pair<float, Node>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  ways.length_m[static_cast<std::size_t>(node)] = 0;
  open.emplace(0.0F, node);
  while (!open.empty()) {
    const auto [length_m, here] = open.top();
    open.pop();
    if (length_m > ways.length_m[static_cast<std::size_t>(here)]) continue;
    for (std::size_t e = 0; e < kEdges; ++e) {
      const std::size_t edge = static_cast<std::size_t>(here) * kEdges + e;
      if (edges_[edge] < 0) continue;
      const float then_m = length_m + length_m_[edge];
      float& known_m = ways.length_m[static_cast<std::size_t>(edges_[edge])];
      if (then_m >= known_m || then_m >= below_m[static_cast<std::size_t>(edges_[edge])]) continue;
      known_m = then_m;
      ways.from[static_cast<std::size_t>(edges_[edge])] = static_cast<std::uint8_t>(e);
      open.emplace(then_m, edges_[edge]);
    }
  }
  return ways;
}

std::vector<DriveGraph::Node> DriveGraph::way(const Ways& ways, Node node) const {
  std::vector<Node> nodes = {node};
  while (ways.from[static_cast<std::size_t>(node)] != kNoEdge) {
    const auto move = kMoves[ways.from[static_cast<std::size_t>(node)]];
    const std::size_t cell = cellOf(node);
    const auto columns = static_cast<std::size_t>(plan_.columns);
    const int c = static_cast<int>(cell % columns) / block_ - move.first;
    const int r = static_cast<int>(cell / columns) / block_ - move.second;
    node = node_of_block_[static_cast<std::size_t>(r) * blocks_across_ + c];
    nodes.push_back(node);
  }
  std::reverse(nodes.begin(), nodes.end());
  return nodes;
}

}  // namespace slam::oracle

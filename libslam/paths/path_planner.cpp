#include "libslam/paths/path_planner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace slam::paths {
namespace {

// A diagonal step is 7 where a straight one is 5 (1.4 for the root of 2); times a factor in quarters.
constexpr int kStraight = 5, kDiagonal = 7;
constexpr int kOne = PlanningNodes::kOne, kDearest = PlanningNodes::kDearest;
constexpr std::size_t kBuckets = 128;  // above the dearest step, kDiagonal * kDearest = 112
constexpr double kEscape_m = 1.5;
constexpr double kStartRing_m = 0.3;
// Nobody wants to drive where the robot does not fit: leaving such a place costs as the dearest driving.
constexpr double kEscapeFactor = 4;

struct Direction {
  int dc, dr, cost;
};
constexpr std::array<Direction, 8> kDirections = {{{1, 0, kStraight},
                                                   {0, 1, kStraight},
                                                   {-1, 0, kStraight},
                                                   {0, -1, kStraight},
                                                   {1, 1, kDiagonal},
                                                   {-1, 1, kDiagonal},
                                                   {-1, -1, kDiagonal},
                                                   {1, -1, kDiagonal}}};
constexpr std::uint8_t kNoDirection = 255;

}  // namespace

PathPlanner::PathPlanner(const FreeSpace& space, const PlannerOptions& options,
                         const core::Point2& p_map_robot)
    : PathPlanner(space, std::make_shared<PlanningNodes>(space, options), options, p_map_robot) {}

PathPlanner::PathPlanner(const PlanningGround& ground, const PlannerOptions& options,
                         const core::Point2& p_map_robot)
    : PathPlanner(ground.space(), ground.nodes(), options, p_map_robot) {}

PathPlanner::PathPlanner(const FreeSpace& space, std::shared_ptr<const PlanningNodes> nodes,
                         const PlannerOptions& options, const core::Point2& p_map_robot)
    : space_(space),
      options_(options),
      robot_(p_map_robot),
      nodes_(std::move(nodes)),
      per_node_(nodes_->per_node),
      columns_(nodes_->columns),
      rows_(nodes_->rows),
      unit_m_(per_node_ * space.resolution_m / (kStraight * kOne)),
      tight_(nodes_->admitted),
      factor_(nodes_->factor) {
  if (options.tight_start) openStart();
  spread();
  spreadLook();
}

void PathPlanner::openStart() {
  const double tight_m = std::max(options_.radius_m - space_.resolution_m, space_.resolution_m);
  tight_ = clearingSquare(tight_m, space_.resolution_m);
  const int column = space_.columnOf(robot_.x), row = space_.rowOf(robot_.y);
  if (!std::isfinite(robot_.x) || !std::isfinite(robot_.y) || !space_.contains(column, row)) return;
  const Node here = nodeOf(space_.index(column, row));
  const int reach = static_cast<int>(std::ceil(kEscape_m / (per_node_ * space_.resolution_m)));
  for (int r = std::max(1, here / columns_ - reach); r <= std::min(rows_ - 2, here / columns_ + reach); ++r)
    for (int c = std::max(1, here % columns_ - reach); c <= std::min(columns_ - 2, here % columns_ + reach);
         ++c) {
      const Node node = r * columns_ + c;
      if (factor_[static_cast<std::size_t>(node)] == 0 && nodes_->clearance[cellOf(node)] >= tight_ &&
          core::distance(pointOf(node), robot_) <= kEscape_m)
        factor_[static_cast<std::size_t>(node)] = kDearest;
    }
}

std::size_t PathPlanner::cellOf(Node node) const {
  const int cell = nodes_->best_cell[static_cast<std::size_t>(node)];
  const int column = (node % columns_ - 1) * per_node_ + cell % per_node_;
  const int row = (node / columns_ - 1) * per_node_ + cell / per_node_;
  return space_.index(column, row);
}

PathPlanner::Node PathPlanner::nodeOf(std::size_t cell) const {
  const auto width = static_cast<std::size_t>(space_.columns);
  const int column = static_cast<int>(cell % width) / per_node_ + 1;
  const int row = static_cast<int>(cell / width) / per_node_ + 1;
  return row * columns_ + column;
}

/// Two admitted cells of neighbouring nodes may lie a few cells apart, with something between them.
bool PathPlanner::passes(Node a, Node b) const {
  if (per_node_ == 1) return true;
  const int width = space_.columns;
  const auto cell_a = static_cast<int>(cellOf(a)), cell_b = static_cast<int>(cellOf(b));
  const int columns = cell_b % width - cell_a % width, rows = cell_b / width - cell_a / width;
  const int steps = std::max(std::abs(columns), std::abs(rows));
  // A robot that is narrower than the way from one cell to the other: none between may be a wall.
  for (int i = 1; i < steps; ++i)
    if (nodes_->clearance[space_.index(cell_a % width + columns * i / steps,
                                       cell_a / width + rows * i / steps)] == 0)
      return false;
  const auto between =
      space_.index((cell_a % width + cell_b % width) / 2, (cell_a / width + cell_b / width) / 2);
  const bool near_start =
      tight_ < nodes_->admitted && core::distance(space_.centreOf(between), robot_) <= kEscape_m;
  return nodes_->clearance[between] >= (near_start ? tight_ : nodes_->admitted);
}

std::vector<std::pair<PathPlanner::Node, std::int32_t>> PathPlanner::startNodes() const {
  struct Way {
    Node node;
    double distance_m;
  };
  const int column = space_.columnOf(robot_.x), row = space_.rowOf(robot_.y);
  if (!std::isfinite(robot_.x) || !std::isfinite(robot_.y) || !space_.contains(column, row)) return {};
  const Node here = nodeOf(space_.index(column, row));
  if (factor_[static_cast<std::size_t>(here)] != 0) return {{here, 0}};
  std::vector<Way> ways;
  double nearest_m = kEscape_m;
  const int reach = static_cast<int>(std::ceil(kEscape_m / (per_node_ * space_.resolution_m)));
  for (int r = std::max(1, here / columns_ - reach); r <= std::min(rows_ - 2, here / columns_ + reach); ++r)
    for (int c = std::max(1, here % columns_ - reach); c <= std::min(columns_ - 2, here % columns_ + reach);
         ++c) {
      const Node node = r * columns_ + c;
      if (factor_[static_cast<std::size_t>(node)] == 0) continue;
      const core::Point2 p = pointOf(node);
      const double distance_m = core::distance(p, robot_);
      if (distance_m > nearest_m + kStartRing_m) continue;
      const int steps = static_cast<int>(std::ceil(2 * distance_m / space_.resolution_m));
      bool free = true;
      for (int i = 0; i <= steps && free; ++i) {
        const double s = steps ? static_cast<double>(i) / steps : 0;
        free = space_.at({robot_.x + s * (p.x - robot_.x), robot_.y + s * (p.y - robot_.y)}) != kOccupiedCell;
      }
      if (!free) continue;
      ways.push_back({node, distance_m});
      nearest_m = std::min(nearest_m, distance_m);
    }
  std::vector<std::pair<Node, std::int32_t>> starts;
  for (const auto& way : ways)
    if (way.distance_m <= nearest_m + kStartRing_m)
      starts.emplace_back(way.node, static_cast<std::int32_t>(kEscapeFactor * way.distance_m / unit_m_));
  return starts;
}

void PathPlanner::spread() {
  cost_.assign(factor_.size(), kNotReached);
  from_.assign(factor_.size(), kNoDirection);
  const auto starts = startNodes();
  has_start_ = !starts.empty();
  std::array<std::vector<Node>, kBuckets> buckets;
  // The starts' costs span more than the buckets do, so each waits until the wave is at its cost.
  auto waiting = starts;
  std::sort(waiting.begin(), waiting.end(), [](const auto& a, const auto& b) {
    return std::pair(a.second, a.first) < std::pair(b.second, b.first);
  });
  std::array<std::int32_t, 8> step{};
  for (std::size_t d = 0; d < 8; ++d) step[d] = kDirections[d].dr * columns_ + kDirections[d].dc;
  // Only between nodes this near to obstacles can a step cut through something: two cells are at most
  // (2 per_node - 1) root 2 apart, and clearance falls by at most one per cell.
  const double safe = std::sqrt(nodes_->admitted) + 1.5 * per_node_;
  const auto safe_at = static_cast<std::size_t>(safe * safe);
  const std::uint8_t doubtful =
      safe_at < nodes_->factor_of.size() ? nodes_->factor_of[safe_at] : std::uint8_t{kOne};

  std::size_t next_start = 0, in_buckets = 0;
  for (std::int32_t cost = 0; in_buckets > 0 || next_start < waiting.size(); ++cost) {
    auto& bucket = buckets[static_cast<std::size_t>(cost) % kBuckets];
    for (; next_start < waiting.size() && waiting[next_start].second <= cost; ++next_start) {
      const auto node = static_cast<std::size_t>(waiting[next_start].first);
      if (cost_[node] <= cost) continue;
      cost_[node] = cost;
      from_[node] = kNoDirection;
      bucket.push_back(static_cast<Node>(node));
      ++in_buckets;
    }
    // Every step costs something, so nothing is added to the bucket that is being emptied.
    for (const Node node : bucket) {
      if (cost_[static_cast<std::size_t>(node)] != cost) continue;
      ++reached_;
      for (std::uint8_t d = 0; d < 8; ++d) {
        const Node to = node + step[d];
        const int factor = factor_[static_cast<std::size_t>(to)];
        if (factor == 0) continue;
        const std::int32_t reached_at = cost + kDirections[d].cost * factor;
        if (reached_at >= cost_[static_cast<std::size_t>(to)]) continue;
        if (factor >= doubtful && !passes(node, to)) continue;
        cost_[static_cast<std::size_t>(to)] = reached_at;
        from_[static_cast<std::size_t>(to)] = d;
        buckets[static_cast<std::size_t>(reached_at) % kBuckets].push_back(to);
        ++in_buckets;
      }
    }
    in_buckets -= bucket.size();
    bucket.clear();
  }
}

void PathPlanner::spreadLook() {
  look_depth_.assign(factor_.size(), 0);
  const auto most =
      static_cast<std::uint8_t>(std::clamp(options_.look_m / (per_node_ * space_.resolution_m), 0.0, 250.0));
  if (most == 0) return;
  // 1 where only a look can go.
  std::vector<std::uint8_t> open(factor_.size());
  for (std::size_t i = 0; i < open.size(); ++i)
    open[i] = static_cast<std::uint8_t>((cost_[i] == kNotReached) & nodes_->is_free[i]);
  std::vector<Node> wave, next;
  const auto enter = [&](Node node, std::uint8_t depth) {
    for (std::uint8_t d = 0; d < 8; ++d) {
      const Node to = node + kDirections[d].dr * columns_ + kDirections[d].dc;
      const auto i = static_cast<std::size_t>(to);
      if (!open[i] || look_depth_[i] != 0) continue;
      look_depth_[i] = depth;
      from_[i] = d;
      next.push_back(to);
    }
  };
  // A row at a time and without a branch, so that it vectorises: few nodes that are reached have any beside
  // them that are not.
  const auto width = static_cast<std::size_t>(columns_);
  std::vector<std::uint8_t> is_beside(width, 0);
  for (Node row = 1; row + 1 < rows_; ++row) {
    const std::uint8_t* const here = open.data() + static_cast<std::size_t>(row) * width;
    std::uint8_t any = 0;
    for (std::size_t i = 1; i + 1 < width; ++i) {
      const std::uint8_t *const below = here + i - width, *const above = here + i + width;
      is_beside[i] = static_cast<std::uint8_t>(below[-1] | below[0] | below[1] | here[i - 1] | here[i + 1] |
                                               above[-1] | above[0] | above[1]);
      any |= is_beside[i];
    }
    for (Node column = 1; any != 0 && column + 1 < columns_; ++column) {
      const Node node = row * columns_ + column;
      if (is_beside[static_cast<std::size_t>(column)] && cost_[static_cast<std::size_t>(node)] != kNotReached)
        enter(node, 1);
    }
  }
  for (std::uint8_t depth = 2; depth <= most && !next.empty(); ++depth) {
    wave.swap(next);
    next.clear();
    for (const Node node : wave) enter(node, depth);
  }
}

std::optional<PathPlanner::Node> PathPlanner::accessOf(Node node) const {
  while (cost_[static_cast<std::size_t>(node)] == kNotReached) {
    const auto i = static_cast<std::size_t>(node);
    if (look_depth_[i] == 0) return std::nullopt;
    const Direction& d = kDirections[from_[i]];
    node -= d.dr * columns_ + d.dc;
  }
  return node;
}

std::vector<PathPlanner::Node> PathPlanner::way(Node node) const {
  std::vector<Node> nodes = {node};
  while (from_[static_cast<std::size_t>(node)] != kNoDirection) {
    const Direction& d = kDirections[from_[static_cast<std::size_t>(node)]];
    node -= d.dr * columns_ + d.dc;
    nodes.push_back(node);
  }
  std::reverse(nodes.begin(), nodes.end());
  return nodes;
}

double PathPlanner::length(const std::vector<Node>& way) const {
  if (way.empty()) return 0;
  double length_m = core::distance(robot_, pointOf(way.front()));
  const double side_m = per_node_ * space_.resolution_m;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const int step = std::abs(way[i] - way[i - 1]);
    length_m += step == 1 || step == columns_ ? side_m : std::sqrt(2.0) * side_m;
  }
  return length_m;
}

/// Metres of comfortable driving along a straight line, infinity where it comes too near to something.
double PathPlanner::lineCost(const core::Point2& a, const core::Point2& b) const {
  const double length_m = core::distance(a, b);
  const int steps = std::max(1, static_cast<int>(std::ceil(length_m / space_.resolution_m)));
  double sum = 0;
  for (int i = 0; i <= steps; ++i) {
    const double s = static_cast<double>(i) / steps;
    const int column = space_.columnOf(a.x + s * (b.x - a.x)), row = space_.rowOf(a.y + s * (b.y - a.y));
    if (!space_.contains(column, row)) return std::numeric_limits<double>::infinity();
    const int factor =
        nodes_->factor_of[static_cast<std::size_t>(nodes_->clearance[space_.index(column, row)])];
    if (factor == 0) return std::numeric_limits<double>::infinity();
    sum += factor;
  }
  return sum / (steps + 1) / kOne * length_m;
}

std::vector<core::Point2> PathPlanner::shortened(const std::vector<Node>& way) const {
  std::vector<core::Point2> path;
  if (way.empty()) return path;
  // The robot itself may stand where no line is allowed to begin: then it first leaves to the first node.
  core::Point2 here = robot_;
  std::size_t last = 0;
  if (!std::isfinite(lineCost(here, pointOf(way[0])))) {
    here = pointOf(way[0]);
    path.push_back(here);
  }
  const double first_m = cost(way[0]);
  while (last + 1 < way.size()) {
    // From `here`, at way[last], as far along the way as a straight line costs no more.
    std::size_t end = last + 1;
    const double begun_m = last == 0 ? first_m : cost(way[last]);
    for (std::size_t i = last + 2; i < way.size(); ++i) {
      const double tolerance_m = 2 * space_.resolution_m;
      if (lineCost(here, pointOf(way[i])) > cost(way[i]) - begun_m + tolerance_m) break;
      end = i;
    }
    here = pointOf(way[end]);
    path.push_back(here);
    last = end;
  }
  if (path.empty()) path.push_back(pointOf(way.back()));
  return path;
}

}  // namespace slam::paths

#include "libslam/scanmatch/correlative_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libslam/core/elementary.h"

namespace slam::scanmatch {

void LikelihoodPyramid::build(const std::vector<core::Point2>& points, double cell_m, double sigma_m,
                              int levels) {
  cell_m_ = cell_m;
  constexpr int kReach = 3;
  double x_min = 1e300, x_max = -1e300, y_min = 1e300, y_max = -1e300;
  for (const auto& p : points) {
    x_min = std::min(x_min, p.x), x_max = std::max(x_max, p.x);
    y_min = std::min(y_min, p.y), y_max = std::max(y_max, p.y);
  }
  if (points.empty()) x_min = x_max = y_min = y_max = 0;
  origin_ = {std::floor(x_min / cell_m - kReach) * cell_m, std::floor(y_min / cell_m - kReach) * cell_m};
  pad_ = 1 << (levels - 1);
  side_x_ = static_cast<int>(std::ceil((x_max - origin_.x) / cell_m)) + kReach + 1 + pad_;
  side_y_ = static_cast<int>(std::ceil((y_max - origin_.y) / cell_m)) + kReach + 1 + pad_;
  const auto side = static_cast<size_t>(side_x_);
  levels_.resize(static_cast<size_t>(levels));
  auto& base = levels_.front();
  base.assign(side * static_cast<size_t>(side_y_), 0);
  for (const auto& p : points) {
    const double px = (p.x - origin_.x) / cell_m, py = (p.y - origin_.y) / cell_m;
    const int column = static_cast<int>(px), row = static_cast<int>(py);
    // The Gaussian is that of x times that of y.
    std::array<double, 2 * kReach + 1> along_x{}, along_y{};
    for (int k = -kReach; k <= kReach; ++k) {
      const double dx = (column + k + 0.5 - px) * cell_m, dy = (row + k + 0.5 - py) * cell_m;
      const int at = k + kReach;
      along_x[static_cast<size_t>(at)] = core::exp(-dx * dx / (2 * sigma_m * sigma_m));
      along_y[static_cast<size_t>(at)] = 255 * core::exp(-dy * dy / (2 * sigma_m * sigma_m));
    }
    const int first_row = row - kReach, first_column = column - kReach;
    for (int r = std::max(first_row, 0); r <= row + kReach && r + pad_ < side_y_; ++r)
      for (int c = std::max(first_column, 0); c <= column + kReach && c + pad_ < side_x_; ++c) {
        const double value =
            along_x[static_cast<size_t>(c - first_column)] * along_y[static_cast<size_t>(r - first_row)];
        auto& cell = base[static_cast<size_t>(r + pad_) * side + static_cast<size_t>(c + pad_)];
        // NOLINTNEXTLINE(bugprone-incorrect-roundings): std::lround() is slow, and the value is not negative
        cell = std::max(cell, static_cast<std::uint8_t>(value + 0.5));
      }
  }
  buildLevels();
}

/// Level k + 1 from level k: the greatest of the four windows that make up the larger one.
void LikelihoodPyramid::buildLevels() {
  // Bytes may be anything, members too: these are not read anew for every cell.
  const size_t width = static_cast<size_t>(side_x_), height = static_cast<size_t>(side_y_);
  const auto greater = [](const std::uint8_t* a, const std::uint8_t* b, size_t count, std::uint8_t* out) {
    for (size_t i = 0; i < count; ++i) out[i] = std::max(a[i], b[i]);
  };
  rows_.resize(width * height);
  for (size_t k = 1; k < levels_.size(); ++k) {
    const auto& below = levels_[k - 1];
    auto& level = levels_[k];
    const size_t half = size_t{1} << (k - 1), overlap = width > half ? width - half : 0;
    level.resize(below.size());
    for (size_t r = 0; r < height; ++r) {
      const auto* in = &below[r * width];
      greater(in, in + half, overlap, &rows_[r * width]);
      std::copy(in + overlap, in + width, &rows_[r * width + overlap]);
    }
    for (size_t r = 0; r < height; ++r) {
      const auto* in = &rows_[r * width];
      greater(in, r + half < height ? in + half * width : in, width, &level[r * width]);
    }
  }
}

namespace {

struct Cell {
  int column, row;
};

struct Node {
  int level, turn;
  int column, row;  ///< shift in cells from the window's corner: [column, column + 2^level)
  int sum;
};

bool worse(const Node& a, const Node& b) {
  return a.sum < b.sum;
}

/// What one point of one pose costs, in multiplications.
constexpr double kWorkPerLook = 10;

}  // namespace

/// Branch and bound, depth first, over the shifts and turns of a window.
class SearchInPieces::Window {
 public:
  Window(const LikelihoodPyramid& map, const std::vector<core::Point2>& points, const core::Pose2& centre,
         const SearchWindow& window, double least_score)
      : map_(map), centre_(centre), full_(static_cast<int>(255 * points.size())) {
    const double cell_m = map.cellSize();
    double farthest = 1;
    for (const auto& p : points) farthest = std::max(farthest, core::hypot(p.x, p.y));
    turn_step_ = cell_m / farthest;
    turns_ = static_cast<int>(std::ceil(window.half_phi_rad / turn_step_));
    reach_ = static_cast<int>(std::ceil(window.half_xy_m / cell_m));
    width_ = 2 * reach_ + 1;
    best_sum_ = static_cast<int>(std::ceil(least_score * full_)) - 1;
    apart2_ = window.apart_m * window.apart_m / (cell_m * cell_m);
    not_column_ = (window.not_at.x - centre.x) / cell_m + reach_;
    not_row_ = (window.not_at.y - centre.y) / cell_m + reach_;
    turn(points);
  }

  bool advance(double& work) {
    for (looks_ = 0; kWorkPerLook * looks_ < work;) {
      if (next_turn_ <= 2 * turns_) {
        addRoots(next_turn_++);
        if (next_turn_ > 2 * turns_) std::stable_sort(stack_.begin(), stack_.end(), worse);
      } else if (!stack_.empty()) {
        goOn();
      } else {
        work -= kWorkPerLook * looks_;
        return true;
      }
    }
    work -= kWorkPerLook * looks_;
    return false;
  }

  std::optional<SearchResult> best() const {
    if (!best_) return std::nullopt;
    const double cell_m = map_.cellSize();
    SearchResult result;
    result.T_map_robot = {centre_.x + (best_->column - reach_) * cell_m,
                          centre_.y + (best_->row - reach_) * cell_m,
                          core::wrapToPi(centre_.phi + (best_->turn - turns_) * turn_step_)};
    result.score = static_cast<double>(best_->sum) / full_;
    return result;
  }

 private:
  /// Points turned, at the window's lowest shift. Those that no shift brings into the map are left out.
  struct Turned {
    std::vector<int> inside;    ///< offsets of those that every shift leaves in the map: most
    std::vector<Cell> at_edge;  ///< the others' cells
  };

  void turn(const std::vector<core::Point2>& points) {
    const double cell_m = map_.cellSize();
    const LikelihoodPyramid::Level level = map_.level(0);
    turned_.resize(2 * static_cast<size_t>(turns_) + 1);
    for (size_t t = 0; t < turned_.size(); ++t) {
      const double angle = centre_.phi + (static_cast<int>(t) - turns_) * turn_step_;
      const auto [s, c] = core::sinCos(angle);
      Turned& turned = turned_[t];
      turned.inside.reserve(points.size());
      for (const auto& p : points) {
        const Cell cell{
            static_cast<int>(std::floor((centre_.x + c * p.x - s * p.y - map_.origin().x) / cell_m)) - reach_,
            static_cast<int>(std::floor((centre_.y + s * p.x + c * p.y - map_.origin().y) / cell_m)) -
                reach_};
        if (level.covers(cell.column, cell.row, width_))
          turned.inside.push_back(level.offset(cell.column, cell.row));
        else if (level.touches(cell.column, cell.row, width_))
          turned.at_edge.push_back(cell);
      }
    }
  }

  /// Whether all of the node's shifts lie too near to where no answer is looked for.
  bool isExcluded(const Node& node) const {
    if (!(apart2_ > 0)) return false;
    const double width = (1 << node.level) - 1;
    const auto farthest = [&](double first, double from) {
      return std::max(std::abs(first - from), std::abs(first + width - from));
    };
    const double dc = farthest(node.column, not_column_), dr = farthest(node.row, not_row_);
    return dc * dc + dr * dr < apart2_;
  }

  /// Sets the sums of nodes of one level and turn, and leaves only those that are worth it, in their order:
  /// each is given up as soon as the points that are left cannot make it better than the best. By turns, some
  /// points each, since what neighbours look at lies close together.
  void sumUp(std::vector<Node>& nodes) {
    constexpr size_t kBlock = 16;
    const auto drop = [&nodes](const auto& isBad) {
      nodes.erase(std::remove_if(nodes.begin(), nodes.end(), isBad), nodes.end());
    };
    drop([this](const Node& node) { return isExcluded(node); });
    if (nodes.empty()) return;
    const auto& [inside, at_edge] = turned_[static_cast<size_t>(nodes.front().turn)];
    const LikelihoodPyramid::Level level = map_.level(nodes.front().level);
    int left = 255 * static_cast<int>(inside.size() + at_edge.size());
    const auto dropBeaten = [&] { drop([&](const Node& node) { return node.sum + left <= best_sum_; }); };
    const auto add = [&](const auto& points, const auto& sumOf) {
      for (size_t i = 0; i < points.size(); i += kBlock) {
        dropBeaten();
        if (nodes.empty()) return;
        const size_t count = std::min(kBlock, points.size() - i);
        left -= 255 * static_cast<int>(count);
        looks_ += static_cast<double>(count * nodes.size());
        for (Node& node : nodes) node.sum += sumOf(node, &points[i], count);
      }
    };
    add(at_edge, [&](const Node& node, const Cell* cells, size_t count) {
      int sum = 0;
      for (size_t i = 0; i < count; ++i) sum += level(cells[i].column + node.column, cells[i].row + node.row);
      return sum;
    });
    add(inside, [&](const Node& node, const int* offsets, size_t count) {
      const int shift = level.shift(node.column, node.row);
      int sum = 0;
      for (size_t i = 0; i < count; ++i) sum += level[offsets[i] + shift];
      return sum;
    });
    dropBeaten();
  }

  /// The whole window, turned once, in squares of the coarsest level that is of use.
  void addRoots(int turn) {
    const int top = std::min(map_.levels() - 1, static_cast<int>(std::ceil(core::log2(2 * reach_ + 1))));
    family_.clear();
    for (int row = 0; row < width_; row += 1 << top)
      for (int column = 0; column < width_; column += 1 << top)
        family_.push_back({top, turn, column, row, 0});
    sumUp(family_);
    stack_.insert(stack_.end(), family_.begin(), family_.end());
  }

  void goOn() {
    const Node node = stack_.back();
    stack_.pop_back();
    if (node.sum <= best_sum_) return;
    if (node.level == 0)
      best_sum_ = node.sum, best_ = node;
    else
      split(node);
  }

  /// Its quarters that are worth it, the best last.
  void split(const Node& node) {
    family_.clear();
    const int half = 1 << (node.level - 1);
    for (const int dr : {0, half})
      for (const int dc : {0, half})
        if (node.column + dc < width_ && node.row + dr < width_)
          family_.push_back({node.level - 1, node.turn, node.column + dc, node.row + dr, 0});
    sumUp(family_);
    std::stable_sort(family_.begin(), family_.end(), worse);
    stack_.insert(stack_.end(), family_.begin(), family_.end());
  }

  const LikelihoodPyramid& map_;
  core::Pose2 centre_;
  int full_;
  double turn_step_ = 0;
  int turns_ = 0, reach_ = 0, width_ = 0, best_sum_ = 0;
  double apart2_ = 0, not_column_ = 0, not_row_ = 0;  ///< in cells
  std::vector<Turned> turned_;
  int next_turn_ = 0;                 ///< that has no roots yet
  std::vector<Node> stack_, family_;  ///< family_: scratch
  std::optional<Node> best_;
  double looks_ = 0;  ///< of the piece at hand
};

SearchInPieces::SearchInPieces(const LikelihoodPyramid& map, const std::vector<core::Point2>& points,
                               const core::Pose2& centre, const SearchWindow& window, double least_score)
    : window_(points.empty() ? nullptr : std::make_unique<Window>(map, points, centre, window, least_score)) {
}
SearchInPieces::SearchInPieces(SearchInPieces&&) noexcept = default;
SearchInPieces& SearchInPieces::operator=(SearchInPieces&&) noexcept = default;
SearchInPieces::~SearchInPieces() = default;

bool SearchInPieces::advance(double& work) {
  return !window_ || window_->advance(work);
}

std::optional<SearchResult> SearchInPieces::best() const {
  return window_ ? window_->best() : std::nullopt;
}

std::optional<SearchResult> searchBest(const LikelihoodPyramid& map, const std::vector<core::Point2>& points,
                                       const core::Pose2& centre, const SearchWindow& window,
                                       double least_score) {
  SearchInPieces search(map, points, centre, window, least_score);
  double all = std::numeric_limits<double>::infinity();
  search.advance(all);
  return search.best();
}

}  // namespace slam::scanmatch

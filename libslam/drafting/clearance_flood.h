#pragma once
#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace slam::drafting {

/// A space that widens towards its middle, as far as the flood has come.
struct Basin {
  double peak = 0;  ///< its largest clearance, cells
  std::int64_t area = 0;
  bool is_outside = false;
};

/// Floods a raster of clearances from the widest places down: basins appear, grow and meet. Where two meet is
/// the widest way between them, and the clearance there half of its width. (The meetings are the merge tree
/// of the clearance; where meet() says no stand the dams of a watershed.)
class ClearanceFlood {
 public:
  /// `clearance`: CV_32F, 0 where there is no way.
  explicit ClearanceFlood(cv::Mat clearance)
      : clearance_(std::move(clearance)), above_(clearance_.total(), kDry) {
    sortCells();
  }

  /// The basin that holds this cell is the outside. Before run().
  void markOutside(const cv::Point& cell) { outside_ = index(cell); }
  /// No way here; for cells that the flood has not reached.
  void dam(const cv::Point& cell) {
    if (above_[index(cell)] == kDry) above_[index(cell)] = kDammed;
  }

  /// meet(cell, clearance, basin, basin) at each meeting of two basins: true lets them become one, false
  /// keeps the cell dry.
  template <class Meet>
  void run(Meet meet) {
    for (const std::int32_t number : order_) {
      const auto cell = static_cast<size_t>(number);
      if (above_[cell] == kDammed) continue;
      const cv::Point at(number % clearance_.cols, number / clearance_.cols);
      const double here = clearance_.at<float>(at);
      std::int32_t home = kDry;
      bool stays_dry = false;
      for (const cv::Point step : {cv::Point(-1, 0), cv::Point(1, 0), cv::Point(0, -1), cv::Point(0, 1)}) {
        const cv::Point next = at + step;
        if (next.x < 0 || next.y < 0 || next.x >= clearance_.cols || next.y >= clearance_.rows) continue;
        if (above_[index(next)] == kDry || above_[index(next)] == kDammed) continue;
        const std::int32_t other = root(static_cast<std::int32_t>(index(next)));
        if (home == kDry || other == home) {
          home = other;
        } else if (meet(at, here, basinOf(home), basinOf(other))) {
          home = join(home, other);
        } else {
          stays_dry = true;
          break;
        }
      }
      if (stays_dry) continue;
      if (home == kDry) {
        home = number;
        above_[cell] = kFirstBasin - static_cast<std::int32_t>(basins_.size());
        basins_.push_back({here, 0, false});
      } else {
        above_[cell] = home;
      }
      Basin& own = basinOf(home);
      ++own.area;
      own.is_outside = own.is_outside || cell == outside_;
    }
  }

 private:
  // In above_: the cell that this one belongs to, or for the first cell of a basin kFirstBasin - its number.
  static constexpr std::int32_t kDry = -1, kDammed = -2, kFirstBasin = -3;

  size_t index(const cv::Point& cell) const { return static_cast<size_t>(cell.y) * clearance_.cols + cell.x; }
  Basin& basinOf(std::int32_t root) {
    return basins_[static_cast<size_t>(kFirstBasin - above_[static_cast<size_t>(root)])];
  }
  std::int32_t root(std::int32_t cell) {
    for (std::int32_t up = above_[static_cast<size_t>(cell)]; up >= 0;
         up = above_[static_cast<size_t>(cell)]) {
      if (const std::int32_t next = above_[static_cast<size_t>(up)]; next >= 0)
        above_[static_cast<size_t>(cell)] = next;
      cell = up;
    }
    return cell;
  }
  std::int32_t join(std::int32_t a, std::int32_t b) {
    if (basinOf(a).area < basinOf(b).area) std::swap(a, b);
    Basin& all = basinOf(a);
    const Basin& other = basinOf(b);
    all.peak = std::max(all.peak, other.peak);
    all.area += other.area;
    all.is_outside = all.is_outside || other.is_outside;
    above_[static_cast<size_t>(b)] = a;
    return a;
  }

  /// Falling clearance, in eighths of a cell; of equals in reading order.
  void sortCells() {
    double most = 0;
    cv::minMaxLoc(clearance_, nullptr, &most);
    const size_t last = static_cast<size_t>(most * 8);
    std::vector<std::int32_t> first(last + 2, 0);
    const auto forEachCell = [&](auto action) {
      for (int y = 0; y < clearance_.rows; ++y)
        for (int x = 0; x < clearance_.cols; ++x)
          if (const float c = clearance_.at<float>(y, x); c > 0)
            action(last - static_cast<size_t>(static_cast<double>(c) * 8),
                   static_cast<std::int32_t>(index({x, y})));
    };
    forEachCell([&](size_t rank, std::int32_t) { ++first[rank + 1]; });
    for (size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    order_.resize(static_cast<size_t>(first.back()));
    forEachCell([&](size_t rank, std::int32_t cell) { order_[static_cast<size_t>(first[rank]++)] = cell; });
  }

  cv::Mat clearance_;
  std::vector<std::int32_t> above_, order_;
  std::vector<Basin> basins_;
  size_t outside_ = static_cast<size_t>(-1);
};

}  // namespace slam::drafting

#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::scanmatch {

/// How near the map's surfaces are, on a raster, and the best of every window of 2^k x 2^k cells: what a
/// search over many poses needs (Olson, "Real-time correlative scan matching", ICRA 2009; branch and bound:
/// Hess et al., "Real-time loop closure in 2D LIDAR SLAM", ICRA 2016).
class LikelihoodPyramid {
 public:
  /// Around the points (map frame). A cell at distance d of the nearest point has the value exp(-d^2 / (2
  /// sigma^2)), cut off beyond three cells.
  LikelihoodPyramid(const std::vector<core::Point2>& points, double cell_m, double sigma_m, int levels) {
    build(points, cell_m, sigma_m, levels);
  }
  /// Empty, for build().
  LikelihoodPyramid() = default;
  /// Anew, in the memory that is there already.
  void build(const std::vector<core::Point2>& points, double cell_m, double sigma_m, int levels);

  double cellSize() const { return cell_m_; }
  core::Point2 origin() const { return origin_; }
  /// Values of all levels.
  size_t size() const { return levels_.empty() ? 0 : levels_.size() * levels_.front().size(); }
  int levels() const { return static_cast<int>(levels_.size()); }
  /// One level, for many questions. REQUIRES that the pyramid stays as it is.
  class Level {
   public:
    /// Greatest value, 0..255, of the cells [column, column + 2^level) x [row, row + 2^level); indices may
    /// lie outside.
    int operator()(int column, int row) const {
      const auto c = static_cast<unsigned>(column + pad_), r = static_cast<unsigned>(row + pad_);
      return c < side_x_ && r < side_y_ ? cells_[static_cast<size_t>(r) * side_x_ + c] : 0;
    }
    /// Whether all cells [column, column + width) x [row, row + width) have values; others are 0.
    bool covers(int column, int row, int width) const {
      const int c = column + pad_, r = row + pad_;
      return c >= 0 && r >= 0 && c + width <= static_cast<int>(side_x_) &&
             r + width <= static_cast<int>(side_y_);
    }
    /// Whether any of them has.
    bool touches(int column, int row, int width) const {
      const int c = column + pad_, r = row + pad_;
      return c + width > 0 && r + width > 0 && c < static_cast<int>(side_x_) && r < static_cast<int>(side_y_);
    }
    /// The same value without a check, and where it lies: offsets of cells add up. REQUIRES that it is
    /// covered.
    int operator[](int offset) const { return cells_[offset]; }
    int offset(int column, int row) const { return (row + pad_) * static_cast<int>(side_x_) + column + pad_; }
    int shift(int columns, int rows) const { return rows * static_cast<int>(side_x_) + columns; }

   private:
    friend class LikelihoodPyramid;
    const std::uint8_t* cells_ = nullptr;
    int pad_ = 0;
    unsigned side_x_ = 0, side_y_ = 0;
  };
  Level level(int level) const {
    Level out;
    out.cells_ = levels_[static_cast<size_t>(level)].data();
    out.pad_ = pad_, out.side_x_ = static_cast<unsigned>(side_x_),
    out.side_y_ = static_cast<unsigned>(side_y_);
    return out;
  }
  int value(int level, int column, int row) const { return this->level(level)(column, row); }

 private:
  void buildLevels();

  double cell_m_ = 0;
  core::Point2 origin_;  ///< corner of the cell (0, 0)
  int pad_ = 0, side_x_ = 0, side_y_ = 0;
  std::vector<std::vector<std::uint8_t>> levels_;
  std::vector<std::uint8_t> rows_;  ///< scratch
};

struct SearchWindow {
  double half_xy_m, half_phi_rad;
  /// Poses nearer to `not_at` than this are no answer, however they are turned.
  double apart_m = 0;
  core::Point2 not_at{};
};

struct SearchResult {
  core::Pose2 T_map_robot;
  double score;  ///< mean value of the points, 0..1
};

/// The best pose of the window about `centre` on a lattice of the pyramid's cells and of such turns that the
/// farthest point moves by a cell; nothing when none scores `least_score`. Exhaustive: no better pose of the
/// lattice exists. Of equal ones the first in a fixed order.
std::optional<SearchResult> searchBest(const LikelihoodPyramid& map, const std::vector<core::Point2>& points,
                                       const core::Pose2& centre, const SearchWindow& window,
                                       double least_score);

/// The same in pieces, so that nobody waits long for it.
class SearchInPieces {
 public:
  /// REQUIRES that the map stays as it is.
  SearchInPieces(const LikelihoodPyramid& map, const std::vector<core::Point2>& points,
                 const core::Pose2& centre, const SearchWindow& window, double least_score);
  SearchInPieces(SearchInPieces&& other) noexcept;
  SearchInPieces& operator=(SearchInPieces&& other) noexcept;
  ~SearchInPieces();

  /// Takes what it does off `work` (multiplications), which may end a little below 0; ends when nothing of it
  /// is left. True when the search is done.
  bool advance(double& work);
  /// REQUIRES that it is done.
  std::optional<SearchResult> best() const;

 private:
  class Window;
  std::unique_ptr<Window> window_;
};

}  // namespace slam::scanmatch

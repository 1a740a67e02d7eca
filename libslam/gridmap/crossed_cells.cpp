#include "libslam/gridmap/crossed_cells.h"

#include <cmath>

namespace slam::gridmap {

void CrossedCells::addLine(const core::Point2& from, const core::Point2& to) {
  // From the rectangle's corner everything is positive, and a conversion to int rounds down.
  const double x_shift = column_min_ * 32.0, y_shift = row_min_ * 32.0;
  double ax = from.x - x_shift, ay = from.y - y_shift, bx = to.x - x_shift, by = to.y - y_shift;
  const bool steep = std::abs(by - ay) > std::abs(bx - ax);
  if (steep ? ay > by : ax > bx) std::swap(ax, bx), std::swap(ay, by);
  const auto set = [this](int x, int y) {
    words_[static_cast<size_t>(y) * stride_ + static_cast<size_t>(x >> 5)] |= 1U << (x & 31);
  };
  if (!steep) {
    const int first = static_cast<int>(ax), last = static_cast<int>(bx);
    const double slope = bx > ax ? (by - ay) / (bx - ax) : 0;
    // Rounding must not lead beyond the rows of the two ends.
    const int least = static_cast<int>(std::min(ay, by)), most = static_cast<int>(std::max(ay, by));
    int row = static_cast<int>(ay);
    for (int x = first; x < last; ++x) {
      const int next = std::clamp(static_cast<int>(ay + (x + 1 - ax) * slope), least, most);
      set(x, row);
      if (next != row) set(x, next), row = next;
    }
    set(last, row);
    set(last, static_cast<int>(by));
    return;
  }
  const int first = static_cast<int>(ay), last = static_cast<int>(by);
  const double slope = (bx - ax) / (by - ay);
  const int least = static_cast<int>(std::min(ax, bx)), most = static_cast<int>(std::max(ax, bx));
  int column = static_cast<int>(ax);
  for (int y = first; y < last; ++y) {
    const int next = std::clamp(static_cast<int>(ax + (y + 1 - ay) * slope), least, most);
    set(column, y);
    if (next != column) set(next, y), column = next;
  }
  set(column, last);
  set(static_cast<int>(bx), last);
}

}  // namespace slam::gridmap

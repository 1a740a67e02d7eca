#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/draw/canvas.h"

namespace slam::draw {

/// From one value to another, linear or logarithmic.
struct Axis {
  double low = 0, high = 1;
  bool is_log = false;
  std::vector<double> ticks;  ///< ascending, within the two

  /// Where a value stands: 0 at low, 1 at high, also beyond them. NaN where a logarithm has none.
  double place(double value) const;
  /// Longer by this share at both ends.
  Axis grownBy(double share) const;
};

/// From 0 to a whole number of steps, or to `fixed_end` where that is above 0.
Axis axisFromZero(double largest, double fixed_end = 0);
/// From the values' least to their largest, a little widened; with ticks at round numbers.
Axis axisAround(const std::vector<double>& values);
/// From 1, 2 or 5 times a power of ten to such a number, round the values above 0; ticks at powers of ten
/// where there are three of them, else at all such numbers.
Axis logAxis(const std::vector<double>& values);

/// A box between two axes, y up.
struct AxesView {
  PixelBox box;
  Axis x, y;

  Pixel toPixel(const core::Point2& p) const {
    return {box.left + x.place(p.x) * box.width, box.top + (1 - y.place(p.y)) * box.height};
  }
};

/// Room that labels need round the box of an AxesView, units.
inline constexpr double kAxesLeft = 66, kAxesRight = 14, kAxesTop = 30, kAxesBottom = 54;

/// Grid lines and their labels, the title of x below and that of y above the box, from the left end of its
/// labels. Without `x_labels` what stands below is the caller's.
void drawAxes(Canvas& canvas, const AxesView& view, const std::string& x_title, const std::string& y_title,
              bool x_labels = true);

/// Of charts: names with colours, in as many lines as the width needs.
class ChartLegend {
 public:
  ChartLegend(std::vector<std::string> labels, double width);
  double height() const;
  void draw(Canvas& canvas, Pixel upper_left) const;
  /// Of a label; the same in every chart over this legend.
  Colour colourOf(const std::string& label) const;

 private:
  std::vector<std::string> labels_;
  std::vector<Colour> colours_;
  std::vector<Pixel> places_;
  int lines_ = 1;
};

/// How `count` charts of about `least_width` stand on paper, or beside one another on the screen.
struct ChartGrid {
  int columns = 1, rows = 1;
  double cell_width = 0, cell_height = 0;  ///< with the room for labels
  double width() const { return columns * cell_width; }
  double height() const { return rows * cell_height; }
};
ChartGrid chartGrid(std::size_t count, double least_width, double shape, const Paper& paper);

/// Of the sheet's air all round.
double sheetMargin(const Paper& paper);

/// Charts in a grid under a title, unless it is empty, and over their legend.
class ChartSheet {
 public:
  ChartSheet(const ChartGrid& grid, const std::string& title, std::vector<std::string> labels,
             const Paper& paper);
  Canvas& canvas() { return canvas_; }
  const ChartLegend& legend() const { return legend_; }
  /// Of a chart within its axes, row by row from the upper left; `above` and `below` is the room for its
  /// labels there.
  PixelBox box(std::size_t chart, double above, double below) const;
  /// Draws the legend, and saves the sheet.
  void save(const std::string& file);

 private:
  ChartGrid grid_;
  double margin_, top_;
  ChartLegend legend_;
  Canvas canvas_;
};

}  // namespace slam::draw

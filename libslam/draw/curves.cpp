#include "libslam/draw/curves.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/draw/chart_axes.h"
#include "libslam/draw/map_view.h"

namespace slam::draw {
namespace {

constexpr double kLeastChartWidth = 330, kShape = 0.78;
constexpr double kLineWidth = 1.5, kMarkRadius = 3.2, kApart = 6, kWhiskerEnd = 3.5;

std::vector<double> valuesOf(const Chart& chart, double core::Point2::*coordinate) {
  std::vector<double> values;
  for (const auto& curve : chart.curves)
    for (const auto& p : curve.points) values.push_back(p.*coordinate);
  return values;
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values)
    if (std::isfinite(value)) most = std::max(most, value);
  return most;
}

/// Of an error that begins near 0 the first moments alone would stretch the axis down without end: the least
/// twentieth of the values does not count.
std::vector<double> withoutLeast(std::vector<double> values) {
  values.erase(
      std::remove_if(values.begin(), values.end(), [](double v) { return !(std::isfinite(v) && v > 0); }),
      values.end());
  std::sort(values.begin(), values.end());
  values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 20));
  return values;
}

std::vector<std::string> labelsOf(const std::vector<Chart>& charts) {
  std::vector<std::string> labels;
  for (const auto& chart : charts)
    for (const auto& curve : chart.curves)
      if (std::find(labels.begin(), labels.end(), curve.label) == labels.end()) labels.push_back(curve.label);
  return labels;
}

/// Of the points that share half a unit across only the lowest and the highest: nobody sees more.
std::vector<Pixel> thinned(const std::vector<Pixel>& points) {
  std::vector<Pixel> few;
  std::vector<Pixel> column;
  const auto finish = [&] {
    if (column.size() > 2) {
      const auto ends = std::minmax_element(column.begin(), column.end(),
                                            [](const Pixel& a, const Pixel& b) { return a.y < b.y; });
      few.push_back(*std::min(ends.first, ends.second));
      few.push_back(*std::max(ends.first, ends.second));
    } else {
      few.insert(few.end(), column.begin(), column.end());
    }
    column.clear();
  };
  for (const auto& p : points) {
    const bool is_place = std::isfinite(p.x) && std::isfinite(p.y);
    if (!column.empty() && (!is_place || std::floor(2 * p.x) != std::floor(2 * column.front().x))) finish();
    if (is_place)
      column.push_back(p);
    else
      few.push_back(p);
  }
  finish();
  return few;
}

void drawCurve(Canvas& canvas, const AxesView& view, const Curve& curve, Colour colour, double shift) {
  std::vector<Pixel> points;
  for (const auto& p : curve.points) {
    points.push_back(view.toPixel(p));
    if (curve.style != Curve::Style::kLine) points.back().x += shift;
  }
  if (curve.style == Curve::Style::kWhisker) {
    if (points.size() != 2) throw core::ContractError("drawCharts: a whisker needs two points");
    const bool is_open = std::isinf(curve.points[1].y);
    if (is_open) points[1].y = view.box.top;
    canvas.polyline(points, colour, 0.6 * kLineWidth);
    const auto cross = [&](const Pixel& p) {
      canvas.line({p.x - kWhiskerEnd, p.y}, {p.x + kWhiskerEnd, p.y}, colour, 0.6 * kLineWidth);
    };
    cross(points[0]);
    if (!is_open) cross(points[1]);
    for (const double side : {-kWhiskerEnd, kWhiskerEnd})  // an arrow's head
      if (is_open)
        canvas.line(points[1], {points[1].x + side, points[1].y + 1.5 * kWhiskerEnd}, colour,
                    0.6 * kLineWidth);
    return;
  }
  canvas.polyline(thinned(points), colour, kLineWidth);
  if (curve.style == Curve::Style::kMarked)
    for (const auto& p : points) canvas.disc(p, kMarkRadius, colour);
}

void drawChart(Canvas& canvas, const Chart& chart, const PixelBox& box,
               const std::vector<std::string>& labels, const ChartLegend& legend) {
  const auto x_values = valuesOf(chart, &core::Point2::x), y_values = valuesOf(chart, &core::Point2::y);
  Axis x = chart.x_log ? logAxis(x_values) : axisFromZero(largest(x_values));
  const bool has_marks = std::any_of(chart.curves.begin(), chart.curves.end(),
                                     [](const Curve& c) { return c.style != Curve::Style::kLine; });
  if (has_marks) x = x.grownBy(0.05);  // none of them on the frame
  const AxesView view{
      box, x, chart.y_log ? logAxis(withoutLeast(y_values)) : axisFromZero(largest(y_values), chart.y_max)};
  drawAxes(canvas, view, chart.x_title, chart.y_title);
  // Marks at the ends of the axes are shown whole.
  canvas.clipTo({box.left - 6, box.top - 4, box.width + 12, box.height + 8});
  const double middle = (static_cast<double>(labels.size()) - 1) / 2;
  for (const auto& curve : chart.curves) {
    const auto index = std::find(labels.begin(), labels.end(), curve.label) - labels.begin();
    drawCurve(canvas, view, curve, legend.colourOf(curve.label),
              (static_cast<double>(index) - middle) * kApart);
  }
  canvas.liftClip();
}

}  // namespace

void drawCharts(const std::vector<Chart>& charts, const std::string& title, const std::string& file,
                const Paper& paper) {
  if (charts.empty() || charts.size() > 4) throw core::ContractError("drawCharts: needs 1 to 4 charts");
  const auto labels = labelsOf(charts);
  ChartSheet sheet(chartGrid(charts.size(), kLeastChartWidth, kShape, paper), title, labels, paper);
  for (size_t i = 0; i < charts.size(); ++i)
    drawChart(sheet.canvas(), charts[i], sheet.box(i, kAxesTop, kAxesBottom), labels, sheet.legend());
  sheet.save(file);
}

}  // namespace slam::draw

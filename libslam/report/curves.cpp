#include "libslam/report/curves.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/report/canvas.h"
#include "libslam/report/map_view.h"

namespace slam::report {
namespace {

constexpr double kMargin = 20, kTitleHeight = 48, kTitleSize = 25;
constexpr double kPlotWidth = 480, kPlotHeight = 400;
constexpr double kLeftOfPlot = 78, kRightOfPlot = 22, kBelowPlot = 62;
constexpr double kTextSize = 17, kLegendLine = 28, kSample = 34;
constexpr Colour kGridLine{225, 225, 225};

/// An axis from 0 to a whole number of steps, or to a given end.
struct Axis {
  double end = 1, step = 0.2;
};

Axis axisTo(double largest, double fixed_end) {
  Axis axis;
  axis.end = fixed_end > 0 ? fixed_end : largest;
  if (!(axis.end > 0) || !std::isfinite(axis.end)) axis.end = 1;
  axis.step = niceStep(axis.end / 4);
  if (!(fixed_end > 0)) axis.end = axis.step * std::ceil(axis.end / axis.step - 1e-9);
  return axis;
}

double largest(const Chart& chart, double core::Point2::*coordinate) {
  double most = 0;
  for (const auto& curve : chart.curves)
    for (const auto& p : curve.points)
      if (std::isfinite(p.*coordinate)) most = std::max(most, p.*coordinate);
  return most;
}

std::vector<std::string> labelsOf(const std::vector<Chart>& charts) {
  std::vector<std::string> labels;
  for (const auto& chart : charts)
    for (const auto& curve : chart.curves)
      if (std::find(labels.begin(), labels.end(), curve.label) == labels.end()) labels.push_back(curve.label);
  return labels;
}

Colour colourOf(const std::string& label, const std::vector<std::string>& labels) {
  const auto index = static_cast<size_t>(std::find(labels.begin(), labels.end(), label) - labels.begin());
  return lineColours()[index % lineColours().size()];
}

void drawChart(Canvas& canvas, const Chart& chart, const PixelBox& box,
               const std::vector<std::string>& labels) {
  const Axis x = axisTo(largest(chart, &core::Point2::x), 0);
  const Axis y = axisTo(largest(chart, &core::Point2::y), chart.y_max);
  const double bottom = box.top + box.height;
  const auto pixel = [&](const core::Point2& p) {
    return Pixel{box.left + p.x / x.end * box.width, bottom - p.y / y.end * box.height};
  };
  for (int i = 0; i * x.step <= x.end * (1 + 1e-9); ++i) {
    const Pixel at = pixel({i * x.step, 0});
    canvas.line(at, {at.x, box.top}, kGridLine, 1);
    canvas.text({at.x, bottom + 22}, stepLabel(i * x.step), kTextSize, kInk, Align::kCentre);
  }
  for (int i = 0; i * y.step <= y.end * (1 + 1e-9); ++i) {
    const Pixel at = pixel({0, i * y.step});
    canvas.line(at, {box.left + box.width, at.y}, kGridLine, 1);
    canvas.text({box.left - 8, at.y + 6}, stepLabel(i * y.step), kTextSize, kInk, Align::kRight);
  }
  canvas.clipTo({box.left, box.top - 2, box.width, box.height + 4});
  for (const auto& curve : chart.curves) {
    std::vector<Pixel> points;
    for (const auto& p : curve.points) points.push_back(pixel(p));
    canvas.polyline(points, colourOf(curve.label, labels), 2);
  }
  canvas.liftClip();
  canvas.frame(box, kFrame, 1);
  canvas.text({box.left + box.width / 2, bottom + 50}, chart.x_title, kTextSize, kInk, Align::kCentre);
  canvas.text({box.left - kLeftOfPlot + 4, box.top - 12}, chart.y_title, kTextSize, kInk);
}

/// Where the entries of the legend stand within a width, and how many lines they take.
struct Legend {
  std::vector<Pixel> places;
  int lines = 1;
};

Legend arrangeLegend(const std::vector<std::string>& labels, double width) {
  Legend legend;
  Pixel at;
  for (const auto& label : labels) {
    const double needed = kSample + 9 + Canvas::textWidth(label, kTextSize) + 28;
    if (at.x > 0 && at.x + needed > width) at = {0, at.y + kLegendLine}, ++legend.lines;
    legend.places.push_back(at);
    at.x += needed;
  }
  return legend;
}

}  // namespace

void drawCharts(const std::vector<Chart>& charts, const std::string& title, const std::string& png_path) {
  if (charts.empty() || charts.size() > 4) throw core::ContractError("drawCharts: needs 1 to 4 charts");
  const auto labels = labelsOf(charts);
  const double chart_width = kLeftOfPlot + kPlotWidth + kRightOfPlot;
  const double width = static_cast<double>(charts.size()) * chart_width;
  const auto legend = arrangeLegend(labels, width);
  const double plot_top = kMargin + kTitleHeight + 24;
  const double legend_top = plot_top + kPlotHeight + kBelowPlot;
  Canvas canvas(static_cast<int>(width + 2 * kMargin),
                static_cast<int>(legend_top + legend.lines * kLegendLine + kMargin));
  canvas.text({kMargin, kMargin + kTitleSize}, Canvas::fitText(title, kTitleSize, width, true), kTitleSize,
              kInk, Align::kLeft, true);
  for (size_t i = 0; i < charts.size(); ++i)
    drawChart(
        canvas, charts[i],
        {kMargin + static_cast<double>(i) * chart_width + kLeftOfPlot, plot_top, kPlotWidth, kPlotHeight},
        labels);
  for (size_t i = 0; i < labels.size(); ++i) {
    const Pixel at{kMargin + legend.places[i].x, legend_top + legend.places[i].y + kLegendLine / 2};
    canvas.line(at, {at.x + kSample, at.y}, colourOf(labels[i], labels), 2.5);
    canvas.text({at.x + kSample + 9, at.y + 6}, labels[i], kTextSize, kInk);
  }
  canvas.savePng(png_path);
}

}  // namespace slam::report

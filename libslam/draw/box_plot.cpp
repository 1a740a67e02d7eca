#include "libslam/draw/box_plot.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/draw/chart_axes.h"
#include "libslam/draw/map_view.h"
#include "libslam/metrics/statistics.h"

namespace slam::draw {
namespace {

constexpr double kChartTitleHeight = 22;
constexpr double kShape = 0.78;
constexpr double kLeastSlot = 62, kMostBox = 34;  // of one sample, across
constexpr double kCountHeight = 22;
constexpr std::size_t kFewest = 5;  // of fewer values quartiles say nothing

std::vector<double> finite(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
               values.end());
  return values;
}

Colour paler(Colour c) {
  const auto pale = [](unsigned char v) { return static_cast<unsigned char>(255 - (255 - v) * 3 / 10); };
  return {pale(c.red), pale(c.green), pale(c.blue)};
}

/// One sample round x; `y` gives the height of a value.
template <class HeightOf>
void drawSample(Canvas& canvas, const std::vector<double>& values, double x, double box_width, Colour colour,
                HeightOf y) {
  if (values.size() < kFewest) {
    for (const double value : values) canvas.disc({x, y(value)}, 3.2, colour);
    return;
  }
  const auto figures = boxFigures(values);
  const double half = box_width / 2;
  for (const auto& [from, to] :
       {std::pair{figures.upper_quartile, figures.high}, {figures.lower_quartile, figures.low}}) {
    canvas.line({x, y(from)}, {x, y(to)}, colour, 1.5);
    canvas.line({x - half / 2, y(to)}, {x + half / 2, y(to)}, colour, 1.5);
  }
  const double top = y(figures.upper_quartile), bottom = y(figures.lower_quartile);
  const PixelBox box{x - half, top, box_width, std::max(bottom - top, 1.0)};
  canvas.box(box, paler(colour));
  canvas.frame(box, colour, 1.5);
  canvas.line({x - half, y(figures.median)}, {x + half, y(figures.median)}, colour, 3.5);
  for (const double value : figures.beyond) canvas.circle({x, y(value)}, 2.8, colour, 1.2);
}

void drawChart(Canvas& canvas, const BoxChart& chart, const AxesView& view, const std::string& y_title,
               const ChartLegend& legend) {
  const auto& box = view.box;
  drawAxes(canvas, view, "", y_title, false);
  canvas.text({box.left + box.width / 2, box.top - 12 - kChartTitleHeight},
              Canvas::fitText(chart.title, kTextSize, box.width + kAxesLeft, true), kTextSize, kInk,
              Align::kCentre, true);
  const double slot = box.width / static_cast<double>(chart.samples.size());
  const auto y = [&](double value) { return view.toPixel({0, value}).y; };
  for (std::size_t i = 0; i < chart.samples.size(); ++i) {
    const auto& sample = chart.samples[i];
    const double x = box.left + (static_cast<double>(i) + 0.5) * slot;
    const auto values = finite(sample.values);
    drawSample(canvas, values, x, std::min(0.6 * slot, kMostBox), legend.colourOf(sample.label), y);
    std::string count = "n " + std::to_string(values.size());
    canvas.text({x, box.top + box.height + 18}, count, 0.85 * kTextSize, kGrey, Align::kCentre);
    if (sample.failed > 0)
      canvas.text({x, box.top + box.height + 18 + kCountHeight - 5},
                  "+" + std::to_string(sample.failed) + " failed", 0.85 * kTextSize, kVermillion,
                  Align::kCentre);
  }
}

}  // namespace

BoxFigures boxFigures(std::vector<double> values) {
  values = finite(std::move(values));
  if (values.empty()) throw core::ContractError("boxFigures: needs a finite value");
  std::sort(values.begin(), values.end());
  BoxFigures figures;
  figures.lower_quartile = metrics::quantile(values, 0.25);
  figures.median = metrics::quantile(values, 0.5);
  figures.upper_quartile = metrics::quantile(values, 0.75);
  const double reach = 1.5 * (figures.upper_quartile - figures.lower_quartile);
  const auto is_within = [&](double v) {
    return v >= figures.lower_quartile - reach && v <= figures.upper_quartile + reach;
  };
  figures.low = *std::find_if(values.begin(), values.end(), is_within);
  figures.high = *std::find_if(values.rbegin(), values.rend(), is_within);
  std::copy_if(values.begin(), values.end(), std::back_inserter(figures.beyond),
               [&](double v) { return !is_within(v); });
  return figures;
}

void drawBoxes(const std::vector<BoxChart>& charts, const std::string& y_title, bool is_log,
               const std::string& title, const std::string& file, const Paper& paper) {
  if (charts.empty() || charts.size() > 24) throw core::ContractError("drawBoxes: needs 1 to 24 charts");
  std::vector<std::string> labels;
  std::vector<double> values;
  std::size_t most = 1;
  bool has_failed = false;
  for (const auto& chart : charts) {
    if (chart.samples.empty()) throw core::ContractError("drawBoxes: a chart needs a sample");
    most = std::max(most, chart.samples.size());
    for (const auto& sample : chart.samples) {
      has_failed = has_failed || sample.failed > 0;
      if (std::find(labels.begin(), labels.end(), sample.label) == labels.end())
        labels.push_back(sample.label);
      for (const double value : finite(sample.values)) values.push_back(value);
    }
  }
  const bool has_log = is_log && std::all_of(values.begin(), values.end(), [](double v) { return v > 0; });
  const Axis y = has_log ? logAxis(values) : axisAround(values);

  const double slots = static_cast<double>(most) * kLeastSlot + kAxesLeft + kAxesRight;
  auto grid = chartGrid(charts.size(), std::max(slots, 300.0), kShape, paper);
  const double below = 34 + (has_failed ? kCountHeight : 0), above = kAxesTop + kChartTitleHeight;
  grid.cell_height += kChartTitleHeight - kAxesBottom + below;
  ChartSheet sheet(grid, title, std::move(labels), paper);
  for (std::size_t i = 0; i < charts.size(); ++i)
    drawChart(sheet.canvas(), charts[i], {sheet.box(i, above, below), {}, y}, y_title, sheet.legend());
  sheet.save(file);
}

}  // namespace slam::draw

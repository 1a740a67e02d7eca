#include "libslam/draw/chart_axes.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/draw/map_view.h"

namespace slam::draw {
namespace {

constexpr Colour kGridLine{225, 225, 225};
constexpr double kAboveLegend = 6, kLegendLine = 26, kSample = 30, kGapAfterSample = 8, kGapAfterEntry = 24;
constexpr double kScreenCell = 580;

}  // namespace

double Axis::place(double value) const {
  if (is_log) return (core::log10(value) - core::log10(low)) / (core::log10(high) - core::log10(low));
  return (value - low) / (high - low);
}

Axis Axis::grownBy(double share) const {
  Axis grown = *this;
  if (is_log) {
    const double factor = core::pow(high / low, share);
    grown.low = low / factor, grown.high = high * factor;
  } else {
    grown.low = low - share * (high - low), grown.high = high + share * (high - low);
  }
  return grown;
}

Axis axisFromZero(double largest, double fixed_end) {
  Axis axis;
  axis.high = fixed_end > 0 ? fixed_end : largest;
  if (!(axis.high > 0) || !std::isfinite(axis.high)) axis.high = 1;
  const double step = niceStep(axis.high / 4);
  if (!(fixed_end > 0)) axis.high = step * std::ceil(axis.high / step - 1e-9);
  for (int i = 0; i * step <= axis.high * (1 + 1e-9); ++i) axis.ticks.push_back(i * step);
  return axis;
}

Axis axisAround(const std::vector<double>& values) {
  Axis axis;
  double low = INFINITY, high = -INFINITY;
  for (const double value : values)
    if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
  if (!(low <= high)) return axisFromZero(1);
  if (low >= 0 && low < 0.35 * high) return axisFromZero(high);
  const double air = high > low ? 0.04 * (high - low) : std::max(0.5 * std::abs(low), 0.5);
  axis.low = low - air, axis.high = high + air;
  const double step = niceStep((axis.high - axis.low) / 4);
  for (double k = std::ceil(axis.low / step); k * step <= axis.high; ++k)
    axis.ticks.push_back(k * step + 0.0);
  return axis;
}

Axis logAxis(const std::vector<double>& values) {
  Axis axis;
  axis.is_log = true;
  std::vector<double> positive;
  for (const double value : values)
    if (std::isfinite(value) && value > 0) positive.push_back(value);
  if (positive.empty()) positive = {0.1, 1};
  const auto [least, largest] = std::minmax_element(positive.begin(), positive.end());
  // From round number to round number; ticks at all of them, or at powers of ten where those are enough.
  std::vector<double> powers, round;
  const int first = static_cast<int>(std::floor(core::log10(*least))) - 1;
  for (int decade = first; decade <= core::log10(*largest) + 1; ++decade)
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double number = factor * core::powerOfTen(decade);
      if (5 * number > *least * (1 + 1e-9) && number < 5 * *largest * (1 - 1e-9)) round.push_back(number);
    }
  while (round.size() > 2 && round[1] <= *least * (1 + 1e-9)) round.erase(round.begin());
  while (round.size() > 2 && round[round.size() - 2] >= *largest * (1 - 1e-9)) round.pop_back();
  axis.low = round.front(), axis.high = round.back();
  for (const double number : round)
    if (std::abs(std::remainder(core::log10(number), 1)) < 1e-6) powers.push_back(number);
  axis.ticks = powers.size() > 2 ? powers : round;
  return axis;
}

void drawAxes(Canvas& canvas, const AxesView& view, const std::string& x_title, const std::string& y_title,
              bool x_labels) {
  const auto& box = view.box;
  const double bottom = box.top + box.height;
  if (x_labels) {
    double last_end = -INFINITY;
    for (const double tick : view.x.ticks) {
      const double x = box.left + view.x.place(tick) * box.width;
      canvas.line({x, bottom}, {x, box.top}, kGridLine, 1);
      const auto label = stepLabel(tick);
      const double half = Canvas::textWidth(label, kTextSize) / 2;
      if (x - half < last_end + 6) continue;
      canvas.text({x, bottom + 20}, label, kTextSize, kInk, Align::kCentre);
      last_end = x + half;
    }
  }
  for (const double tick : view.y.ticks) {
    const double y = box.top + (1 - view.y.place(tick)) * box.height;
    canvas.line({box.left, y}, {box.left + box.width, y}, kGridLine, 1);
    canvas.text({box.left - 7, y + 6}, stepLabel(tick), kTextSize, kInk, Align::kRight);
  }
  canvas.frame(box, kFrame, 1);
  if (!x_title.empty())
    canvas.text({box.left + box.width / 2, bottom + 43},
                Canvas::fitText(x_title, kTextSize, box.width + 2 * kAxesRight), kTextSize, kInk,
                Align::kCentre);
  const double from = box.left - kAxesLeft + 4;
  canvas.text({from, box.top - 12}, Canvas::fitText(y_title, kTextSize, box.left + box.width - from),
              kTextSize, kInk);
}

ChartLegend::ChartLegend(std::vector<std::string> labels, double width)
    : labels_(std::move(labels)), colours_(labelColours(labels_)) {
  Pixel at;
  for (const auto& label : labels_) {
    const double needed = kSample + kGapAfterSample + Canvas::textWidth(label, kTextSize);
    if (at.x > 0 && at.x + needed > width) at = {0, at.y + kLegendLine}, ++lines_;
    places_.push_back(at);
    at.x += needed + kGapAfterEntry;
  }
}

double ChartLegend::height() const {
  return labels_.empty() ? 0 : lines_ * kLegendLine;
}

void ChartLegend::draw(Canvas& canvas, Pixel upper_left) const {
  for (size_t i = 0; i < labels_.size(); ++i) {
    const Pixel at{upper_left.x + places_[i].x, upper_left.y + places_[i].y + kLegendLine / 2};
    canvas.line({at.x + 2, at.y}, {at.x + kSample - 2, at.y}, colourOf(labels_[i]), 3);
    canvas.text({at.x + kSample + kGapAfterSample, at.y + 6}, labels_[i], kTextSize, kInk);
  }
}

Colour ChartLegend::colourOf(const std::string& label) const {
  return colours_.at(static_cast<size_t>(std::find(labels_.begin(), labels_.end(), label) - labels_.begin()));
}

ChartGrid chartGrid(std::size_t count, double least_width, double shape, const Paper& paper) {
  const int charts = static_cast<int>(std::max<std::size_t>(count, 1));
  ChartGrid grid;
  if (paper.isScreen()) {
    grid.columns = std::min(charts, 4);
    grid.cell_width = std::max(kScreenCell, least_width);
  } else {
    const double width = paper.unitsWide() - 2 * sheetMargin(paper);
    grid.columns = std::clamp(static_cast<int>(width / least_width), 1, charts);
    // No row with a hole where another number of columns has none.
    const int rows = (charts + grid.columns - 1) / grid.columns;
    grid.columns = (charts + rows - 1) / rows;
    grid.cell_width = width / grid.columns;
  }
  grid.rows = (charts + grid.columns - 1) / grid.columns;
  const double plot_width = grid.cell_width - kAxesLeft - kAxesRight;
  grid.cell_height = shape * std::min(plot_width, 520.0) + kAxesTop + kAxesBottom;
  return grid;
}

double sheetMargin(const Paper& paper) {
  return paper.isScreen() ? 20 : 4;
}

ChartSheet::ChartSheet(const ChartGrid& grid, const std::string& title, std::vector<std::string> labels,
                       const Paper& paper)
    : grid_(grid),
      margin_(sheetMargin(paper)),
      top_(margin_ + titleHeight(title)),
      legend_(std::move(labels), grid.width()),
      canvas_(grid.width() + 2 * margin_,
              std::ceil(top_ + grid.height() + kAboveLegend + legend_.height() + margin_), paper) {
  drawTitle(canvas_, {margin_, margin_}, title, grid.width());
}

PixelBox ChartSheet::box(std::size_t chart, double above, double below) const {
  const auto column = static_cast<int>(chart) % grid_.columns, row = static_cast<int>(chart) / grid_.columns;
  return {margin_ + column * grid_.cell_width + kAxesLeft, top_ + row * grid_.cell_height + above,
          grid_.cell_width - kAxesLeft - kAxesRight, grid_.cell_height - above - below};
}

void ChartSheet::save(const std::string& file) {
  legend_.draw(canvas_, {margin_, top_ + grid_.height() + kAboveLegend});
  canvas_.save(file);
}

}  // namespace slam::draw

#include "libslam/draw/map_view.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/middle_value.h"
#include "libslam/files/parameters.h"

namespace slam::draw {
namespace {

constexpr double kLine = 28;  // pitch of the legend's lines
constexpr double kSample = 34, kGapAfterSample = 9, kGapAfterEntry = 28, kGapBeforeBar = 8;
constexpr double kMostOfScaleBar = 0.18;  // of the strip's width

Window windowWhere(const world::CellMap& raster, const core::Pose2& T_world_raster, world::Cell wanted) {
  Window window;
  for (int row = 0; row < raster.rows; ++row)
    for (int column = 0; column < raster.columns; ++column)
      if (raster.at(column, row) == wanted)
        window.include(T_world_raster *
                       core::Point2{(column + 0.5) * raster.resolution_m, (row + 0.5) * raster.resolution_m});
  return window;
}

/// The element in the middle of the order, of an even number the lower.
double middle(std::vector<double> values) {
  return core::valueOfRank(values, (values.size() - 1) / 2);
}

}  // namespace

void Window::include(const core::Point2& p) {
  if (!std::isfinite(p.x) || !std::isfinite(p.y)) return;
  const bool first = isEmpty();
  x0 = first ? p.x : std::min(x0, p.x), x1 = first ? p.x : std::max(x1, p.x);
  y0 = first ? p.y : std::min(y0, p.y), y1 = first ? p.y : std::max(y1, p.y);
}

void Window::include(const Window& other) {
  if (other.isEmpty()) return;
  include(core::Point2{other.x0, other.y0});
  include(core::Point2{other.x1, other.y1});
}

Window Window::grownBy(double share) const {
  if (isEmpty()) return *this;
  const double by = share * std::max(width(), height());
  return {x0 - by, y0 - by, x1 + by, y1 + by};
}

Window Window::cutTo(const Window& other) const {
  return {std::max(x0, other.x0), std::max(y0, other.y0), std::min(x1, other.x1), std::min(y1, other.y1)};
}

Window windowOf(const world::CellMap& raster, const core::Pose2& T_world_raster) {
  const auto walls = windowWhere(raster, T_world_raster, world::Cell::kOccupied);
  return walls.isEmpty() ? windowWhere(raster, T_world_raster, world::Cell::kFree) : walls;
}

Window windowOf(const core::Trajectory& path) {
  Window window;
  for (const auto& stamped : path) window.include(core::position(stamped.pose));
  return window;
}

Window usable(Window window) {
  if (window.isEmpty()) window.include(core::Point2{0, 0});
  const double least = std::max(0.05 * std::max(window.width(), window.height()), 0.5);
  if (window.width() < least) window.x0 -= least / 2, window.x1 += least / 2;
  if (window.height() < least) window.y0 -= least / 2, window.y1 += least / 2;
  return window.grownBy(0.025);
}

Window withEstimates(const Window& truth, const Window& estimates) {
  Window all = truth;
  all.include(truth.isEmpty() ? estimates : estimates.cutTo(truth.grownBy(0.1)));
  return all;
}

Window commonWindow(const std::vector<Window>& maps, const Window& truth, const Window& estimates) {
  std::vector<double> left, bottom, right, top;
  for (const auto& map : maps) {
    if (map.isEmpty()) continue;
    left.push_back(-map.x0), bottom.push_back(-map.y0);
    right.push_back(map.x1), top.push_back(map.y1);
  }
  if (left.empty()) return usable(withEstimates(truth, estimates));
  Window window{-middle(left), -middle(bottom), middle(right), middle(top)};
  if (window.isEmpty()) return usable(withEstimates(truth, estimates));
  const Window most = window.grownBy(0.15);
  for (const auto& map : maps) {
    if (map.isEmpty()) continue;
    if (map.x0 > most.x0) window.x0 = std::min(window.x0, map.x0);
    if (map.y0 > most.y0) window.y0 = std::min(window.y0, map.y0);
    if (map.x1 < most.x1) window.x1 = std::max(window.x1, map.x1);
    if (map.y1 < most.y1) window.y1 = std::max(window.y1, map.y1);
  }
  window.include(truth);
  return usable(window);
}

Pixel MapView::toPixel(const core::Point2& p_world) const {
  return {box.left + (p_world.x - window.x0) * pixelsPerMetre(),
          box.top + box.height - (p_world.y - window.y0) * pixelsPerMetre()};
}

core::Point2 MapView::toWorld(Pixel pixel) const {
  return {window.x0 + (pixel.x - box.left) / pixelsPerMetre(),
          window.y0 + (box.top + box.height - pixel.y) / pixelsPerMetre()};
}

LabelRaster::LabelRaster(const world::CellMap& raster, const core::Pose2& T_world_raster)
    : columns_(raster.columns),
      rows_(raster.rows),
      resolution_m_(raster.resolution_m),
      T_world_raster_(T_world_raster),
      cosine_(core::cos(T_world_raster.phi)),
      sine_(core::sin(T_world_raster.phi)) {
  labels_.reserve(raster.cells.size());
}

unsigned char LabelRaster::at(const core::Point2& p_world, double side_m) const {
  const double dx = p_world.x - T_world_raster_.x, dy = p_world.y - T_world_raster_.y;
  const double x = (cosine_ * dx + sine_ * dy) / resolution_m_,
               y = (cosine_ * dy - sine_ * dx) / resolution_m_;
  const double half = side_m > resolution_m_ ? 0.5 * side_m / resolution_m_ : 0;
  // Clamped as reals: a far point would overflow an int.
  const auto cell = [](double v, double low, double high) {
    return static_cast<int>(std::clamp(std::floor(v), low, high));
  };
  const int column0 = cell(x - half, 0, columns_), column1 = cell(x + half, -1, columns_ - 1);
  const int row0 = cell(y - half, 0, rows_), row1 = cell(y + half, -1, rows_ - 1);
  unsigned char highest = 0;
  for (int row = row0; row <= row1; ++row)
    for (int column = column0; column <= column1; ++column)
      highest = std::max(highest, labels_[static_cast<size_t>(row) * columns_ + column]);
  return highest;
}

void drawRaster(Canvas& canvas, const MapView& view, const world::CellMap& raster,
                const core::Pose2& T_world_raster) {
  // Ranked: 2 a wall, 1 free, 0 unknown.
  const LabelRaster labels(raster, T_world_raster, [&raster](int column, int row) {
    const auto cell = raster.at(column, row);
    return static_cast<unsigned char>(cell == world::Cell::kOccupied ? 2
                                      : cell == world::Cell::kFree   ? 1
                                                                     : 0);
  });
  const double side_m = 1 / (view.pixelsPerMetre() * Canvas::kSubpixels);
  canvas.paint(view.box, [&](Pixel pixel) {
    const auto label = labels.at(view.toWorld(pixel), side_m);
    return label == 2 ? kWall : label == 1 ? kFree : kUnknown;
  });
}

namespace {

/// Along the whole line, round its corners too; a point that is not finite ends a dash and begins one behind
/// it.
void drawDashes(Canvas& canvas, const std::vector<Pixel>& points, Colour colour, double line_width) {
  constexpr double kDash = 8, kGap = 9;
  std::vector<Pixel> dash;
  bool is_dash = true;
  double left = kDash;
  const auto finish = [&] {
    if (dash.size() > 1) canvas.polyline(dash, colour, line_width);
    dash.clear();
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Pixel to = points[i];
    if (i == 0 || !std::isfinite(points[i - 1].x + points[i - 1].y) || !std::isfinite(to.x + to.y)) {
      finish();
      is_dash = true, left = kDash;
      if (std::isfinite(to.x + to.y)) dash.push_back(to);
      continue;
    }
    const Pixel a = points[i - 1];
    const double length = core::hypot(to.x - a.x, to.y - a.y);
    for (double done = 0; length - done > 0;) {
      const double step = std::min(left, length - done);
      done += step, left -= step;
      const Pixel at{a.x + (to.x - a.x) * done / length, a.y + (to.y - a.y) * done / length};
      if (is_dash) dash.push_back(at);
      if (left > 0) continue;
      finish();
      is_dash = !is_dash, left = is_dash ? kDash : kGap;
      if (is_dash) dash.push_back(at);
    }
  }
  finish();
}

}  // namespace

void drawPath(Canvas& canvas, const MapView& view, const core::Trajectory& path, Colour colour,
              double line_width) {
  std::vector<Pixel> points;
  for (const auto& stamped : path) points.push_back(view.toPixel(core::position(stamped.pose)));
  canvas.polyline(points, colour, line_width);
}

void drawDashedPath(Canvas& canvas, const MapView& view, const core::Trajectory& path, Colour colour,
                    double line_width) {
  std::vector<Pixel> points;
  for (const auto& stamped : path) points.push_back(view.toPixel(core::position(stamped.pose)));
  drawDashes(canvas, points, colour, line_width);
}

void drawStart(Canvas& canvas, Pixel at) {
  canvas.disc(at, 7.5, {255, 255, 255});
  canvas.disc(at, 6.5, kInk);
  canvas.disc(at, 3.5, {255, 255, 255});
}

LegendStrip::LegendStrip(std::vector<LegendEntry> entries, double width, double pixels_per_metre)
    : entries_(std::move(entries)),
      width_(width),
      pixels_per_metre_(pixels_per_metre),
      bar_m_(niceStep(kMostOfScaleBar * width / pixels_per_metre)) {
  const double right_end = width - bar_m_ * pixels_per_metre - kGapBeforeBar -
                           Canvas::textWidth(barLabel(), kTextSize) - kGapAfterEntry;
  double x = 0, y = 0;
  for (auto& entry : entries_) {
    entry.label = Canvas::fitText(entry.label, kTextSize, right_end - kSample - kGapAfterSample);
    const double entry_width = kSample + kGapAfterSample + Canvas::textWidth(entry.label, kTextSize);
    if (x > 0 && x + entry_width > right_end) x = 0, y += kLine, ++lines_;
    places_.push_back({x, y});
    x += entry_width + kGapAfterEntry;
  }
}

std::string LegendStrip::barLabel() const {
  return stepLabel(bar_m_) + " m";
}

double LegendStrip::height() const {
  return lines_ * kLine;
}

void LegendStrip::draw(Canvas& canvas, Pixel upper_left) const {
  for (size_t i = 0; i < entries_.size(); ++i) {
    const auto& entry = entries_[i];
    const Pixel at{upper_left.x + places_[i].x, upper_left.y + places_[i].y + kLine / 2};
    const Pixel middle{at.x + kSample / 2, at.y};
    switch (entry.kind) {
      case LegendEntry::Kind::kLine:
      case LegendEntry::Kind::kBroadLine:
        canvas.line({at.x + 3, at.y}, {at.x + kSample - 3, at.y}, entry.colour,
                    entry.kind == LegendEntry::Kind::kLine ? 2.5 : 7);
        break;
      case LegendEntry::Kind::kDashes:
        drawDashes(canvas, {{at.x + 3, at.y}, {at.x + kSample - 3, at.y}}, entry.colour, 2);
        break;
      case LegendEntry::Kind::kBox: {
        const PixelBox sample{middle.x - 9, middle.y - 8, 18, 16};
        canvas.box(sample, entry.colour);
        canvas.frame(sample, kFrame, 1);
        break;
      }
      case LegendEntry::Kind::kStart:
        drawStart(canvas, middle);
        break;
      case LegendEntry::Kind::kDot:
        canvas.disc(middle, 5, entry.colour);
        break;
      case LegendEntry::Kind::kRing:
        canvas.circle(middle, 7, entry.colour, 1);
        break;
    }
    canvas.text({at.x + kSample + kGapAfterSample, at.y + 6}, entry.label, kTextSize, kInk);
  }
  drawScaleBar(canvas, {upper_left.x + width_, upper_left.y + kLine / 2});
}

void LegendStrip::drawScaleBar(Canvas& canvas, Pixel right_end) const {
  const double length = bar_m_ * pixels_per_metre_;
  const Pixel left_end{right_end.x - length, right_end.y};
  canvas.line(left_end, right_end, kInk, 2.5);
  for (const auto& end : {left_end, right_end})
    canvas.line({end.x, end.y - 6}, {end.x, end.y + 6}, kInk, 2.5);
  canvas.text({left_end.x - kGapBeforeBar, right_end.y + 6}, barLabel(), kTextSize, kInk, Align::kRight);
}

double niceStep(double most) {
  const double power = core::powerOfTen(static_cast<int>(std::floor(core::log10(most))));
  for (const double factor : {5.0, 2.0})
    if (factor * power <= most) return factor * power;
  return power;
}

std::string stepLabel(double value) {
  // Steps below 1 are products with an inexact power of ten.
  return files::formatNumber(std::round(value * 1e6) / 1e6);
}

double titleHeight(const std::string& title) {
  return title.empty() ? 0 : 44;
}

void drawTitle(Canvas& canvas, Pixel upper_left, const std::string& title, double width) {
  constexpr double kSize = 25;
  if (title.empty()) return;
  canvas.text({upper_left.x, upper_left.y + kSize}, Canvas::fitText(title, kSize, width, true), kSize, kInk,
              Align::kLeft, true);
}

}  // namespace slam::draw

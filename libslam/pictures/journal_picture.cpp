#include "libslam/pictures/journal_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "libslam/draw/canvas.h"
#include "libslam/draw/chart_axes.h"
#include "libslam/draw/map_view.h"

namespace slam::pictures {
namespace {

using core::JournalEvent;

constexpr double kLeastWidth = 900, kRowHeight = 24, kLabelWidth = 130, kChartHeight = 130, kAxisHeight = 56;
constexpr draw::Colour kPathColour{120, 120, 120}, kGridLine{225, 225, 225};

enum class Kind {
  kLoop,     ///< a line between two places
  kStretch,  ///< along the path
  kMark,     ///< a dot
  kStrip     ///< in the strip of time alone
};

struct Style {
  JournalEvent event;
  Kind kind;
  draw::Colour colour;
};

/// In the order in which they are drawn over one another and stand in the legend.
constexpr std::array<Style, 13> kStyles{{{JournalEvent::kDegenerate, Kind::kStretch, draw::kSkyBlue},
                                         {JournalEvent::kPoor, Kind::kStretch, draw::kOrange},
                                         {JournalEvent::kLost, Kind::kStretch, draw::kVermillion},
                                         {JournalEvent::kAccepted, Kind::kLoop, draw::kGreen},
                                         {JournalEvent::kRejected, Kind::kLoop, draw::kVermillion},
                                         {JournalEvent::kResampled, Kind::kMark, draw::kBlue},
                                         {JournalEvent::kDistrusted, Kind::kMark, draw::kPurple},
                                         {JournalEvent::kRecovered, Kind::kMark, draw::kGreen},
                                         {JournalEvent::kSearched, Kind::kStrip, draw::kGrey},
                                         {JournalEvent::kFound, Kind::kStrip, draw::kGrey},
                                         {JournalEvent::kConfirmed, Kind::kStrip, draw::kGrey},
                                         {JournalEvent::kDropped, Kind::kStrip, draw::kGrey},
                                         {JournalEvent::kOptimised, Kind::kStrip, draw::kInk}}};

/// The events that happened: those of kStyles in its order, then the others in that of their first time.
std::vector<std::pair<JournalEvent, Style>> stylesOf(const std::vector<core::JournalLine>& events) {
  std::vector<std::pair<JournalEvent, Style>> styles;
  const auto happened = [&](JournalEvent event) {
    return std::any_of(events.begin(), events.end(),
                       [&](const core::JournalLine& e) { return e.event == event; });
  };
  for (const auto& style : kStyles)
    if (happened(style.event)) styles.emplace_back(style.event, style);
  for (const auto& event : events)
    if (std::none_of(styles.begin(), styles.end(), [&](const auto& s) { return s.first == event.event; }))
      styles.emplace_back(event.event, Style{event.event, Kind::kMark, draw::kYellow});
  return styles;
}

void drawStretches(draw::Canvas& canvas, const draw::MapView& view,
                   const std::vector<core::JournalLine>& events, JournalEvent event, draw::Colour colour) {
  constexpr double kWidth = 6;
  std::vector<draw::Pixel> points;
  int last_scan = -2;
  const auto end = [&] {
    if (points.size() == 1) canvas.disc(points.front(), kWidth / 2, colour);
    canvas.polyline(points, colour, kWidth);
    points.clear();
  };
  for (const auto& e : events) {
    if (e.event != event) continue;
    if (e.scan > last_scan + 1) end();
    points.push_back(view.toPixel(e.place));
    last_scan = e.scan;
  }
  end();
}

/// From `lost` to where the robot was found, or to the end.
void drawLost(draw::Canvas& canvas, const draw::MapView& view, const core::Trajectory& path,
              const std::vector<core::JournalLine>& events, draw::Colour colour) {
  const auto draw = [&](double from_s, double to_s) {
    std::vector<draw::Pixel> points;
    for (const auto& stamped : path) {
      const double time_s = stamped.time_s - path.front().time_s;
      if (time_s >= from_s && time_s <= to_s) points.push_back(view.toPixel(core::position(stamped.pose)));
    }
    canvas.polyline(points, colour, 6);
  };
  double since_s = -1;
  for (const auto& e : events) {
    if (e.event == JournalEvent::kLost && since_s < 0) since_s = e.time_s;
    if (since_s < 0 || e.event != JournalEvent::kRecovered) continue;
    draw(since_s, e.time_s);
    since_s = -1;
  }
  if (since_s >= 0) draw(since_s, 1e300);
}

void drawEvents(draw::Canvas& canvas, const draw::MapView& view, const core::Trajectory& path,
                const std::vector<core::JournalLine>& events, JournalEvent event, const Style& style) {
  if (style.kind == Kind::kStretch) {
    if (event == JournalEvent::kLost)
      drawLost(canvas, view, path, events, style.colour);
    else
      drawStretches(canvas, view, events, event, style.colour);
    return;
  }
  for (const auto& e : events) {
    if (e.event != event) continue;
    const draw::Pixel at = view.toPixel(e.place);
    if (style.kind == Kind::kMark) {
      canvas.disc(at, 4, style.colour);
      canvas.circle(at, 4, draw::kInk, 0.7);
    } else if (style.kind == Kind::kLoop) {
      const draw::Pixel other = view.toPixel(e.other_place);
      canvas.line(at, other, style.colour, 2);
      canvas.disc(at, 3.5, style.colour);
      canvas.disc(other, 3.5, style.colour);
    }
  }
}

std::vector<draw::LegendEntry> legendOf(const std::vector<std::pair<JournalEvent, Style>>& styles) {
  std::vector<draw::LegendEntry> entries{{draw::LegendEntry::Kind::kLine, kPathColour, "path"},
                                         {draw::LegendEntry::Kind::kStart, draw::kInk, "start"}};
  for (const auto& [event, style] : styles) {
    if (style.kind == Kind::kLoop)
      entries.push_back(
          {draw::LegendEntry::Kind::kLine, style.colour, std::string("loop ") + core::wordOf(event)});
    else if (style.kind == Kind::kStretch)
      entries.push_back({draw::LegendEntry::Kind::kBroadLine, style.colour, core::wordOf(event)});
    else if (style.kind == Kind::kMark)
      entries.push_back({draw::LegendEntry::Kind::kDot, style.colour, core::wordOf(event)});
  }
  return entries;
}

/// Rows of ticks over time and the graph's error, one under the other.
class TimeStrip {
 public:
  TimeStrip(const core::Trajectory& path, const std::vector<core::JournalLine>& events,
            const std::vector<std::pair<JournalEvent, Style>>& styles)
      : events_(events), styles_(styles) {
    if (!path.empty()) end_s_ = path.back().time_s - path.front().time_s;
    for (const auto& e : events) {
      end_s_ = std::max(end_s_, e.time_s);
      if (e.event == JournalEvent::kOptimised) largest_error_ = std::max(largest_error_, e.value);
    }
    if (!(end_s_ > 0)) end_s_ = 1;
  }

  double height() const {
    return kRowHeight * static_cast<double>(styles_.size()) + (hasError() ? kChartHeight + kRowHeight : 0) +
           kAxisHeight;
  }

  void draw(draw::Canvas& canvas, const draw::PixelBox& box) const {
    const double left = box.left + kLabelWidth, width = box.width - kLabelWidth - 10;
    const double axis_top = box.top + height() - kAxisHeight;
    const double step_s = draw::niceStep(end_s_ / 5);
    for (int i = 0; i * step_s <= end_s_ * (1 + 1e-9); ++i) {
      const double x = left + i * step_s / end_s_ * width;
      canvas.line({x, box.top}, {x, axis_top}, kGridLine, 1);
      canvas.text({x, axis_top + 20}, draw::stepLabel(i * step_s), draw::kTextSize, draw::kInk,
                  draw::Align::kCentre);
    }
    canvas.text({left + width / 2, axis_top + 44}, "time (s)", draw::kTextSize, draw::kInk,
                draw::Align::kCentre);
    double top = box.top;
    for (const auto& [event, style] : styles_) {
      drawRow(canvas, event, style.colour, {left, top, width, kRowHeight});
      top += kRowHeight;
    }
    if (hasError()) drawError(canvas, {left, top + kRowHeight, width, kChartHeight});
  }

 private:
  bool hasError() const { return largest_error_ > 0; }

  void drawRow(draw::Canvas& canvas, JournalEvent event, draw::Colour colour,
               const draw::PixelBox& row) const {
    canvas.text({row.left - 10, row.top + 17},
                draw::Canvas::fitText(core::wordOf(event), draw::kTextSize, kLabelWidth - 14),
                draw::kTextSize, draw::kInk, draw::Align::kRight);
    for (const auto& e : events_) {
      if (e.event != event) continue;
      const double x = row.left + e.time_s / end_s_ * row.width;
      canvas.line({x, row.top + 4}, {x, row.top + row.height - 4}, colour, 1.5);
    }
    canvas.line({row.left, row.top + row.height}, {row.left + row.width, row.top + row.height}, kGridLine, 1);
  }

  void drawError(draw::Canvas& canvas, const draw::PixelBox& box) const {
    const double step = draw::niceStep(largest_error_ / 2);
    const double most = step * std::ceil(largest_error_ / step - 1e-9);
    const auto pixel = [&](double time_s, double value) {
      return draw::Pixel{box.left + time_s / end_s_ * box.width, box.top + box.height * (1 - value / most)};
    };
    for (int i = 0; i * step <= most * (1 + 1e-9); ++i) {
      const draw::Pixel at = pixel(0, i * step);
      canvas.line(at, {box.left + box.width, at.y}, kGridLine, 1);
      canvas.text({at.x - 8, at.y + 6}, draw::stepLabel(i * step), draw::kTextSize, draw::kInk,
                  draw::Align::kRight);
    }
    canvas.text({box.left, box.top - 6}, "graph error after each optimisation (chi2)", draw::kTextSize,
                draw::kInk);
    std::vector<draw::Pixel> points;
    for (const auto& e : events_) {
      if (e.event != JournalEvent::kOptimised) continue;
      if (!points.empty()) points.push_back({pixel(e.time_s, 0).x, points.back().y});
      points.push_back(pixel(e.time_s, e.value));
    }
    canvas.polyline(points, draw::kBlue, 2);
    for (const auto& e : events_)
      if (e.event == JournalEvent::kOptimised) canvas.disc(pixel(e.time_s, e.value), 2.5, draw::kBlue);
    canvas.frame(box, draw::kFrame, 1);
  }

  const std::vector<core::JournalLine>& events_;
  const std::vector<std::pair<JournalEvent, Style>>& styles_;
  double end_s_ = 0, largest_error_ = 0;
};

}  // namespace

void drawJournal(const world::CellMap& map, const core::Trajectory& path,
                 const std::vector<core::JournalLine>& events, const std::string& title,
                 const std::string& file, const draw::Paper& paper) {
  const auto styles = stylesOf(events);
  draw::Window window = draw::windowOf(map, map.T_frame_raster);
  window.include(draw::windowOf(path).cutTo(window.isEmpty() ? draw::windowOf(path) : window.grownBy(0.1)));
  if (window.isEmpty()) window.include(core::Point2{0, 0});
  const double least_m = std::max(0.05 * std::max(window.width(), window.height()), 0.5);
  if (window.width() < least_m) window.x0 -= least_m / 2, window.x1 += least_m / 2;
  if (window.height() < least_m) window.y0 -= least_m / 2, window.y1 += least_m / 2;
  window = window.grownBy(0.025);

  const double margin = draw::sheetMargin(paper);
  const double paper_width = paper.unitsWide() - 2 * margin;
  const double scale = paper.isScreen()
                           ? std::min(1200 / window.width(), 900 / window.height())
                           : std::min(paper_width / window.width(), paper_width / window.height());
  const double map_width = std::round(window.width() * scale),
               map_height = std::round(window.height() * scale);
  const double width = paper.isScreen() ? std::max(kLeastWidth, map_width) : paper_width;
  const draw::LegendStrip legend(legendOf(styles), width, scale);
  const TimeStrip strip(path, events, styles);
  const double title_height = draw::titleHeight(title);
  const double legend_top = margin + title_height + map_height + 12;
  const double strip_top = legend_top + legend.height() + 20;
  draw::Canvas canvas(width + 2 * margin, std::round(strip_top + strip.height() + margin), paper);
  draw::drawTitle(canvas, {margin, margin}, title, width);
  const draw::MapView view{
      window, {std::round(margin + (width - map_width) / 2), margin + title_height, map_width, map_height}};
  draw::drawRaster(canvas, view, map, map.T_frame_raster);
  canvas.clipTo(view.box);
  draw::drawPath(canvas, view, path, kPathColour, 1.5);
  for (const auto& [event, style] : styles) drawEvents(canvas, view, path, events, event, style);
  if (!path.empty()) draw::drawStart(canvas, view.toPixel(core::position(path.front().pose)));
  canvas.liftClip();
  canvas.frame(view.box, draw::kFrame, 1);
  legend.draw(canvas, {margin, legend_top});
  strip.draw(canvas, {margin, strip_top, width, strip.height()});
  canvas.save(file);
}

}  // namespace slam::pictures

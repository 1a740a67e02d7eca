#include "libslam/report/page_chart.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/draw/canvas.h"
#include "libslam/draw/map_view.h"
#include "libslam/draw/page_text.h"
#include "libslam/report/page_plot.h"
#include "libslam/table/number_text.h"
#include "libslam/table/table.h"

namespace slam::report {
namespace {

constexpr double kWidth = 720, kHeight = 340, kLeft = 78, kRight = 22, kTop = 16, kBottom = 50;
constexpr double kWorthLogarithm_x = 50, kWorthLogarithm_y = 100;  // between least and most
constexpr double kOutlineTolerance = 0.3, kValueSpacing = 2;       // units of the drawing

std::string shortNumber(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

struct Tick {
  double value;
  std::string label;
};

/// One axis: where its values lie in the drawing.
struct Scale {
  double from = 0, to = 1;              // values
  double from_place = 0, to_place = 1;  // in the drawing
  bool is_log = false;

  double place(double value) const {
    const double share =
        is_log ? core::log(value / from) / core::log(to / from) : (value - from) / (to - from);
    return from_place + std::clamp(share, 0.0, 1.0) * (to_place - from_place);
  }
  std::vector<Tick> ticks() const {
    std::vector<Tick> ticks;
    if (!is_log) {
      const double step = draw::niceStep((to - from) / 5);
      const int decimals = std::max(0, static_cast<int>(-std::floor(core::log10(step) + 1e-9)));
      for (int i = 0; from + i * step <= to + 1e-9 * step; ++i)
        ticks.push_back({from + i * step, table::fixed(from + i * step, decimals)});
      return ticks;
    }
    const bool few = to / from < 1e3;
    for (int decade = static_cast<int>(std::floor(core::log10(from) + 1e-9));
         core::powerOfTen(decade) <= to * (1 + 1e-9); ++decade)
      for (const int digit : {1, 2, 5})
        if (const double value = digit * core::powerOfTen(decade);
            (few || digit == 1) && value >= from * (1 - 1e-9) && value <= to * (1 + 1e-9))
          ticks.push_back({value, table::fixed(value, std::max(0, -decade))});
    return ticks;
  }
};

struct Range {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  void include(double value) {
    if (std::isfinite(value)) least = std::min(least, value), most = std::max(most, value);
  }
  bool isEmpty() const { return !(least <= most); }
};

bool isDrawn(const core::Point2& p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}

/// From 0, or by the logarithm.
Scale scaleOf(const Range& range, double given_end, double worth_logarithm) {
  Scale scale;
  scale.is_log = !(given_end > 0) && range.least > 0 && range.most / range.least > worth_logarithm;
  if (scale.is_log) {
    scale.from = core::powerOfTen(static_cast<int>(std::floor(core::log10(range.least) + 1e-9)));
    scale.to = core::powerOfTen(static_cast<int>(std::ceil(core::log10(range.most) - 1e-9)));
    return scale;
  }
  scale.to = given_end > 0 ? given_end : range.most > 0 ? range.most : 1;
  if (!(given_end > 0)) {
    const double step = draw::niceStep(scale.to / 5);
    scale.to = step * std::ceil(scale.to / step - 1e-9);
  }
  return scale;
}

struct Axes {
  Scale x, y;
  core::Point2 place(const core::Point2& p) const { return {x.place(p.x), y.place(p.y)}; }
};

Axes axesOf(const PageChart& chart, const Range& x, const Range& y) {
  Axes axes{scaleOf(x, chart.duration_s, kWorthLogarithm_x), scaleOf(y, chart.y_max, kWorthLogarithm_y)};
  // Values of an experiment that are few, such as 90 to 360: the axis keeps to them.
  if (axes.x.is_log) axes.x.from = x.least, axes.x.to = x.most;
  axes.x.from_place = kLeft, axes.x.to_place = kWidth - kRight;
  axes.y.from_place = kHeight - kBottom, axes.y.to_place = kTop;
  return axes;
}

std::string textElement(double x, double y, const std::string& anchor, const std::string& text) {
  return "<text x=\"" + table::fixed(x, 1) + "\" y=\"" + table::fixed(y, 1) + "\" text-anchor=\"" + anchor +
         "\">" + draw::htmlText(text) + "</text>\n";
}

std::string frame(const PageChart& chart, const Axes& axes) {
  std::string grid, labels;
  const double bottom = kHeight - kBottom, right = kWidth - kRight;
  for (const auto& tick : axes.y.ticks()) {
    const double y = axes.y.place(tick.value);
    grid += "M" + table::fixed(kLeft, 1) + " " + table::fixed(y, 1) + "H" + table::fixed(right, 1);
    labels += textElement(kLeft - 8, y + 5, "end", tick.label);
  }
  for (const auto& tick : axes.x.ticks()) {
    const double x = axes.x.place(tick.value);
    grid += "M" + table::fixed(x, 1) + " " + table::fixed(kTop, 1) + "V" + table::fixed(bottom, 1);
    labels += textElement(x, bottom + 19, "middle", tick.label);
  }
  return "<path class=\"grid\" d=\"" + grid + "\"/>\n" + labels +
         textElement((kLeft + right) / 2, kHeight - 8, "middle", chart.x_title) +
         "<text class=\"axis\" transform=\"translate(18 " + table::fixed((kTop + bottom) / 2, 1) +
         ") rotate(-90)\" text-anchor=\"middle\">" + draw::htmlText(chart.y_title) + "</text>\n";
}

/// "x y low high" of points at most one per kValueSpacing, and of those that have an interval or a cross.
std::string valuesOf(const PageCurve& curve, const Axes& axes) {
  std::string text;
  double last_place = -kWidth;
  for (size_t i = 0; i < curve.points.size(); ++i) {
    const auto& p = curve.points[i];
    const bool has_interval =
        !curve.low.empty() && std::isfinite(curve.low[i]) && std::isfinite(curve.high[i]);
    const bool is_last = i + 1 == curve.points.size();
    if (!isDrawn(p) || (!has_interval && !is_last && axes.x.place(p.x) < last_place + kValueSpacing))
      continue;
    last_place = axes.x.place(p.x);
    text += (text.empty() ? "" : ";") + shortNumber(p.x) + " " + shortNumber(p.y);
    if (has_interval) text += " " + shortNumber(curve.low[i]) + " " + shortNumber(curve.high[i]);
  }
  return text;
}

/// `shift`: to the side, so that intervals at one value do not hide one another.
std::string curveElement(const PageCurve& curve, const Axes& axes, size_t series, draw::Colour colour,
                         double shift) {
  std::vector<core::Point2> line;
  std::string whiskers, dots, crosses;
  for (size_t i = 0; i < curve.points.size(); ++i) {
    const auto& p = curve.points[i];
    const bool drawn = isDrawn(p) && (!axes.y.is_log || p.y > 0);
    if (!drawn) {
      line.push_back({std::numeric_limits<double>::quiet_NaN(), 0});
      continue;
    }
    auto place = axes.place(p);
    place.x += shift;
    line.push_back({place.x, -place.y});  // pathOutline() draws y upwards
    if (!curve.low.empty() && std::isfinite(curve.low[i]) && std::isfinite(curve.high[i])) {
      const double low = axes.y.place(std::max(curve.low[i], axes.y.from)),
                   high = axes.y.place(curve.high[i]);
      whiskers += "M" + table::fixed(place.x, 1) + " " + table::fixed(low, 1) + "V" + table::fixed(high, 1) +
                  "M" + table::fixed(place.x - 4, 1) + " " + table::fixed(low, 1) + "h8M" +
                  table::fixed(place.x - 4, 1) + " " + table::fixed(high, 1) + "h8";
    }
    const bool is_broken = !curve.broken.empty() && curve.broken[i];
    if (is_broken)
      crosses +=
          "M" + table::fixed(place.x - 6, 1) + " " + table::fixed(place.y - 6, 1) + "l12 12m0 -12l-12 12";
    else if (!curve.low.empty())
      dots += "M" + table::fixed(place.x, 1) + " " + table::fixed(place.y, 1) + "z";
  }
  std::string html = "<g data-series=\"" + std::to_string(series) + "\" data-values=\"" +
                     valuesOf(curve, axes) + "\" stroke=\"" + draw::cssColour(colour) + "\">";
  const auto path = [&](const char* name, const std::string& outline) {
    if (!outline.empty()) html += std::string("<path class=\"") + name + "\" d=\"" + outline + "\"/>";
  };
  path("line", pathOutline(line, kOutlineTolerance));
  path("whisker", whiskers);
  path("dot", dots);
  path("cross", crosses);
  return html + "</g>\n";
}

}  // namespace

std::string chartElement(const PageChart& chart) {
  Range x, y;
  std::vector<std::string> labels, notes;
  for (const auto& curve : chart.curves) {
    if ((!curve.low.empty() && curve.low.size() != curve.points.size()) ||
        curve.low.size() != curve.high.size() ||
        (!curve.broken.empty() && curve.broken.size() != curve.points.size()))
      throw core::ContractError("chartElement: " + curve.label + " has not as many intervals as points");
    for (size_t i = 0; i < curve.points.size(); ++i) {
      if (!isDrawn(curve.points[i])) continue;
      x.include(curve.points[i].x);
      y.include(curve.points[i].y);
      if (!curve.low.empty()) y.include(curve.low[i]), y.include(curve.high[i]);
    }
    if (std::find(labels.begin(), labels.end(), curve.label) != labels.end()) continue;
    labels.push_back(curve.label);
    notes.push_back(curve.note);
  }
  if (x.isEmpty() || y.isEmpty()) return "";
  const Axes axes = axesOf(chart, x, y);
  const auto place = [](double value) { return table::fixed(value, 0); };
  std::string svg = "<svg class=\"chart asked\" id=\"" + draw::htmlText(chart.id) + "\" viewBox=\"0 0 " +
                    place(kWidth) + " " + place(kHeight) + "\" role=\"img\" aria-label=\"" +
                    draw::htmlText(chart.y_title + " over " + chart.x_title) + "\" data-left=\"" +
                    place(kLeft) + "\" data-right=\"" + place(kWidth - kRight) + "\" data-top=\"" +
                    place(kTop) + "\" data-bottom=\"" + place(kHeight - kBottom) + "\" data-from=\"" +
                    shortNumber(axes.x.from) + "\" data-to=\"" + shortNumber(axes.x.to) + "\" data-x=\"" +
                    draw::htmlText(chart.x_title) + "\" data-y=\"" + draw::htmlText(chart.y_title) + "\"";
  const auto colours = draw::labelColours(labels);
  if (axes.x.is_log) svg += " data-log=\"1\"";
  if (chart.duration_s > 0) svg += " data-duration=\"" + table::fixed(chart.duration_s, 3) + "\"";
  svg += ">\n" + frame(chart, axes);
  for (size_t i = chart.curves.size(); i-- > 0;) {  // the first lies on top
    const auto& curve = chart.curves[i];
    const auto series =
        static_cast<size_t>(std::find(labels.begin(), labels.end(), curve.label) - labels.begin());
    const double middle = (static_cast<double>(labels.size()) - 1) / 2;
    const double shift = curve.low.empty() ? 0 : 5 * (static_cast<double>(series) - middle);
    svg += curveElement(curve, axes, series, colours[series], shift);
  }
  svg += "</svg>";
  std::string legend = "<ul class=\"legend\" data-chart=\"" + draw::htmlText(chart.id) + "\">";
  for (size_t i = 0; i < labels.size(); ++i)
    legend += "<li data-series=\"" + std::to_string(i) + "\">" + swatchElement(colours[i]) + "<span>" +
              draw::htmlText(labels[i]) + "</span>" +
              (notes[i].empty() ? "" : ": " + draw::htmlText(notes[i])) + "</li>";
  legend += "</ul>\n";
  std::string caption = chart.caption;
  if (axes.x.is_log) caption += " The lower axis is logarithmic.";
  if (axes.y.is_log) caption += " The left axis is logarithmic.";
  return "<figure><section class=\"wide\" tabindex=\"0\" aria-label=\"" + draw::htmlText(chart.caption) +
         "\">" + svg + "</section><figcaption>" + draw::htmlText(caption) + legend +
         "</figcaption></figure>\n";
}

}  // namespace slam::report

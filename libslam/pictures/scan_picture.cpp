#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/draw/chart_axes.h"
#include "libslam/draw/map_view.h"
#include "libslam/pictures/picture.h"

namespace slam::pictures {
namespace {

/// The chart and the view from above, beside one another where the width allows.
struct Layout {
  double width = 1400, height = 600;
  draw::PixelBox chart{85, 55, 745, 470};
  draw::Pixel centre{1120, 290};
  double radius = 230;
};
constexpr double kBelowChart = 64, kBelowRings = 66;

Layout layoutFor(const draw::Paper& paper) {
  Layout layout;
  if (paper.isScreen()) return layout;
  const double width = paper.unitsWide(), margin = draw::sheetMargin(paper);
  layout.width = width;
  constexpr double kLeft = 58, kHead = 40, kLeastBeside = 800;
  if (width >= kLeastBeside) {
    layout.radius = 0.19 * width;
    layout.centre = {width - margin - layout.radius - 4, kHead + layout.radius + 4};
    layout.chart = {kLeft, kHead, layout.centre.x - layout.radius - kLeft - 40, 2 * layout.radius - 10};
    layout.height = kHead + 2 * layout.radius + kBelowRings;
  } else {
    layout.chart = {kLeft, kHead, width - kLeft - 14, 0.6 * width};
    layout.radius = 0.36 * width;
    layout.centre = {width / 2, layout.chart.top + layout.chart.height + kBelowChart + kHead + layout.radius};
    layout.height = layout.centre.y + layout.radius + kBelowRings;
  }
  layout.height = std::round(layout.height);
  return layout;
}

constexpr double kTitleSize = 20;
constexpr draw::Colour kRule{222, 222, 222}, kSeenArea{226, 240, 250};

/// Ends of both range axes and their ticks, metres.
struct RangeAxis {
  double end_m, step_m;
};

RangeAxis rangeAxis(const lidar::Scan& scan) {
  double farthest_m = 0;
  for (const float range_m : scan.ranges_m)
    if (lidar::isReturn(range_m)) farthest_m = std::max(farthest_m, static_cast<double>(range_m));
  if (farthest_m == 0) farthest_m = scan.max_range_m > 0 ? scan.max_range_m : 1;
  const double step_m = draw::niceStep(farthest_m / 4);
  return {step_m * std::ceil(farthest_m / step_m - 1e-9), step_m};
}

/// Degrees between ticks, so that there are at most nine.
double angleStep_deg(double span_deg) {
  for (const double step : {1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0})
    if (span_deg / step <= 8) return step;
  return 90;
}

class Chart {
 public:
  Chart(draw::Canvas& canvas, const draw::PixelBox& box, const lidar::Scan& scan, const RangeAxis& ranges)
      : canvas_(canvas), box_(box), scan_(scan), ranges_(ranges) {
    const double last_rad = scan.angle(scan.ranges_m.empty() ? 0 : scan.ranges_m.size() - 1);
    first_deg_ = core::radToDeg(scan.first_angle_rad), last_deg_ = core::radToDeg(last_rad);
    if (!(last_deg_ - first_deg_ > 1e-6))
      first_deg_ -= 0.5, last_deg_ += 0.5;  // a single beam stands in the middle
  }

  void draw() const {
    canvas_.text({box_.left, box_.top - 21}, "Range over angle", kTitleSize, draw::kInk, draw::Align::kLeft,
                 true);
    drawRangeTicks();
    drawAngleTicks();
    canvas_.frame(box_, draw::kFrame, 1);
    drawReadings();
  }

 private:
  draw::Pixel at(double angle_deg, double range_m) const {
    return {box_.left + box_.width * (angle_deg - first_deg_) / (last_deg_ - first_deg_),
            box_.top + box_.height * (1 - range_m / ranges_.end_m)};
  }

  void drawRangeTicks() const {
    for (int i = 0; i * ranges_.step_m <= ranges_.end_m * (1 + 1e-9); ++i) {
      const double y = at(first_deg_, i * ranges_.step_m).y;
      canvas_.line({box_.left, y}, {box_.left + box_.width, y}, kRule, 1);
      canvas_.text({box_.left - 10, y + 6}, draw::stepLabel(i * ranges_.step_m), draw::kTextSize, draw::kInk,
                   draw::Align::kRight);
    }
    canvas_.text({box_.left - 10, box_.top - 21}, "m", draw::kTextSize, draw::kInk, draw::Align::kRight);
  }

  void drawAngleTicks() const {
    const double step = angleStep_deg(last_deg_ - first_deg_);
    for (double k = std::ceil(first_deg_ / step - 1e-6); k * step <= last_deg_ + 1e-6; ++k) {
      const double x = at(k * step, 0).x, bottom = box_.top + box_.height;
      canvas_.line({x, box_.top}, {x, bottom}, kRule, 1);
      canvas_.line({x, bottom}, {x, bottom + 6}, draw::kInk, 1);
      canvas_.text({x, bottom + 26}, draw::stepLabel(k * step + 0.0), draw::kTextSize, draw::kInk,
                   draw::Align::kCentre);
    }
    canvas_.text({box_.left + box_.width / 2, box_.top + box_.height + 54},
                 "beam angle (degrees, 0 ahead, left positive)", draw::kTextSize, draw::kInk,
                 draw::Align::kCentre);
  }

  void drawReadings() const {
    // One place per beam; a beam without a return has none, and the line breaks there.
    std::vector<draw::Pixel> places;
    const double nowhere = std::nan("");
    for (size_t i = 0; i < scan_.ranges_m.size(); ++i) {
      const bool is_return = lidar::isReturn(scan_.ranges_m[i]);
      places.push_back(is_return ? at(core::radToDeg(scan_.angle(i)), scan_.ranges_m[i])
                                 : draw::Pixel{nowhere, nowhere});
    }
    canvas_.polyline(places, draw::kSkyBlue, 1.5);
    for (const auto& place : places) canvas_.disc(place, places.size() > 400 ? 1.6 : 2.2, draw::kBlue);
  }

  draw::Canvas& canvas_;
  draw::PixelBox box_;
  const lidar::Scan& scan_;
  RangeAxis ranges_;
  double first_deg_, last_deg_;
};

/// As seen from above with the lidar looking up the page.
draw::Pixel polar(draw::Pixel centre, double angle_rad, double radius) {
  return {centre.x - radius * core::sin(angle_rad), centre.y - radius * core::cos(angle_rad)};
}

void drawSeenArea(draw::Canvas& canvas, draw::Pixel centre, const lidar::Scan& scan, double units_per_metre) {
  for (size_t i = 0; i + 1 < scan.ranges_m.size(); ++i) {
    if (!lidar::isReturn(scan.ranges_m[i]) || !lidar::isReturn(scan.ranges_m[i + 1])) continue;
    canvas.fillPolygon({centre, polar(centre, scan.angle(i), scan.ranges_m[i] * units_per_metre),
                        polar(centre, scan.angle(i + 1), scan.ranges_m[i + 1] * units_per_metre)},
                       kSeenArea);
  }
}

void drawPolar(draw::Canvas& canvas, draw::Pixel centre, double radius, const lidar::Scan& scan,
               const RangeAxis& ranges) {
  const double units_per_metre = radius / ranges.end_m;
  canvas.text({centre.x - radius - 4, centre.y - radius - 18}, "From above", kTitleSize, draw::kInk,
              draw::Align::kLeft, true);
  drawSeenArea(canvas, centre, scan, units_per_metre);
  for (int i = 1; i * ranges.step_m <= ranges.end_m * (1 + 1e-9); ++i)
    canvas.circle(centre, i * ranges.step_m * units_per_metre, kRule, 1);
  for (const double degrees : {0.0, 90.0, 180.0, 270.0})
    canvas.line(centre, polar(centre, core::degToRad(degrees), radius), kRule, 1);
  for (size_t i = 0; i < scan.ranges_m.size(); ++i)
    if (lidar::isReturn(scan.ranges_m[i]))
      canvas.disc(polar(centre, scan.angle(i), scan.ranges_m[i] * units_per_metre), 2.2, draw::kBlue);
  canvas.fillPolygon(
      {polar(centre, 0, 12), polar(centre, core::degToRad(140), 10), polar(centre, core::degToRad(220), 10)},
      draw::kVermillion);
  canvas.text({centre.x, centre.y + radius + 26},
              "rings every " + draw::stepLabel(ranges.step_m) + " m, ahead is up", draw::kTextSize,
              draw::kInk, draw::Align::kCentre);
}

}  // namespace

void drawScan(const lidar::Scan& scan, const std::string& file, const draw::Paper& paper) {
  const auto layout = layoutFor(paper);
  draw::Canvas canvas(layout.width, layout.height, paper);
  const auto ranges = rangeAxis(scan);
  Chart(canvas, layout.chart, scan, ranges).draw();
  drawPolar(canvas, layout.centre, layout.radius, scan, ranges);
  const auto returns = std::count_if(scan.ranges_m.begin(), scan.ranges_m.end(), lidar::isReturn);
  canvas.text({layout.centre.x, layout.centre.y + layout.radius + 50},
              std::to_string(returns) + " returns of " + std::to_string(scan.ranges_m.size()) + " beams",
              draw::kTextSize, draw::kGrey, draw::Align::kCentre);
  canvas.save(file);
}

}  // namespace slam::pictures

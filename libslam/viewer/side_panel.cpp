#include "libslam/viewer/side_panel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "libslam/draw/canvas.h"
#include "libslam/draw/map_view.h"

namespace slam::viewer {
namespace {

using draw::Align;
using draw::Canvas;
using draw::Colour;
using draw::Pixel;
using draw::PixelBox;

constexpr double kMargin = 14, kInner = kPanelWidth - 2 * kMargin;
constexpr double kTitleSize = 18, kTextSize = 15, kTickSize = 13;
constexpr double kGap = 13, kHeadingHeight = 24, kAxisHeight = 20;
constexpr size_t kMostLines = 2;    // of a line of the status
constexpr size_t kStatusLines = 8;  // room for the longest status, so that what stands below does not jump
constexpr double kChartHeight = 108, kZoneHeight = 152, kLeastChartHeight = 38, kLeastZoneHeight = 52;
constexpr double kHelpHeight = 22;
constexpr Colour kInk = draw::kInk, kGrey = draw::kGrey, kRule{226, 226, 226}, kZone{214, 214, 214},
                 kWhite{255, 255, 255}, kSeen = draw::kVermillion, kRemembered = draw::kBlue;

template <class... Values>
std::string format(const char* pattern, Values... values) {
  char text[200];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

std::string poseText(const char* name, const core::Pose2& pose) {
  return format("%s (%.2f, %.2f) m, %.0f deg", name, pose.x, pose.y, core::radToDeg(pose.phi));
}

/// In lines that fit the panel; of a long text the first two.
std::vector<std::string> wrapped(const std::string& text, double size, bool bold) {
  std::vector<std::string> lines = {""};
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
    const bool fits = Canvas::textWidth(longer, size, bold) <= kInner;
    if (fits || lines.back().empty() || lines.size() == kMostLines)
      lines.back() = longer;
    else
      lines.push_back(word);
  }
  for (auto& line : lines) line = Canvas::fitText(line, size, kInner, bold);
  return lines;
}

double heading(Canvas& canvas, double top, const std::string& text) {
  canvas.text({kMargin, top + kTextSize}, text, kTextSize, kInk, Align::kLeft, true);
  return top + kTextSize + 9;
}

/// Range over angle: the original chart. Returns where it ends.
double drawChart(Canvas& canvas, double top, double height, const lidar::Scan& scan) {
  top = heading(canvas, top, "Scan: range (m), angle (deg)");
  const PixelBox box{kMargin + 26, top, kInner - 30, height};
  double farthest_m = 1;
  for (const float range_m : scan.ranges_m)
    if (lidar::isReturn(range_m)) farthest_m = std::max(farthest_m, static_cast<double>(range_m));
  const double step_m = draw::niceStep(farthest_m / 2);
  const double end_m = step_m * std::ceil(farthest_m / step_m - 1e-9);
  const double first_rad = scan.first_angle_rad;
  const double last_rad = scan.angle(scan.ranges_m.empty() ? 0 : scan.ranges_m.size() - 1);
  const double span_rad = std::max(last_rad - first_rad, 1e-3);
  const auto at = [&](double angle_rad, double range_m) {
    return Pixel{box.left + box.width * (angle_rad - first_rad) / span_rad,
                 box.top + box.height * (1 - range_m / end_m)};
  };
  canvas.box(box, kWhite);
  for (int i = 0; i * step_m <= end_m * (1 + 1e-9); ++i) {
    const double y = at(first_rad, i * step_m).y;
    canvas.line({box.left, y}, {box.left + box.width, y}, kRule, 1);
    canvas.text({box.left - 5, y + 5}, draw::stepLabel(i * step_m), kTickSize, kGrey, Align::kRight);
  }
  for (int degrees = -270; degrees <= 270; degrees += 90) {
    const double angle_rad = core::degToRad(degrees);
    if (angle_rad < first_rad - 1e-6 || angle_rad > last_rad + 1e-6) continue;
    const double x = at(angle_rad, 0).x;
    canvas.line({x, box.top}, {x, box.top + box.height}, kRule, 1);
    canvas.text({x, box.top + box.height + 15}, std::to_string(degrees), kTickSize, kGrey, Align::kCentre);
  }
  canvas.frame(box, draw::kFrame, 1);
  std::vector<Pixel> line;
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const bool is_return = lidar::isReturn(scan.ranges_m[i]);
    line.push_back(is_return ? at(scan.angle(i), static_cast<double>(scan.ranges_m[i]))
                             : Pixel{std::nan(""), std::nan("")});
  }
  canvas.clipTo(box);
  canvas.polyline(line, kSeen, 1.2);
  for (const auto& place : line) canvas.disc(place, 1, kSeen);
  canvas.liftClip();
  return box.top + box.height + kAxisHeight + kGap;
}

/// The original picture of the local obstacle map: ahead is up. Returns where it ends.
double drawZone(Canvas& canvas, double top, double height, const LocalObstacles& obstacles,
                double robot_side_m) {
  top = heading(canvas, top, "Obstacles around the robot");
  const double depth_m = obstacles.front_m + obstacles.rear_m;
  const double scale = std::min(kInner * 0.62 / obstacles.width_m, height / depth_m);
  const PixelBox box{kMargin, top, obstacles.width_m * scale, depth_m * scale};
  const auto at = [&](const core::Point2& p) {
    return Pixel{box.left + box.width / 2 - scale * p.y, box.top + scale * (obstacles.front_m - p.x)};
  };
  canvas.box(box, kZone);
  canvas.clipTo(box);
  std::vector<Pixel> outline;
  for (const auto& corner : obstacles.visible) outline.push_back(at(corner));
  if (outline.size() > 2) canvas.fillPolygon(outline, kWhite);
  const double half = robot_side_m / 2;
  canvas.circle(at({0, 0}), std::sqrt(2.0) * half * scale, kInk, 1);
  canvas.fillPolygon({at({half, half}), at({half, -half}), at({-half, -half}), at({-half, half})}, kInk);
  for (const auto& p : obstacles.remembered) canvas.disc(at(p), 2, kRemembered);
  for (const auto& p : obstacles.seen) canvas.disc(at(p), 2, kSeen);
  canvas.liftClip();
  canvas.frame(box, draw::kFrame, 1);
  const double left = box.left + box.width + 12;
  const double pitch = std::min(21.0, (height - 4) / 4);
  double y = box.top + std::min(16.0, pitch);
  const auto row = [&](Colour colour, bool is_dot, const char* text) {
    if (is_dot) {
      canvas.disc({left + 6, y - 5}, 3.5, colour);
    } else {
      canvas.box({left, y - 11, 12, 12}, colour);
      canvas.frame({left, y - 11, 12, 12}, draw::kFrame, 1);
    }
    canvas.text({left + 19, y}, text, kTickSize, kInk);
    y += pitch;
  };
  row(kWhite, false, "in view");
  row(kZone, false, "out of view");
  row(kSeen, true, "seen now");
  row(kRemembered, true, "remembered");
  return box.top + box.height + kGap;
}

struct LegendRow {
  char key;  ///< that switches it; 0: none
  Colour colour;
  const char* text;
};

std::vector<LegendRow> legendRows(const Snapshot& snapshot) {
  std::vector<LegendRow> rows = {{0, draw::kVermillion, "robot"}};
  const auto add = [&](bool is_there, char key, Colour colour, const char* text) {
    if (is_there) rows.push_back({key, colour, text});
  };
  add(snapshot.T_scene_truth.has_value(), '1', {150, 150, 155}, "true walls");
  add(snapshot.map != nullptr, '2', kInk, "map");
  add(!snapshot.truth.empty(), '3', {170, 170, 170}, "true path");
  add(!snapshot.path.empty(), '4', draw::kBlue, "estimated path");
  add(!snapshot.nodes.empty(), '5', draw::kGreen, "graph");
  add(!snapshot.nodes.empty() || !snapshot.loops.empty(), '5', draw::kOrange, "loops closed");
  add(snapshot.obstacles.has_value(), '6', kRemembered, "obstacles");
  add(true, '7', kSeen, "scan");
  add(snapshot.candidates.has_value(), '8', draw::kYellow, "goal, way, choices");
  add(snapshot.strategic.has_value(), '8', draw::kGreen, "directions");
  add(!snapshot.particles.empty(), '9', draw::kPurple, "particles");
  add(!snapshot.people.empty(), '0', kInk, "people");
  return rows;
}

/// How the panel is laid out in its height.
struct PanelLayout {
  double text_size, line_pitch;
  size_t legend_columns;
  double row_pitch;
  double chart_height = 0, zone_height = 0;  ///< 0: left out
};

double statusHeight(const PanelLayout& layout, size_t lines) {
  return kMargin + kTitleSize + layout.line_pitch * static_cast<double>(std::max(lines, kStatusLines) - 1) +
         kGap;
}

double legendHeight(const PanelLayout& layout, size_t rows) {
  return kHeadingHeight + 12 +
         layout.row_pitch * std::ceil(static_cast<double>(rows) / static_cast<double>(layout.legend_columns));
}

/// The first layout that holds everything, else the smallest with what finds room. `rows` and `lines` as they
/// will be drawn.
PanelLayout layOut(const Snapshot& snapshot, const PanelState& state, size_t lines, double height) {
  const bool has_keys = !state.keys.empty();
  const size_t rows = has_keys ? state.keys.size() : legendRows(snapshot).size();
  PanelLayout layout{};
  for (PanelLayout tried : {PanelLayout{kTextSize, 21, 1, 20}, PanelLayout{kTextSize, 21, 2, 20},
                            PanelLayout{kTickSize, 17, 2, 17}}) {
    if (has_keys) tried.legend_columns = 1;
    const double room = height - statusHeight(tried, lines) - legendHeight(tried, rows) - kHelpHeight;
    const double around_chart = kHeadingHeight + kAxisHeight + kGap, around_zone = kHeadingHeight + kGap;
    const bool has_zone = snapshot.obstacles.has_value();
    layout = tried;
    layout.chart_height = kChartHeight;
    layout.zone_height = has_zone ? kZoneHeight : 0;
    const double wanted = around_chart + kChartHeight + (has_zone ? around_zone + kZoneHeight : 0);
    if (wanted <= room) return layout;
    // Both shrink by the same share; what would be too small to be read is left out, the obstacles first.
    const double share = std::max(0.0, room - around_chart - (has_zone ? around_zone : 0)) /
                         (kChartHeight + (has_zone ? kZoneHeight : 0));
    layout.chart_height = share * kChartHeight;
    layout.zone_height = has_zone ? share * kZoneHeight : 0;
    if (layout.chart_height >= kLeastChartHeight && (!has_zone || layout.zone_height >= kLeastZoneHeight))
      continue;
    layout.zone_height = 0;
    layout.chart_height = std::min(kChartHeight, room - around_chart);
    if (layout.chart_height < kLeastChartHeight) layout.chart_height = 0;
  }
  return layout;
}

void drawLegend(Canvas& canvas, double top, const PanelLayout& layout, const Snapshot& snapshot,
                const std::string& hidden) {
  const double first = heading(canvas, top, "Colours; a digit switches its layer") + 12;
  const auto rows = legendRows(snapshot);
  const size_t per_column = (rows.size() + layout.legend_columns - 1) / layout.legend_columns;
  const double width = kInner / static_cast<double>(layout.legend_columns);
  for (size_t i = 0; i < rows.size(); ++i) {
    const auto& row = rows[i];
    const size_t column = i / per_column;
    const double left = kMargin + width * static_cast<double>(column);
    const double y = first + layout.row_pitch * static_cast<double>(i % per_column);
    const bool is_off = row.key != 0 && hidden.find(row.key) != std::string::npos;
    if (row.key != 0) canvas.text({left, y}, std::string(1, row.key), kTickSize, kInk, Align::kLeft, true);
    canvas.box({left + 14, y - 11, 12, 12}, is_off ? kWhite : row.colour);
    canvas.frame({left + 14, y - 11, 12, 12}, draw::kFrame, 1);
    const auto text = Canvas::fitText(row.text + std::string(is_off ? " (off)" : ""), kTickSize, width - 36);
    canvas.text({left + 33, y}, text, kTickSize, is_off ? kGrey : kInk);
  }
}

void drawKeys(Canvas& canvas, double top, double bottom, const PanelLayout& layout,
              const std::vector<KeyHelp>& keys) {
  double y = heading(canvas, top, "Keys and mouse") + 12;
  const double pitch = std::min(layout.row_pitch, 19.0);
  for (const auto& key : keys) {
    if (y + 4 > bottom) return;
    canvas.text({kMargin, y}, key.key, kTickSize + 1, kInk, Align::kLeft, true);
    canvas.text({kMargin + 92, y}, Canvas::fitText(key.meaning, kTickSize + 1, kInner - 92), kTickSize + 1,
                kInk);
    y += pitch;
  }
}

}  // namespace

std::string scaleBar(double length_m, double pixels) {
  constexpr double kPad = 10, kHeight = 34;
  const double width = std::ceil(std::max(pixels, 40.0) + 2 * kPad);
  Canvas canvas(static_cast<int>(width), static_cast<int>(kHeight));
  canvas.box({0, 0, width, kHeight}, {247, 247, 247});
  const double left = (width - pixels) / 2, right = left + pixels, y = kHeight - 8;
  canvas.line({left, y}, {right, y}, kInk, 2);
  for (const double x : {left, right}) canvas.line({x, y - 5}, {x, y + 5}, kInk, 2);
  canvas.text({width / 2, y - 9}, draw::stepLabel(length_m) + " m", kTickSize, kInk, Align::kCentre);
  canvas.frame({0, 0, width, kHeight}, draw::kFrame, 1);
  return canvas.toPng();
}

std::vector<std::string> statusLines(const Snapshot& snapshot, const PanelState& state) {
  std::vector<std::string> lines = {snapshot.title};
  if (!snapshot.method.empty()) lines.push_back(snapshot.method);
  lines.push_back(format("%.1f s, scan %zu", snapshot.time_s, snapshot.scans));
  lines.push_back(poseText("pose", snapshot.T_map_robot));
  if (snapshot.T_scene_truth) {
    const core::Pose2 estimate = snapshot.T_scene_map * snapshot.T_map_robot;
    lines.push_back(
        format("error %.3f m, %.1f deg", core::distance(*snapshot.T_scene_truth, estimate),
               std::abs(core::radToDeg(core::angleDifference(estimate.phi, snapshot.T_scene_truth->phi)))));
  }
  if (snapshot.collisions > 0) lines.push_back(format("%zu collisions", snapshot.collisions));
  if (!state.playback.empty()) lines.push_back(state.playback);
  if (!snapshot.note.empty()) lines.push_back(snapshot.note);
  return lines;
}

std::string sidePanel(const Snapshot& snapshot, const PanelState& state, int height) {
  Canvas canvas(kPanelWidth, height);
  canvas.box({0, 0, static_cast<double>(kPanelWidth), static_cast<double>(height)}, {247, 247, 247});
  std::vector<std::string> lines;
  size_t title_lines = 0;
  for (const auto& line : statusLines(snapshot, state)) {
    const bool is_title = lines.empty();
    for (auto& piece : wrapped(line, is_title ? kTitleSize : kTextSize, is_title)) lines.push_back(piece);
    if (is_title) title_lines = lines.size();
  }
  const auto layout = layOut(snapshot, state, lines.size(), height);
  for (size_t i = 0; i < lines.size(); ++i) {
    const bool is_title = i < title_lines;
    canvas.text({kMargin, kMargin + kTitleSize + layout.line_pitch * static_cast<double>(i)}, lines[i],
                is_title ? kTitleSize : layout.text_size, kInk, Align::kLeft, is_title);
  }
  double y = statusHeight(layout, lines.size());
  if (layout.chart_height > 0) y = drawChart(canvas, y, layout.chart_height, snapshot.scan);
  if (layout.zone_height > 0 && snapshot.obstacles)
    y = drawZone(canvas, y, layout.zone_height, *snapshot.obstacles, state.robot_side_m);
  const double bottom = height - 8;
  if (state.keys.empty())
    drawLegend(canvas, y, layout, snapshot, state.hidden);
  else
    drawKeys(canvas, y, bottom - kHelpHeight, layout, state.keys);
  const bool is_help = !state.keys.empty();
  canvas.text({kMargin, bottom}, is_help ? "h: back to the colours" : "h: help", kTextSize, kInk,
              Align::kLeft, true);
  canvas.line({0.5, 0}, {0.5, static_cast<double>(height)}, draw::kFrame, 1);
  return canvas.toPng();
}

}  // namespace slam::viewer

#include "libslam/viewer/side_panel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "libslam/report/canvas.h"
#include "libslam/report/map_view.h"

namespace slam::viewer {
namespace {

using report::Align;
using report::Canvas;
using report::Colour;
using report::Pixel;
using report::PixelBox;

constexpr double kMargin = 14, kInner = kPanelWidth - 2 * kMargin;
constexpr double kTitleSize = 18, kTextSize = 15, kTickSize = 13;
constexpr double kLinePitch = 21, kGap = 13;
constexpr size_t kMostLines = 2;  // of a line of the status
constexpr double kChartHeight = 108, kZoneHeight = 152;
constexpr Colour kInk = report::kInk, kGrey = report::kGrey, kRule{226, 226, 226}, kZone{214, 214, 214},
                 kWhite{255, 255, 255}, kSeen = report::kVermillion, kRemembered = report::kBlue;

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

/// Range over angle: the founding chart. Returns where it ends.
double drawChart(Canvas& canvas, double top, const robot::Scan& scan) {
  top = heading(canvas, top, "Scan: range (m), angle (deg)");
  const PixelBox box{kMargin + 26, top, kInner - 30, kChartHeight};
  double farthest_m = 1;
  for (const float range_m : scan.ranges_m)
    if (robot::isReturn(range_m)) farthest_m = std::max(farthest_m, static_cast<double>(range_m));
  const double step_m = report::niceStep(farthest_m / 2);
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
    canvas.text({box.left - 5, y + 5}, report::stepLabel(i * step_m), kTickSize, kGrey, Align::kRight);
  }
  for (int degrees = -270; degrees <= 270; degrees += 90) {
    const double angle_rad = core::degToRad(degrees);
    if (angle_rad < first_rad - 1e-6 || angle_rad > last_rad + 1e-6) continue;
    const double x = at(angle_rad, 0).x;
    canvas.line({x, box.top}, {x, box.top + box.height}, kRule, 1);
    canvas.text({x, box.top + box.height + 15}, std::to_string(degrees), kTickSize, kGrey, Align::kCentre);
  }
  canvas.frame(box, report::kFrame, 1);
  std::vector<Pixel> line;
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const bool is_return = robot::isReturn(scan.ranges_m[i]);
    line.push_back(is_return ? at(scan.angle(i), static_cast<double>(scan.ranges_m[i]))
                             : Pixel{std::nan(""), std::nan("")});
  }
  canvas.clipTo(box);
  canvas.polyline(line, kSeen, 1.2);
  for (const auto& place : line) canvas.disc(place, 1, kSeen);
  canvas.liftClip();
  return box.top + box.height + 20 + kGap;
}

/// The founding picture of the local obstacle map: ahead is up. Returns where it ends.
double drawZone(Canvas& canvas, double top, const LocalObstacles& obstacles, double robot_side_m) {
  top = heading(canvas, top, "Obstacles around the robot");
  const double depth_m = obstacles.front_m + obstacles.rear_m;
  const double scale = std::min(kInner * 0.62 / obstacles.width_m, kZoneHeight / depth_m);
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
  canvas.frame(box, report::kFrame, 1);
  const double left = box.left + box.width + 12;
  double y = box.top + 16;
  const auto row = [&](Colour colour, bool is_dot, const char* text) {
    if (is_dot) {
      canvas.disc({left + 6, y - 5}, 3.5, colour);
    } else {
      canvas.box({left, y - 11, 12, 12}, colour);
      canvas.frame({left, y - 11, 12, 12}, report::kFrame, 1);
    }
    canvas.text({left + 19, y}, text, kTickSize, kInk);
    y += 21;
  };
  row(kWhite, false, "in view");
  row(kZone, false, "out of view");
  row(kSeen, true, "seen now");
  row(kRemembered, true, "remembered");
  return box.top + box.height + kGap;
}

struct LegendRow {
  Colour colour;
  const char* text;
};

std::vector<LegendRow> legendRows(const Snapshot& snapshot) {
  std::vector<LegendRow> rows = {{report::kVermillion, "robot with its circle; scan"}};
  if (!snapshot.path.empty()) rows.push_back({report::kBlue, "estimated path"});
  if (!snapshot.truth.empty()) rows.push_back({{170, 170, 170}, "true path"});
  if (snapshot.map) rows.push_back({kInk, "walls of the estimated map"});
  if (snapshot.T_scene_truth) rows.push_back({{150, 150, 155}, "true walls"});
  if (!snapshot.particles.empty()) rows.push_back({report::kPurple, "particles"});
  if (!snapshot.nodes.empty()) rows.push_back({report::kGreen, "graph"});
  if (!snapshot.nodes.empty() || !snapshot.loops.empty()) rows.push_back({report::kOrange, "loops closed"});
  if (snapshot.candidates) {
    rows.push_back({report::kYellow, "goal, way to it, candidates"});
  }
  if (snapshot.strategic) rows.push_back({report::kGreen, "strategic directions, stop radius"});
  if (!snapshot.people.empty()) rows.push_back({kInk, "people"});
  return rows;
}

void drawLegend(Canvas& canvas, double top, double bottom, const Snapshot& snapshot) {
  double y = heading(canvas, top, "Colours") + 12;
  for (const auto& row : legendRows(snapshot)) {
    if (y + 4 > bottom) return;
    canvas.box({kMargin, y - 11, 12, 12}, row.colour);
    canvas.frame({kMargin, y - 11, 12, 12}, report::kFrame, 1);
    canvas.text({kMargin + 22, y}, row.text, kTickSize + 1, kInk);
    y += 20;
  }
}

void drawKeys(Canvas& canvas, double top, double bottom, const std::vector<KeyHelp>& keys) {
  double y = heading(canvas, top, "Keys and mouse") + 12;
  for (const auto& key : keys) {
    if (y + 4 > bottom) return;
    canvas.text({kMargin, y}, key.key, kTickSize + 1, kInk, Align::kLeft, true);
    canvas.text({kMargin + 92, y}, Canvas::fitText(key.meaning, kTickSize + 1, kInner - 92), kTickSize + 1,
                kInk);
    y += 19;
  }
}

}  // namespace

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
  double y = kMargin + kTitleSize;
  bool is_title = true;
  for (const auto& line : statusLines(snapshot, state)) {
    const double size = is_title ? kTitleSize : kTextSize;
    for (const auto& piece : wrapped(line, size, is_title)) {
      canvas.text({kMargin, y}, piece, size, kInk, Align::kLeft, is_title);
      y += kLinePitch;
    }
    is_title = false;
  }
  // Room for the longest status, so that what stands below does not jump.
  y = std::max(y, kMargin + kTitleSize + 8 * kLinePitch) - kLinePitch + kGap;
  const double bottom = height - 6;
  if (y + kChartHeight + 60 < bottom) y = drawChart(canvas, y, snapshot.scan);
  if (snapshot.obstacles && y + kZoneHeight + 40 < bottom)
    y = drawZone(canvas, y, *snapshot.obstacles, state.robot_side_m);
  if (y + 40 < bottom) {
    if (state.keys.empty())
      drawLegend(canvas, y, bottom, snapshot);
    else
      drawKeys(canvas, y, bottom, state.keys);
  }
  canvas.line({0.5, 0}, {0.5, static_cast<double>(height)}, report::kFrame, 1);
  return canvas.toPng();
}

}  // namespace slam::viewer

#include "libslam/pictures/obstacle_picture.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/draw/map_view.h"

namespace slam::pictures {
namespace {

constexpr double kMargin = 20;
constexpr double kPanelTitleSize = 20, kSubtitleSize = 17, kHeadHeight = 54;
constexpr draw::Colour kSeen = draw::kVermillion, kRemembered = draw::kBlue, kVisible{255, 255, 255},
                       kBody{205, 205, 205};

/// Ahead up the page: the picture's axes are the original document's, x to the right and y ahead.
core::Point2 onPage(const core::Point2& p_robot) {
  return {-p_robot.y, p_robot.x};
}

/// How the panels stand: the number of columns that shows them largest, the fewest of equals.
struct Grid {
  int columns = 1, rows = 1;
  double panel_width = 0, map_height = 0;
};
Grid arrange(size_t panels, const ObstacleZone& zone) {
  constexpr double kSheetWidth = 1400, kSheetHeight = 1300;
  const auto count = static_cast<int>(panels);
  const double depth_m = zone.front_m + zone.rear_m;
  Grid best;
  double best_scale = 0;
  for (int columns = 1; columns <= count; ++columns) {
    const int rows = (count + columns - 1) / columns;
    const double width = (kSheetWidth - (columns - 1) * kMargin) / columns;
    const double height = (kSheetHeight - (rows - 1) * kMargin) / rows - kHeadHeight;
    // The cap keeps a single panel from filling the sheet.
    const double scale =
        std::min({width / zone.width_m, height / depth_m, 640 / depth_m, 640 / zone.width_m});
    if (scale <= best_scale * 1.0001) continue;
    best_scale = scale;
    best = {columns, rows, std::round(zone.width_m * scale), std::round(depth_m * scale)};
  }
  return best;
}

void drawRobot(draw::Canvas& canvas, const draw::MapView& view, double side_m) {
  const double half = side_m / 2;
  const auto at = [&](double x, double y) { return view.toPixel(onPage({x, y})); };
  canvas.fillPolygon({at(half, half), at(half, -half), at(-half, -half), at(-half, half)}, kBody);
  canvas.polyline({at(half, half), at(half, -half), at(-half, -half), at(-half, half), at(half, half)},
                  draw::kInk, 1.5);
  canvas.fillPolygon({at(0.8 * half, 0), at(-0.5 * half, 0.6 * half), at(-0.5 * half, -0.6 * half)},
                     draw::kInk);
}

void drawPanel(draw::Canvas& canvas, const ObstaclePanel& panel, const ObstacleZone& zone,
               const draw::MapView& view, const draw::Pixel& head) {
  canvas.text({head.x, head.y + 20},
              draw::Canvas::fitText(panel.title, kPanelTitleSize, view.box.width, true), kPanelTitleSize,
              draw::kInk, draw::Align::kLeft, true);
  canvas.text({head.x, head.y + 43}, draw::Canvas::fitText(panel.subtitle, kSubtitleSize, view.box.width),
              kSubtitleSize, draw::kGrey);
  canvas.clipTo(view.box);
  canvas.box(view.box, draw::kUnknown);
  std::vector<draw::Pixel> outline;
  for (const auto& corner : panel.visible) outline.push_back(view.toPixel(onPage(corner)));
  canvas.fillPolygon(outline, kVisible);
  if (!outline.empty()) outline.push_back(outline.front());
  canvas.polyline(outline, draw::kFrame, 1);
  drawRobot(canvas, view, zone.robot_side_m);
  const double ring = std::max(7.0, zone.obstacle_radius_m * view.pixelsPerMetre());
  for (const auto& p : panel.true_places) canvas.circle(view.toPixel(onPage(p)), ring, draw::kGrey, 1);
  for (const auto& p : panel.remembered) canvas.disc(view.toPixel(onPage(p)), 4, kRemembered);
  for (const auto& p : panel.seen) canvas.disc(view.toPixel(onPage(p)), 4, kSeen);
  canvas.liftClip();
  canvas.frame(view.box, draw::kFrame, 1);
}

}  // namespace

void drawObstacles(const std::vector<ObstaclePanel>& panels, const ObstacleZone& zone,
                   const std::string& title, const std::string& file, const draw::Paper& paper) {
  if (panels.empty() || panels.size() > 12) throw core::ContractError("drawObstacles: needs 1 to 12 panels");
  if (!(zone.width_m > 0) || !(zone.front_m + zone.rear_m > 0))
    throw core::ContractError("drawObstacles: needs a zone with an area");
  const auto grid = arrange(panels.size(), zone);
  const draw::Window window{-zone.width_m / 2, -zone.rear_m, zone.width_m / 2, zone.front_m};
  const double scale = grid.panel_width / window.width();
  const double inner_width = std::max(600.0, grid.columns * (grid.panel_width + kMargin) - kMargin);
  using Kind = draw::LegendEntry::Kind;
  const draw::LegendStrip strip({{Kind::kBox, kVisible, "in view"},
                                 {Kind::kBox, draw::kUnknown, "out of view"},
                                 {Kind::kDot, kSeen, "obstacle seen now"},
                                 {Kind::kDot, kRemembered, "obstacle remembered"},
                                 {Kind::kRing, draw::kGrey, "its true place"}},
                                inner_width, scale);
  const double title_height = draw::titleHeight(title);
  const double row_height = kHeadHeight + grid.map_height + kMargin;
  const double legend_top = kMargin + title_height + grid.rows * row_height - 0.4 * kMargin;
  draw::Canvas canvas(static_cast<int>(std::lround(inner_width + 2 * kMargin)),
                      static_cast<int>(std::lround(legend_top + strip.height() + kMargin)), paper);
  draw::drawTitle(canvas, {kMargin, kMargin}, title, inner_width);
  for (size_t i = 0; i < panels.size(); ++i) {
    const auto column = static_cast<int>(i) % grid.columns, row = static_cast<int>(i) / grid.columns;
    const draw::Pixel head{kMargin + column * (grid.panel_width + kMargin),
                           kMargin + title_height + row * row_height};
    drawPanel(canvas, panels[i], zone,
              {window, {head.x, head.y + kHeadHeight, grid.panel_width, grid.map_height}}, head);
  }
  strip.draw(canvas, {kMargin, legend_top});
  canvas.save(file);
}

}  // namespace slam::pictures

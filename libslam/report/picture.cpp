#include "libslam/report/picture.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "libslam/core/error.h"
#include "libslam/report/map_difference.h"
#include "libslam/report/map_view.h"

namespace slam::report {
namespace {

constexpr double kMargin = 20;  // pixels, round the sheet and between its parts
constexpr double kTitleSize = 25, kTitleHeight = 44;
constexpr double kPanelTitleSize = 23, kSubtitleSize = 18, kPanelHeadHeight = 58;
struct LineWidths {
  double truth, estimate;
};
constexpr LineWidths kPlanLines{7, 2.5}, kPanelLines{5, 2};
constexpr double kLeastWidth = 600, kMostWidth = 1960;  // of what lies within the margins

/// The scale at which a window fills as much of a box as its shape allows.
double fittingScale(const Window& window, double width, double height) {
  return std::min(width / window.width(), height / window.height());
}

std::vector<DrawnPath> truthFirst(std::vector<DrawnPath> paths) {
  std::stable_partition(paths.begin(), paths.end(), [](const DrawnPath& p) { return p.is_truth; });
  return paths;
}

/// Colours by label, in the order of first use, so that a method looks the same in every panel.
class PathColours {
 public:
  Colour of(const DrawnPath& path) {
    if (path.is_truth) return kTruthPath;
    const auto index = indices_.emplace(path.label, indices_.size()).first->second;
    return lineColours()[index % lineColours().size()];
  }

 private:
  std::map<std::string, size_t> indices_;
};

void drawPaths(Canvas& canvas, const MapView& view, const std::vector<DrawnPath>& paths, PathColours& colours,
               const LineWidths& widths) {
  const auto ordered = truthFirst(paths);
  for (const auto& path : ordered)
    drawPath(canvas, view, path.path, colours.of(path), path.is_truth ? widths.truth : widths.estimate);
  for (const auto& path : ordered) {
    if (path.path.empty()) continue;
    drawStart(canvas, view.toPixel(core::position(path.path.front().pose)));
    break;
  }
}

std::vector<LegendEntry> legendOf(const std::vector<DrawnPath>& paths, PathColours& colours) {
  std::vector<LegendEntry> entries;
  for (const auto& path : truthFirst(paths)) {
    const auto kind = path.is_truth ? LegendEntry::Kind::kBroadLine : LegendEntry::Kind::kLine;
    const bool known = std::any_of(entries.begin(), entries.end(), [&](const LegendEntry& e) {
      return e.kind == kind && e.label == path.label;
    });
    if (!known) entries.push_back({kind, colours.of(path), path.label});
  }
  if (!entries.empty()) entries.push_back({LegendEntry::Kind::kStart, kInk, "start"});
  return entries;
}

/// One map under a title, over a legend: the sheet of drawPlan() and drawDifference().
class MapSheet {
 public:
  MapSheet(const Window& window, const std::string& title, const std::vector<LegendEntry>& legend)
      : scale_(fittingScale(window, 1200, 1000)),
        width_(std::max(kLeastWidth, window.width() * scale_)),
        strip_(legend, width_, scale_),
        title_height_(title.empty() ? 0 : kTitleHeight),
        canvas_(static_cast<int>(std::lround(width_ + 2 * kMargin)),
                static_cast<int>(std::lround(title_height_ + window.height() * scale_ + 0.6 * kMargin +
                                             strip_.height() + 2 * kMargin))) {
    const double map_width = std::round(window.width() * scale_), map_height = window.height() * scale_;
    view_ = {
        window,
        {std::round(kMargin + (width_ - map_width) / 2), kMargin + title_height_, map_width, map_height}};
    if (!title.empty())
      canvas_.text({kMargin, kMargin + kTitleSize}, Canvas::fitText(title, kTitleSize, width_, true),
                   kTitleSize, kInk, Align::kLeft, true);
    strip_.draw(canvas_, {kMargin, view_.box.top + view_.box.height + 0.6 * kMargin});
  }

  Canvas& canvas() { return canvas_; }
  const MapView& view() const { return view_; }

 private:
  double scale_, width_;
  LegendStrip strip_;
  double title_height_;
  Canvas canvas_;
  MapView view_;
};

/// One window for all panels: commonWindow() of their maps.
Window commonWindow(const std::vector<Panel>& panels) {
  std::vector<Window> maps;
  Window truth, estimates;
  for (const auto& panel : panels) {
    maps.push_back(windowOf(panel.map, panel.T_world_map * panel.map.T_world_plan));
    if (panel.is_true) truth.include(maps.back());
    for (const auto& path : panel.paths) (path.is_truth ? truth : estimates).include(windowOf(path.path));
  }
  return commonWindow(maps, truth, estimates);
}

/// How n panels stand: the number of columns that shows them largest on a sheet of the usual shape, where an
/// empty place counts against it.
struct Grid {
  int columns = 1, rows = 1;
  double panel_width = 0, map_height = 0;
};
Grid arrange(const std::vector<Panel>& panels, const Window& window) {
  constexpr double kSheetWidth = 1500, kSheetHeight = 1050, kLargestMap = 900;
  double least_width = 120;  // of a panel: a narrow map is no wider than its title, up to a point
  for (const auto& panel : panels) {
    least_width = std::max(least_width, Canvas::textWidth(panel.title, kPanelTitleSize, true) + 4);
    least_width = std::max(least_width, Canvas::textWidth(panel.subtitle, kSubtitleSize) + 4);
  }
  least_width = std::min(least_width, 280.0);

  const auto count = static_cast<int>(panels.size());
  Grid best;
  double best_score = 0;
  for (int columns = 1; columns <= count; ++columns) {
    if (columns > 1 && columns * (least_width + kMargin) > kMostWidth) break;
    const int rows = (count + columns - 1) / columns;
    const double width = std::min(kLargestMap, (kSheetWidth - (columns - 1) * kMargin) / columns);
    const double height =
        std::min(kLargestMap, (kSheetHeight - (rows - 1) * kMargin) / rows - kPanelHeadHeight);
    const double scale = fittingScale(window, width, std::max(height, 60.0));
    const double score = scale * count / (columns * rows);
    if (score <= best_score * 1.0001) continue;
    best_score = score;
    best = {columns, rows, std::max(std::ceil(least_width), std::round(window.width() * scale)),
            std::round(window.height() * scale)};
  }
  return best;
}

void drawPanel(Canvas& canvas, const Panel& panel, const MapView& view, const PixelBox& whole,
               PathColours& colours) {
  canvas.text({whole.left, whole.top + 22}, Canvas::fitText(panel.title, kPanelTitleSize, whole.width, true),
              kPanelTitleSize, kInk, Align::kLeft, true);
  canvas.text({whole.left, whole.top + 46}, Canvas::fitText(panel.subtitle, kSubtitleSize, whole.width),
              kSubtitleSize, kGrey);
  canvas.clipTo(view.box);
  if (core::isFinite(panel.T_world_map))
    drawRaster(canvas, view, panel.map, panel.T_world_map * panel.map.T_world_plan);
  else
    canvas.box(view.box, kUnknown);
  drawPaths(canvas, view, panel.paths, colours, kPanelLines);
  canvas.liftClip();
  canvas.frame(view.box, kFrame, 1);
}

}  // namespace

void drawPlan(const world::Plan& plan, const std::vector<DrawnPath>& paths, const std::string& title,
              const std::string& png_path, const DrawnMarks& marks) {
  Window truth = windowOf(plan, plan.T_world_plan), estimates;
  for (const auto& path : paths) (path.is_truth ? truth : estimates).include(windowOf(path.path));
  PathColours colours;
  auto legend = legendOf(paths, colours);
  if (!marks.places.empty()) legend.push_back({LegendEntry::Kind::kDot, kOrange, marks.label});
  MapSheet sheet(usable(withEstimates(truth, estimates)), title, legend);
  auto& canvas = sheet.canvas();
  canvas.clipTo(sheet.view().box);
  drawRaster(canvas, sheet.view(), plan, plan.T_world_plan);
  drawPaths(canvas, sheet.view(), paths, colours, kPlanLines);
  for (const auto& place : marks.places) canvas.disc(sheet.view().toPixel(place), 5, kOrange);
  canvas.liftClip();
  canvas.frame(sheet.view().box, kFrame, 1);
  canvas.savePng(png_path);
}

void drawDifference(const world::Plan& plan, const world::Plan& map, const core::Pose2& T_world_map,
                    const std::string& title, const std::string& png_path, const metrics::SeenMask* seen) {
  const MapDifference difference(plan, map, T_world_map, seen);
  const auto T_world_raster = T_world_map * map.T_world_plan;
  const auto window =
      usable(withEstimates(windowOf(plan, plan.T_world_plan),
                           core::isFinite(T_world_raster) ? windowOf(map, T_world_raster) : Window{}));
  MapSheet sheet(window, title, difference.legend());
  const auto& view = sheet.view();
  const double side_m = 1 / (view.pixelsPerMetre() * Canvas::kSubpixels);
  sheet.canvas().paint(view.box,
                       [&](Pixel pixel) { return difference.colourAt(view.toWorld(pixel), side_m); });
  sheet.canvas().frame(view.box, kFrame, 1);
  sheet.canvas().savePng(png_path);
}

void drawPanels(const std::vector<Panel>& panels, const std::string& png_path) {
  if (panels.empty() || panels.size() > 8) throw core::ContractError("drawPanels: needs 1 to 8 panels");
  const auto window = commonWindow(panels);
  const auto grid = arrange(panels, window);
  const double scale = grid.map_height / window.height();

  PathColours colours;
  std::vector<DrawnPath> all_paths;
  for (const auto& panel : panels)
    for (const auto& path : panel.paths)
      all_paths.push_back({{}, path.label, path.is_truth}), colours.of(path);
  const double inner_width = std::max(kLeastWidth, grid.columns * (grid.panel_width + kMargin) - kMargin);
  const LegendStrip strip(legendOf(all_paths, colours), inner_width, scale);

  const double row_height = kPanelHeadHeight + grid.map_height + kMargin;
  const double legend_top = kMargin + grid.rows * row_height - 0.4 * kMargin;
  Canvas canvas(static_cast<int>(std::lround(inner_width + 2 * kMargin)),
                static_cast<int>(std::lround(legend_top + strip.height() + kMargin)));
  for (size_t i = 0; i < panels.size(); ++i) {
    const auto column = static_cast<int>(i) % grid.columns, row = static_cast<int>(i) / grid.columns;
    const PixelBox whole{kMargin + column * (grid.panel_width + kMargin), kMargin + row * row_height,
                         grid.panel_width, row_height};
    const MapView view{
        window,
        {whole.left, whole.top + kPanelHeadHeight, std::round(window.width() * scale), grid.map_height}};
    drawPanel(canvas, panels[i], view, whole, colours);
  }
  strip.draw(canvas, {kMargin, legend_top});
  canvas.savePng(png_path);
}

}  // namespace slam::report

#include "libslam/pictures/picture.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/draw/chart_axes.h"
#include "libslam/draw/map_view.h"
#include "libslam/pictures/map_difference.h"

namespace slam::pictures {
namespace {

constexpr double kGap = 20;  // units, between the parts of a sheet
constexpr double kPanelTitleSize = 23, kSubtitleSize = 18, kPanelHeadHeight = 58;
struct LineWidths {
  double truth, estimate, dashes;
};
constexpr LineWidths kMapLines{7, 3, 1.2}, kPanelLines{5, 2.6, 1.1};
constexpr draw::Colour kOverWalls{130, 130,
                                  130};  // a path of the palette's black is no black line on black walls
constexpr draw::Colour kAroundDashes{255, 255, 255};
constexpr double kLeastWidth = 600, kMostWidth = 1960;  // on the screen, of what lies within the margins
constexpr double kTallest = 1.15;                       // on paper, of a map's height in widths

/// The scale at which a window fills as much of a box as its shape allows.
double fittingScale(const draw::Window& window, double width, double height) {
  return std::min(width / window.width(), height / window.height());
}

std::vector<DrawnPath> truthFirst(std::vector<DrawnPath> paths) {
  std::stable_partition(paths.begin(), paths.end(), [](const DrawnPath& p) { return p.is_truth; });
  return paths;
}

/// Whether the truth lies over estimates, as dashes that let them be seen.
bool isDashed(const std::vector<DrawnPath>& paths) {
  return std::any_of(paths.begin(), paths.end(), [](const DrawnPath& p) { return !p.is_truth; });
}

/// Colours by label, so that a method looks the same in every panel.
class PathColours {
 public:
  explicit PathColours(const std::vector<DrawnPath>& paths) {
    for (const auto& path : paths)
      if (!path.is_truth && std::find(labels_.begin(), labels_.end(), path.label) == labels_.end())
        labels_.push_back(path.label);
    colours_ = draw::labelColours(labels_);
  }
  draw::Colour of(const DrawnPath& path) const {
    if (path.is_truth) return labels_.empty() ? draw::kTruthPath : draw::kInk;
    const auto label = std::find(labels_.begin(), labels_.end(), path.label) - labels_.begin();
    const draw::Colour colour = colours_[static_cast<size_t>(label)];
    return colour.red + colour.green + colour.blue == 0 ? kOverWalls : colour;
  }

 private:
  std::vector<std::string> labels_;
  std::vector<draw::Colour> colours_;
};

void drawPaths(draw::Canvas& canvas, const draw::MapView& view, const std::vector<DrawnPath>& paths,
               const PathColours& colours, const LineWidths& widths) {
  const auto ordered = truthFirst(paths);
  const bool is_dashed = isDashed(paths);
  for (const auto& path : ordered)
    if (path.is_truth && !is_dashed) draw::drawPath(canvas, view, path.path, colours.of(path), widths.truth);
  for (auto path = ordered.rbegin(); path != ordered.rend(); ++path)
    if (!path->is_truth) draw::drawPath(canvas, view, path->path, colours.of(*path), widths.estimate);
  for (const auto& path : ordered)
    if (path.is_truth && is_dashed) {
      // Upon a dark line dark dashes would not be seen.
      draw::drawDashedPath(canvas, view, path.path, kAroundDashes, widths.estimate + 0.4);
      draw::drawDashedPath(canvas, view, path.path, colours.of(path), widths.dashes);
    }
  // Several robots start in several places; several estimates of one path do not.
  constexpr double kApart_m = 0.5;
  std::vector<core::Point2> starts;
  for (const auto& path : ordered) {
    if (path.path.empty()) continue;
    const core::Point2 start = core::position(path.path.front().pose);
    const bool is_marked = std::any_of(starts.begin(), starts.end(), [&](const core::Point2& other) {
      return core::distance(start, other) < kApart_m;
    });
    if (is_marked) continue;
    starts.push_back(start);
    draw::drawStart(canvas, view.toPixel(start));
  }
}

std::vector<draw::LegendEntry> legendOf(const std::vector<DrawnPath>& paths, const PathColours& colours) {
  std::vector<draw::LegendEntry> entries;
  for (const auto& path : truthFirst(paths)) {
    const auto truth =
        isDashed(paths) ? draw::LegendEntry::Kind::kDashes : draw::LegendEntry::Kind::kBroadLine;
    const auto kind = path.is_truth ? truth : draw::LegendEntry::Kind::kLine;
    const bool known = std::any_of(entries.begin(), entries.end(), [&](const draw::LegendEntry& e) {
      return e.kind == kind && e.label == path.label;
    });
    if (!known) entries.push_back({kind, colours.of(path), path.label});
  }
  if (!entries.empty()) entries.push_back({draw::LegendEntry::Kind::kStart, draw::kInk, "start"});
  return entries;
}

/// Within the margins.
double paperWidth(const draw::Paper& paper) {
  return paper.unitsWide() - 2 * draw::sheetMargin(paper);
}

/// One map under a title, over a legend: the sheet of drawMap() and drawDifference().
class MapSheet {
 public:
  MapSheet(const draw::Window& window, const std::string& title, const std::vector<draw::LegendEntry>& legend,
           const draw::Paper& paper)
      : margin_(draw::sheetMargin(paper)),
        scale_(paper.isScreen() ? fittingScale(window, 1200, 1000)
                                : fittingScale(window, paperWidth(paper), kTallest * paperWidth(paper))),
        width_(paper.isScreen() ? std::max(kLeastWidth, window.width() * scale_) : paperWidth(paper)),
        strip_(legend, width_, scale_),
        title_height_(draw::titleHeight(title)),
        canvas_(
            paper.isScreen() ? std::round(width_ + 2 * margin_) : paper.unitsWide(),
            std::round(title_height_ + window.height() * scale_ + 0.6 * kGap + strip_.height() + 2 * margin_),
            paper) {
    const double map_width = std::round(window.width() * scale_), map_height = window.height() * scale_;
    view_ = {
        window,
        {std::round(margin_ + (width_ - map_width) / 2), margin_ + title_height_, map_width, map_height}};
    draw::drawTitle(canvas_, {margin_, margin_}, title, width_);
    strip_.draw(canvas_, {margin_, view_.box.top + view_.box.height + 0.6 * kGap});
  }

  draw::Canvas& canvas() { return canvas_; }
  const draw::MapView& view() const { return view_; }

 private:
  double margin_, scale_, width_;
  draw::LegendStrip strip_;
  double title_height_;
  draw::Canvas canvas_;
  draw::MapView view_;
};

/// One window for all panels: commonWindow() of their maps.
draw::Window commonWindow(const std::vector<Panel>& panels) {
  std::vector<draw::Window> maps;
  draw::Window truth, estimates;
  for (const auto& panel : panels) {
    maps.push_back(draw::windowOf(panel.map, panel.T_world_map * panel.map.T_frame_raster));
    if (panel.is_true) truth.include(maps.back());
    for (const auto& path : panel.paths)
      (path.is_truth ? truth : estimates).include(draw::windowOf(path.path));
  }
  return draw::commonWindow(maps, truth, estimates);
}

/// How n panels stand: the number of columns that shows them largest on a sheet of the usual shape, where an
/// empty place counts against it.
struct Grid {
  int columns = 1, rows = 1;
  double panel_width = 0, map_height = 0;
};
Grid arrange(const std::vector<Panel>& panels, const draw::Window& window, const draw::Paper& paper) {
  const double sheet_width = paper.isScreen() ? 1500 : paperWidth(paper);
  const double sheet_height = paper.isScreen() ? 1050 : kTallest * sheet_width;
  const double most_width = paper.isScreen() ? kMostWidth : sheet_width + kGap;
  constexpr double kLargestMap = 900;
  double least_width = 120;  // of a panel: a narrow map is no wider than its title, up to a point
  for (const auto& panel : panels) {
    least_width = std::max(least_width, draw::Canvas::textWidth(panel.title, kPanelTitleSize, true) + 4);
    least_width = std::max(least_width, draw::Canvas::textWidth(panel.subtitle, kSubtitleSize) + 4);
  }
  least_width = std::min(least_width, 280.0);

  const auto count = static_cast<int>(panels.size());
  Grid best;
  double best_score = 0;
  for (int columns = 1; columns <= count; ++columns) {
    if (columns > 1 && columns * (least_width + kGap) > most_width) break;
    const int rows = (count + columns - 1) / columns;
    const double width = std::min(kLargestMap, (sheet_width - (columns - 1) * kGap) / columns);
    const double height = std::min(kLargestMap, (sheet_height - (rows - 1) * kGap) / rows - kPanelHeadHeight);
    const double scale = fittingScale(window, width, std::max(height, 60.0));
    double score = scale * count / (columns * rows);
    // A page is as wide as it is: what stands empty beside the panels is lost.
    if (!paper.isScreen()) score *= columns * window.width() * scale / sheet_width;
    if (score <= best_score * 1.0001) continue;
    best_score = score;
    best = {columns, rows, std::max(std::ceil(least_width), std::round(window.width() * scale)),
            std::round(window.height() * scale)};
  }
  return best;
}

void drawPanel(draw::Canvas& canvas, const Panel& panel, const draw::MapView& view,
               const draw::PixelBox& whole, const PathColours& colours) {
  canvas.text({whole.left, whole.top + 22},
              draw::Canvas::fitText(panel.title, kPanelTitleSize, whole.width, true), kPanelTitleSize,
              draw::kInk, draw::Align::kLeft, true);
  canvas.text({whole.left, whole.top + 46}, draw::Canvas::fitText(panel.subtitle, kSubtitleSize, whole.width),
              kSubtitleSize, draw::kGrey);
  canvas.clipTo(view.box);
  if (core::isFinite(panel.T_world_map))
    draw::drawRaster(canvas, view, panel.map, panel.T_world_map * panel.map.T_frame_raster);
  else
    canvas.box(view.box, draw::kUnknown);
  drawPaths(canvas, view, panel.paths, colours, kPanelLines);
  canvas.liftClip();
  canvas.frame(view.box, draw::kFrame, 1);
}

}  // namespace

void drawMap(const world::CellMap& map, const std::vector<DrawnPath>& paths, const std::string& title,
             const std::string& file, const DrawnMarks& marks, const draw::Paper& paper) {
  draw::Window truth = draw::windowOf(map, map.T_frame_raster), estimates;
  for (const auto& path : paths) (path.is_truth ? truth : estimates).include(draw::windowOf(path.path));
  if (marks.are_points)
    for (const auto& place : marks.places) estimates.include(place);
  const PathColours colours(paths);
  auto legend = legendOf(paths, colours);
  if (!marks.places.empty()) legend.push_back({draw::LegendEntry::Kind::kDot, draw::kOrange, marks.label});
  MapSheet sheet(draw::usable(draw::withEstimates(truth, estimates)), title, legend, paper);
  auto& canvas = sheet.canvas();
  canvas.clipTo(sheet.view().box);
  draw::drawRaster(canvas, sheet.view(), map, map.T_frame_raster);
  const auto drawMarks = [&](double radius) {
    for (const auto& place : marks.places) canvas.disc(sheet.view().toPixel(place), radius, draw::kOrange);
  };
  if (marks.are_points) drawMarks(1.2);
  drawPaths(canvas, sheet.view(), paths, colours, kMapLines);
  if (!marks.are_points) drawMarks(5);
  canvas.liftClip();
  canvas.frame(sheet.view().box, draw::kFrame, 1);
  canvas.save(file);
}

void drawDifference(const world::Plan& plan, const world::CellMap& map, const core::Pose2& T_world_map,
                    const std::string& title, const std::string& file, const metrics::SeenMask* seen,
                    const draw::Paper& paper) {
  const MapDifference difference(plan, map, T_world_map, seen);
  const auto T_world_raster = T_world_map * map.T_frame_raster;
  const auto window = draw::usable(draw::withEstimates(
      draw::windowOf(plan, plan.T_frame_raster),
      core::isFinite(T_world_raster) ? draw::windowOf(map, T_world_raster) : draw::Window{}));
  MapSheet sheet(window, title, difference.legend(), paper);
  const auto& view = sheet.view();
  const double side_m = 1 / (view.pixelsPerMetre() * draw::Canvas::kSubpixels);
  sheet.canvas().paint(view.box,
                       [&](draw::Pixel pixel) { return difference.colourAt(view.toWorld(pixel), side_m); });
  sheet.canvas().frame(view.box, draw::kFrame, 1);
  sheet.canvas().save(file);
}

namespace {

constexpr draw::Colour kNewColour = draw::kVermillion, kGoneColour = draw::kBlue;
enum ChangeLabel : unsigned char { kNotKnown, kOpen, kStands };

draw::LabelRaster wallsOf(const world::CellMap& map) {
  return draw::LabelRaster(map, map.T_frame_raster, [&](int column, int row) {
    const auto cell = map.at(column, row);
    return cell == world::Cell::kOccupied ? kStands : cell == world::Cell::kFree ? kOpen : kNotKnown;
  });
}

}  // namespace

void drawChanges(const DrawnChanges& changes, const std::string& title, const std::string& file,
                 const draw::Paper& paper) {
  const auto before = wallsOf(changes.before), after = wallsOf(changes.after);
  auto window = draw::windowOf(changes.before, changes.before.T_frame_raster);
  window.include(draw::windowOf(changes.after, changes.after.T_frame_raster));
  using Kind = draw::LegendEntry::Kind;
  MapSheet sheet(draw::usable(window), title,
                 {{Kind::kBox, draw::kWall, "wall in both, or seen once"},
                  {Kind::kBox, kNewColour, "new in " + changes.after_name},
                  {Kind::kBox, kGoneColour, "gone since " + changes.before_name},
                  {Kind::kBox, draw::kUnknown, "not mapped"}},
                 paper);
  const auto& view = sheet.view();
  const double side_m = 1 / (view.pixelsPerMetre() * draw::Canvas::kSubpixels);
  sheet.canvas().paint(view.box, [&](draw::Pixel pixel) {
    const auto p = view.toWorld(pixel);
    const auto was = before.at(p, side_m), is = after.at(p, side_m);
    for (const auto& place : changes.places)
      if ((place.is_new ? is : was) == kStands && core::distance(p, place.centre) <= place.radius_m)
        return place.is_new ? kNewColour : kGoneColour;
    return std::max(was, is) == kStands ? draw::kWall
           : std::max(was, is) == kOpen ? draw::kFree
                                        : draw::kUnknown;
  });
  sheet.canvas().frame(view.box, draw::kFrame, 1);
  constexpr double kRingGap = 4, kNumberSize = 15;
  int number = 0;
  for (const auto& place : changes.places) {
    const auto colour = place.is_new ? kNewColour : kGoneColour;
    const auto centre = view.toPixel(place.centre);
    const double radius = place.radius_m * view.pixelsPerMetre() + kRingGap;
    sheet.canvas().circle(centre, radius, colour, 1.5);
    sheet.canvas().text({centre.x + 0.75 * radius + 2, centre.y - 0.75 * radius}, std::to_string(++number),
                        kNumberSize, colour);
  }
  sheet.canvas().save(file);
}

std::vector<Panel> pathPanels(const world::CellMap& ground, const std::vector<DrawnPath>& paths) {
  std::vector<Panel> panels;
  for (const auto& path : paths) {
    if (path.is_truth) continue;
    Panel panel{path.label, "", ground, {}, {path}, true};
    for (const auto& truth : paths)
      if (truth.is_truth) panel.paths.push_back(truth);
    panels.push_back(std::move(panel));
  }
  return panels;
}

void drawPanels(const std::vector<Panel>& panels, const std::string& file, const draw::Paper& paper) {
  if (panels.empty() || panels.size() > 8) throw core::ContractError("drawPanels: needs 1 to 8 panels");
  const auto window = commonWindow(panels);
  const auto grid = arrange(panels, window, paper);
  const double scale = grid.map_height / window.height();

  std::vector<DrawnPath> all_paths;
  for (const auto& panel : panels)
    for (const auto& path : panel.paths) all_paths.push_back({{}, path.label, path.is_truth});
  const PathColours colours(all_paths);
  const double margin = draw::sheetMargin(paper);
  const double inner_width = paper.isScreen()
                                 ? std::max(kLeastWidth, grid.columns * (grid.panel_width + kGap) - kGap)
                                 : paperWidth(paper);
  const draw::LegendStrip strip(legendOf(all_paths, colours), inner_width, scale);

  const double row_height = kPanelHeadHeight + grid.map_height + kGap;
  const double legend_top = margin + grid.rows * row_height - 0.4 * kGap;
  draw::Canvas canvas(paper.isScreen() ? std::round(inner_width + 2 * margin) : paper.unitsWide(),
                      std::round(legend_top + strip.height() + margin), paper);
  for (size_t i = 0; i < panels.size(); ++i) {
    const auto column = static_cast<int>(i) % grid.columns, row = static_cast<int>(i) / grid.columns;
    const draw::PixelBox whole{margin + column * (grid.panel_width + kGap), margin + row * row_height,
                               grid.panel_width, row_height};
    const draw::MapView view{
        window,
        {whole.left, whole.top + kPanelHeadHeight, std::round(window.width() * scale), grid.map_height}};
    drawPanel(canvas, panels[i], view, whole, colours);
  }
  strip.draw(canvas, {margin, legend_top});
  canvas.save(file);
}

}  // namespace slam::pictures

#include "libslam/pictures/plan_changes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/draw/map_view.h"

namespace slam::pictures {
namespace {
using check::Change;
using world::Cell;

constexpr double kMargin = 20, kHeadSize = 20, kHeadHeight = 32;
constexpr double kMostWidth = 1960, kMostHeight = 1700, kLeastMapWidth = 600;
constexpr draw::Colour kHiddenColour{190, 214, 232};

struct Look {
  Change change;
  draw::Colour colour;
  const char* name;
};
/// The more important the later: a cell of the page shows the last of those it covers.
constexpr std::array<Look, 5> kLooks = {{{Change::kHidden, kHiddenColour, "made unknown"},
                                         {Change::kRemoved, draw::kVermillion, "removed"},
                                         {Change::kAdded, draw::kBlue, "wall added"},
                                         {Change::kOpened, draw::kGreen, "door opened"},
                                         {Change::kClosed, draw::kPurple, "gap closed"}}};
constexpr unsigned char kWallLabel = 2, kFirstLook = 3;

draw::Colour colourOf(unsigned char label) {
  if (label >= kFirstLook) return kLooks[label - kFirstLook].colour;
  return label == kWallLabel ? draw::kWall : label == 1 ? draw::kFree : draw::kUnknown;
}

unsigned char plainLabel(Cell cell) {
  return cell == Cell::kOccupied ? kWallLabel : cell == Cell::kFree ? 1 : 0;
}

/// Before shows what was there and goes, after what was not there and came; what a door's leaf or a text left
/// behind is coloured in both, so that it can be found in both.
draw::LabelRaster labelsOf(const world::Plan& plan, const std::vector<Change>& changes) {
  return {plan, plan.T_frame_raster, [&](int column, int row) {
            const Change change = changes[static_cast<size_t>(row) * plan.columns + column];
            for (size_t i = 0; i < kLooks.size(); ++i)
              if (kLooks[i].change == change) return static_cast<unsigned char>(kFirstLook + i);
            return plainLabel(plan.at(column, row));
          }};
}

/// After: plain where a wall went, so that the result is seen as it is.
std::vector<Change> withoutRemoved(std::vector<Change> changes) {
  for (Change& change : changes)
    if (change == Change::kRemoved || change == Change::kHidden) change = Change::kNone;
  return changes;
}

void drawCells(draw::Canvas& canvas, const draw::MapView& view, const world::Plan& plan,
               const std::vector<Change>& changes) {
  const draw::LabelRaster labels = labelsOf(plan, changes);
  const double side_m = 1 / (view.pixelsPerMetre() * draw::Canvas::kSubpixels);
  canvas.paint(view.box, [&](draw::Pixel pixel) { return colourOf(labels.at(view.toWorld(pixel), side_m)); });
  canvas.frame(view.box, draw::kFrame, 1);
}

std::vector<draw::LegendEntry> legendOf(const std::vector<Change>& changes) {
  std::vector<draw::LegendEntry> entries = {{draw::LegendEntry::Kind::kBox, draw::kWall, "wall"}};
  for (const Look& look : kLooks)
    if (const auto cells = std::count(changes.begin(), changes.end(), look.change); cells > 0)
      entries.push_back(
          {draw::LegendEntry::Kind::kBox, look.colour, look.name + (" (" + std::to_string(cells) + ")")});
  return entries;
}

}  // namespace

void drawPlanChanges(const world::Plan& before, const world::Plan& mended, const std::vector<Change>& changes,
                     const std::string& title, const std::string& file, const draw::Paper& paper) {
  if (before.cells.size() != mended.cells.size() || changes.size() != mended.cells.size() ||
      before.columns != mended.columns)
    throw core::ContractError("drawPlanChanges: rasters of different sizes");
  // Drawn in the scale and place of the mended plan; the raster is the same.
  world::Plan first = before, after = mended;
  first.resolution_m = after.resolution_m;
  first.T_frame_raster = after.T_frame_raster = {};
  const double width_m = after.columns * after.resolution_m, height_m = after.rows * after.resolution_m;
  const bool beside = height_m > 0.6 * width_m;
  const int across = beside ? 2 : 1, down = beside ? 1 : 2;
  const double title_height = draw::titleHeight(title);
  const double scale =
      std::min({(kMostWidth / across - kMargin) / width_m,
                ((kMostHeight - title_height) / down - kHeadHeight) / height_m, 8 / after.resolution_m});
  const double map_width = std::max(1.0, std::round(width_m * scale)),
               map_height = std::max(1.0, std::round(height_m * scale));
  const double content = std::max(kLeastMapWidth, across * map_width + (across - 1) * kMargin);
  const draw::LegendStrip legend(legendOf(changes), content, scale);
  const double total =
      title_height + down * (kHeadHeight + map_height) + (down - 1) * kMargin + legend.height();
  draw::Canvas canvas(static_cast<int>(content + 2 * kMargin), static_cast<int>(total + 2 * kMargin), paper);
  draw::drawTitle(canvas, {kMargin, kMargin}, title, content);
  const draw::Window window{0, 0, map_width / scale, map_height / scale};
  for (int i = 0; i < 2; ++i) {
    const double x = kMargin + (beside ? i * (map_width + kMargin) : 0);
    const double y = kMargin + title_height + (beside ? 0 : i * (kHeadHeight + map_height + kMargin));
    canvas.text({x, y + kHeadSize}, i == 0 ? "before: what goes" : "after: what came", kHeadSize, draw::kInk);
    const draw::MapView view{window, {x, y + kHeadHeight, map_width, map_height}};
    if (i == 0)
      drawCells(canvas, view, first, changes);
    else
      drawCells(canvas, view, after, withoutRemoved(changes));
  }
  legend.draw(canvas, {kMargin, total + kMargin - legend.height()});
  canvas.save(file);
}

}  // namespace slam::pictures

#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/draw/canvas.h"
#include "libslam/world/cell_map.h"

namespace slam::draw {

/// A rectangle of the world, metres; nothing when x1 < x0.
struct Window {
  double x0 = 1, y0 = 1, x1 = 0, y1 = 0;

  bool isEmpty() const { return x1 < x0 || y1 < y0; }
  double width() const { return x1 - x0; }
  double height() const { return y1 - y0; }
  void include(const core::Point2& p);  ///< points that are not finite are passed over
  void include(const Window& other);
  /// Grown by this share of its longer side all round.
  Window grownBy(double share) const;
  /// What lies within the other.
  Window cutTo(const Window& other) const;
};

/// What of a raster is worth showing: the occupied cells, or the known ones where there is no wall.
Window windowOf(const world::CellMap& raster, const core::Pose2& T_world_raster);
Window windowOf(const core::Trajectory& path);

/// Never empty and never thin, with a little air all round: a picture needs an area.
Window usable(Window window);
/// Estimates may have gone far astray: they widen a window that the truth gives by a tenth at most.
Window withEstimates(const Window& truth, const Window& estimates);
/// One usable window for several maps. A map that has gone to pieces must not shrink the others: each side
/// lies where it does for half of the maps that have any, or farther out where one reaches there, unless that
/// is more than 0.15 of the window's longer side; and all of the truth is shown. Without a map:
/// withEstimates().
Window commonWindow(const std::vector<Window>& maps, const Window& truth, const Window& estimates);

/// A window of the world on a box of a canvas, y up.
struct MapView {
  Window window;
  PixelBox box;

  double pixelsPerMetre() const { return box.width / window.width(); }
  Pixel toPixel(const core::Point2& p_world) const;
  core::Point2 toWorld(Pixel pixel) const;
};

/// One small number per cell of a raster, the more important the higher: where several cells share a point of
/// the picture the highest is shown, so that a thin wall never vanishes. 0 is also what lies outside.
class LabelRaster {
 public:
  /// Nothing: 0 everywhere.
  LabelRaster() = default;
  /// label_of(column, row) for every cell of a raster.
  template <class LabelOf>
  LabelRaster(const world::CellMap& raster, const core::Pose2& T_world_raster, LabelOf label_of)
      : LabelRaster(raster, T_world_raster) {
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < columns_; ++column) labels_.push_back(label_of(column, row));
  }

  /// The highest label within the square of that side around the point; the one at the point when the square
  /// is not larger than a cell.
  unsigned char at(const core::Point2& p_world, double side_m) const;

 private:
  LabelRaster(const world::CellMap& raster, const core::Pose2& T_world_raster);

  int columns_ = 0, rows_ = 0;
  double resolution_m_ = 1;
  core::Pose2 T_world_raster_;
  double cosine_ = 1, sine_ = 0;  ///< of the raster's turn: at() is asked millions of times
  std::vector<unsigned char> labels_;
};

inline constexpr Colour kInk{40, 40, 40}, kGrey{110, 110, 110}, kWall{38, 38, 38}, kFree{255, 255, 255},
    kUnknown{222, 222, 222}, kTruthPath{165, 165, 165}, kFrame{150, 150, 150};

/// Walls dark, free white, unknown grey.
void drawRaster(Canvas& canvas, const MapView& view, const world::CellMap& raster,
                const core::Pose2& T_world_raster);
void drawPath(Canvas& canvas, const MapView& view, const core::Trajectory& path, Colour colour,
              double line_width);
/// The same in dashes.
void drawDashedPath(Canvas& canvas, const MapView& view, const core::Trajectory& path, Colour colour,
                    double line_width);
/// A ring where the path begins.
void drawStart(Canvas& canvas, Pixel at);

/// A row of the legend: a sample and what it means.
struct LegendEntry {
  enum class Kind { kLine, kBroadLine, kDashes, kBox, kStart, kDot, kRing } kind;
  Colour colour;
  std::string label;
};
/// The strip under a map: entries from the left in as many lines as they need, the scale bar at the right.
class LegendStrip {
 public:
  LegendStrip(std::vector<LegendEntry> entries, double width, double pixels_per_metre);
  double height() const;
  void draw(Canvas& canvas, Pixel upper_left) const;

 private:
  void drawScaleBar(Canvas& canvas, Pixel right_end) const;
  std::string barLabel() const;

  std::vector<LegendEntry> entries_;
  std::vector<Pixel> places_;  ///< of the entries, from the strip's upper left
  double width_, pixels_per_metre_, bar_m_;
  int lines_ = 1;
};

/// 1, 2 or 5 times a power of ten, the largest at most `most`.
double niceStep(double most);
/// "0.5", "20": such a step as a label.
std::string stepLabel(double value);

/// The room of a picture's title, units: none for an empty one.
double titleHeight(const std::string& title);
/// Cut to the width.
void drawTitle(Canvas& canvas, Pixel upper_left, const std::string& title, double width);

}  // namespace slam::draw

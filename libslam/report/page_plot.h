#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/draw/canvas.h"
#include "libslam/draw/map_view.h"
#include "libslam/pictures/map_difference.h"
#include "libslam/world/cell_map.h"

namespace slam::report {

// Pieces of the HTML report: pictures as PNG, plots as SVG that needs no script. The same input gives the
// same bytes.

/// A small square of the colour, for legends.
std::string swatchElement(draw::Colour colour);

/// A raster over a window of the world as PNG, walls dark, free white, unknown grey: about a pixel per cell
/// of `cell_m`, at most kMostPixels on a side. T_world_raster not finite: all unknown.
std::string rasterPng(const world::CellMap& raster, const core::Pose2& T_world_raster,
                      const draw::Window& window, double cell_m);
/// The same of a difference, in its colours.
std::string differencePng(const pictures::MapDifference& difference, const draw::Window& window,
                          double cell_m);
inline constexpr int kMostPixels = 1000;

/// A path's outline for an SVG whose units are metres, y down: draw::outline() as text. A place is a dot.
std::string pathOutline(const std::vector<core::Point2>& points, double tolerance_m);

/// Classes of error, the same in every report, so that colours compare.
struct ErrorClass {
  double below_m;  ///< and at least the one before
  draw::Colour colour;
  const char* label;
};
const std::vector<ErrorClass>& errorClasses();

/// Of the bar in mapSvg(): 1, 2 or 5 times a power of ten.
double scaleBar(const draw::Window& window);
/// A map for the page. `body`: SVG in metres, y down, over the window. Maps of one `group` zoom together.
std::string mapSvg(const draw::Window& window, const std::string& description, const std::string& body,
                   const std::string& group = "0");
/// `path` elements for mapSvg().
std::string pathElement(const std::vector<core::Point2>& points, const draw::Window& window,
                        draw::Colour colour, double line_width);
/// The path in the colours of errorClasses(); error_m as long as path.
std::string errorPathElements(const core::Trajectory& path, const std::vector<double>& error_m,
                              const draw::Window& window);

/// A quantity over time, one line per method.
struct TimeSeries {
  std::string label;
  draw::Colour colour;
  std::vector<double> time_s,
      value;  ///< as long as one another; what is not finite or above 0 breaks the line
};
/// A chart with a logarithmic axis; long lines are drawn by the highest of the values that share a place,
/// `place_width` wide (the drawing is 720). "" where nothing is to be drawn. `id` is the element's.
std::string timeChart(const std::vector<TimeSeries>& series, const std::string& id,
                      const std::string& y_title, double duration_s, double place_width = 0.5);

}  // namespace slam::report

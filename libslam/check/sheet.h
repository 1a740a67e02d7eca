#pragma once
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libslam/check/plan_check.h"
#include "libslam/drafting/door_arcs.h"
#include "libslam/drafting/regions.h"
#include "libslam/world/picture_file.h"

namespace slam::check {

/// The plan under examination, as its picture lies: row 0 at the top. Rules read it and paint on it.
struct Sheet {
  const PlanCheckOptions& options;
  const world::Picture& picture;
  const std::vector<world::Colour>& pixels;  ///< the picture's colours
  world::PlanOptions reading;                ///< thresholds and placement with which `cells` was read
  bool has_scale = false;                    ///< the resolution is given, by a yaml or by the caller
  bool goes_by_gray = true;                  ///< false: by transparency, or raw percents
  bool goes_by_alpha = false;  ///< a bare picture with transparency: opaque is wall, whatever its colour
  bool is_map = false;         ///< else a drawing
  double resolution_m = 0.05;  ///< the best known so far
  cv::Mat cells;               ///< CV_8U, values of Cell
  cv::Mat changes;             ///< CV_8U, values of Change
  cv::Mat faint;               ///< 255 on all lines of a drawing, those too pale for a wall, too; or empty
  std::vector<Finding> findings;
  std::optional<std::vector<drafting::DoorArc>> door_arcs;  ///< once they have been looked for: doorArcsOf()

  cv::Mat mask(world::Cell cell) const { return cells == static_cast<int>(cell); }  ///< 255 where it is
  /// Sets the cells under the mask; those that already are so stay unchanged. Returns how many changed.
  int paint(const cv::Mat& where, world::Cell cell, Change change);
  double toPixels(double length_m) const { return length_m / resolution_m; }
  double squareMetres(double cell_count) const { return cell_count * resolution_m * resolution_m; }
  FindingPlace place(const cv::Point& pixel) const;
  /// Explicitly asked for, so also where it is usually not looked for.
  bool isAskedFor(const std::string& key) const;
};

/// The doors drawn on the sheet when this was first asked, lettering left out.
const std::vector<drafting::DoorArc>& doorArcsOf(Sheet& sheet);

/// What a robot can do in it, when it keeps to free cells: the unknown stops it as walls do, because there
/// walls are built in the end.
struct Reach {
  cv::Mat body;     ///< cells that the body can cover from the best start
  cv::Mat pockets;  ///< cells that the body could cover from somewhere else only
};
Reach reachOfRobot(const Sheet& sheet);

/// Free space amid the walls before mending, and how much of it is unknown afterwards. Cells.
struct HiddenSpace {
  int before = 0, hidden = 0;
};

/// `before`: the cells as they were read, as the sheet's lie; `drawn`: once text and dimension lines are gone
/// and before the outside is taken away. Amid the walls is what the paper around a drawing does not reach
/// through gaps of up to 4 m, of a map everything.
HiddenSpace hiddenSpace(const Sheet& sheet, const cv::Mat& before, const cv::Mat& drawn);

/// The gray of unknown cells as map servers write it: 205, or 206 where rounded up.
inline bool isMapServersGray(std::uint16_t gray) {
  return gray / 257 == 205 || gray / 257 == 206;
}
/// Memory that a simulation takes for so many cells.
double megabytesToSimulate(size_t cells);

/// "12.3", "0.45": metres or square metres with the digits that matter.
std::string metres(double value);
std::string percent(double share);
/// "1 door", "3 doors".
std::string counted(int count, const std::string& one, const std::string& many);
/// " at pixel (x, y)" or, for several, ", the first at pixel (x, y)".
std::string atPixel(const std::vector<FindingPlace>& places);

}  // namespace slam::check

#pragma once
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libslam/check/door_arcs.h"
#include "libslam/check/plan_check.h"
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
  std::optional<std::vector<DoorArc>> door_arcs;  ///< once they have been looked for: doorArcsOf()

  cv::Mat mask(world::Cell cell) const { return cells == static_cast<int>(cell); }  ///< 255 where it is
  /// Sets the cells under the mask; those that already are so stay unchanged. Returns how many changed.
  int paint(const cv::Mat& where, world::Cell cell, Change change);
  double toPixels(double length_m) const { return length_m / resolution_m; }
  double squareMetres(double cell_count) const { return cell_count * resolution_m * resolution_m; }
  FindingPlace place(const cv::Point& pixel) const;
  /// Explicitly asked for, so also where it is usually not looked for.
  bool isAskedFor(const std::string& key) const;
};

/// Connected sets of a mask; label 0 is the background.
struct Regions {
  cv::Mat labels;  ///< CV_32S
  int count = 0;   ///< with the background
  cv::Mat stats, centroids;
  int area(int label) const { return stats.at<int>(label, cv::CC_STAT_AREA); }
  cv::Rect box(int label) const;
  cv::Point anyPixel(int label) const;  ///< the first in reading order
};
Regions regionsOf(const cv::Mat& mask, int connectivity);

/// 255 where the label's entry in `chosen` is not 0. Cost: one pass.
cv::Mat maskOf(const Regions& regions, const std::vector<char>& chosen);
/// Labels that occur under the mask.
std::vector<char> labelsUnder(const Regions& regions, const cv::Mat& mask);
/// Free cells 4-connected with the edge of the picture.
cv::Mat reachedFromEdge(const cv::Mat& free);

/// A disc-shaped brush; dilating with it reaches `radius` pixels.
cv::Mat disc(double radius);
/// Cells at most `radius` from a marked one, by the exact distance between centres.
cv::Mat grown(const cv::Mat& mask, double radius);
/// Ink that stays when a disc of this diameter must fit within: the thick strokes.
cv::Mat thickStrokes(const cv::Mat& ink, double diameter);
/// Distance of each marked cell's centre to the nearest centre of one that is not; the picture's edge counts
/// as not marked when `edge_counts`. CV_32F.
cv::Mat clearance(const cv::Mat& mask, bool edge_counts);

/// The doors drawn on the sheet when this was first asked, lettering left out.
const std::vector<DoorArc>& doorArcsOf(Sheet& sheet);

/// What a robot can do in it, when it keeps to free cells: the unknown stops it as walls do, because there
/// walls are built in the end.
struct Reach {
  cv::Mat body;     ///< cells that the body can cover from the best start
  cv::Mat pockets;  ///< cells that the body could cover from somewhere else only
};
Reach reachOfRobot(const Sheet& sheet);

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

#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/draw/canvas.h"
#include "libslam/lidar/scan.h"
#include "libslam/metrics/map_score.h"
#include "libslam/world/plan.h"

namespace slam::pictures {

/// A path to draw, in the frame of the picture's map (the world's, or an estimate's where there is no truth).
struct DrawnPath {
  core::Trajectory path;
  std::string label;
  /// Beside others dashed and over them, else grey and broad. Of the others the first lies on top.
  bool is_truth = false;
};

// All pictures: PNG, SVG or PDF by the file's extension, the same input gives the same bytes, written
// atomically (core::IoError with the path). For the screen at least 600 pixels wide, at most 2000 on either
// side; for paper exactly as wide as that, the layout made for it (drawn with the text of the size asked
// for). Legend and scale bar stand in a strip below the map. Colours are the Okabe-Ito palette (safe for
// colour-blind readers), given to paths by label in the order of first use. Walls are dark, free space white,
// the unknown grey. What is shown is the part of the world that holds walls and the true path; estimates may
// widen it by a tenth and are cut where they leave it. Points that are not finite break a path. Rasters lie
// where their T_frame_raster says.

/// Places to mark with a dot, in the frame of the picture's map.
struct DrawnMarks {
  std::vector<core::Point2> places;
  std::string label;
  bool are_points =
      false;  ///< many and small, such as returns of scans: under the paths, and the picture shows them all
};

/// A plan, or an estimated map, with paths, and marks over them (points: under them).
void drawMap(const world::CellMap& map, const std::vector<DrawnPath>& paths, const std::string& title,
             const std::string& file, const DrawnMarks& marks = {}, const draw::Paper& paper = {});

/// An estimated map over the true plan. A wall cell of one agrees when the other has a wall within two cells
/// (of the coarser raster; the legend states it in metres); agreeing walls are dark, walls of the map alone
/// one colour, walls of the truth alone another. Of the truth only wall cells that touch free space can be
/// missed; the inside of a block is plain. With `seen` (what the robot could see) walls that were never in
/// its view are no longer missed but pale, under a name of their own; without it every wall can be missed,
/// whether the robot was there or not. T_world_map not finite: the truth alone. REQUIRES a mask of the plan's
/// size (ContractError).
void drawDifference(const world::Plan& plan, const world::CellMap& map, const core::Pose2& T_world_map,
                    const std::string& title, const std::string& file,
                    const metrics::SeenMask* seen = nullptr, const draw::Paper& paper = {});

/// Two estimated maps of one place, each where its T_frame_raster says: walls of both dark, free in either
/// white, and around each place a ring with its number, from 1, within which the walls of the later map, or
/// of the earlier one, are in colour.
struct DrawnChanges {
  world::CellMap before, after;
  std::string before_name, after_name;
  struct Place {
    core::Point2 centre;
    double radius_m;
    bool is_new;  ///< else gone
  };
  std::vector<Place> places;
};
void drawChanges(const DrawnChanges& changes, const std::string& title, const std::string& file,
                 const draw::Paper& paper = {});

/// One map per method, all in the same window of the world at the same scale, in the grid that shows them
/// largest: the picture of a comparison. The window holds what half of the maps reach, so that one that has
/// gone astray does not shrink the rest, and what is true: paths and plans, whole. REQUIRES 1 to 8 panels.
struct Panel {
  std::string title, subtitle;
  world::CellMap map;            ///< in its own map frame
  core::Pose2 T_world_map;       ///< not finite: the map is left out
  std::vector<DrawnPath> paths;  ///< in the world frame
  bool is_true = false;          ///< the map is the cells of a true plan
};
void drawPanels(const std::vector<Panel>& panels, const std::string& file, const draw::Paper& paper = {});
/// A panel for every path but the true one, which lies in each of them: where paths would hide one another.
std::vector<Panel> pathPanels(const world::CellMap& ground, const std::vector<DrawnPath>& paths);

/// A scan: range over angle (the original chart; beams without a return leave gaps) beside the polar plot,
/// lidar frame, ahead up.
void drawScan(const lidar::Scan& scan, const std::string& file, const draw::Paper& paper = {});

}  // namespace slam::pictures

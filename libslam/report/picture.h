#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/robot/scan.h"
#include "libslam/world/plan.h"

namespace slam::report {

/// A path to draw, in the frame of the picture's plan (world, or map where there is no truth).
struct DrawnPath {
  core::Trajectory path;
  std::string label;
  bool is_truth = false;  ///< drawn grey and broad, under the others
};

/// PNG of a plan with paths, legend, scale bar. Colours are the Okabe-Ito palette (safe for colour-blind
/// readers), in the order of the paths. At least 600 px on the long side, at most 2000. Written atomically.
void drawPlan(const world::Plan& plan, const std::vector<DrawnPath>& paths, const std::string& title,
              const std::string& png_path);

/// PNG of an estimated map over the true plan: agreeing walls dark, walls only in the estimate one colour,
/// walls only in the truth another, free space agreed light; legend.
void drawDifference(const world::Plan& plan, const world::Plan& map, const core::Pose2& T_world_map,
                    const std::string& title, const std::string& png_path);

/// PNG with one map per method side by side, titled (same scale): the picture of a comparison.
struct Panel {
  std::string title, subtitle;
  world::Plan map;  ///< in its own map frame
  core::Pose2 T_world_map;
  std::vector<DrawnPath> paths;  ///< in the world frame
};
void drawPanels(const std::vector<Panel>& panels, const std::string& png_path);

/// PNG of a scan: range over angle (the founding chart) beside the polar plot.
void drawScan(const robot::Scan& scan, const std::string& png_path);

}  // namespace slam::report

#pragma once
#include <mrpt/opengl/CRenderizable.h>

#include <utility>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/gridmap/occupancy_raster.h"
#include "libslam/lidar/scan.h"
#include "libslam/world/plan.h"

/// What a scene is made of, one function per layer. Every function makes one named object, flat, of MRPT's
/// stock classes (any MRPT program shows it), in the frame that it says; place() puts it into another one.
/// Layers lie some centimetres above each other in the order below, so that they hide each other as sheets of
/// paper do, seen from above as well as aslant. Colours: the Okabe-Ito palette (draw/canvas.h). Points that
/// are not finite are left out, and break lines. `line_m` is a line's width in metres: OpenGL's own lines are
/// a pixel wide at most.
namespace slam::viewer {

using Layer = mrpt::opengl::CRenderizable::Ptr;

/// Names of the layers, to find and exchange them by, from the ground up.
inline constexpr const char *kPlanLayer = "plan", *kMapLayer = "map", *kTruthLayer = "truth",
                            *kGraphLayer = "graph", *kPathLayer = "path", *kLoopsLayer = "loops",
                            *kObstaclesLayer = "obstacles", *kScanLayer = "scan",
                            *kStrategicLayer = "strategic", *kPeopleLayer = "people",
                            *kCandidatesLayer = "candidates", *kRobotLayer = "robot",
                            *kParticlesLayer = "particles";

/// A key that switches layers on and off together.
struct LayerSwitch {
  char key;
  std::vector<const char*> layers;
};
/// For all but the robot.
const std::vector<LayerSwitch>& layerSwitches();

/// How high above the floor a layer lies, metres.
double heightOf(const char* name);

/// Puts a layer from its own frame into the scene's, at its own height.
void place(const Layer& layer, const core::Pose2& T_scene_layer);

/// A true plan, world frame: walls grey, free light, unknown a little darker. Materials: glass sky blue,
/// mirrors purple, dark ones black.
Layer planLayer(const world::Plan& plan);
/// An estimated map, map frame: occupied dark, free white, the unknown not there at all.
Layer mapLayer(const gridmap::OccupancyRaster& map);

/// The original drawing, robot frame: a square, the circle around it that must stay free, and which way is
/// ahead.
Layer robotLayer(double side_m, double line_m);
/// A dot at each return and some rays to them, robot frame.
Layer scanLayer(const lidar::Scan& scan);

/// The path as estimated, and the true one broad and grey below it.
Layer pathLayer(const core::Trajectory& path, double line_m);
Layer truthLayer(const core::Trajectory& path, double line_m);

/// Something round that moves about, world frame.
struct Body {
  core::Point2 place;
  double radius_m = 0;
};
Layer peopleLayer(const std::vector<Body>& people);

/// Particles as arrows of length_m, map frame.
Layer particlesLayer(const std::vector<core::Pose2>& particles, double length_m);

/// A line between two places.
using Connection = std::pair<core::Point2, core::Point2>;
/// A graph is drawn with at most so many; of more every so-many-th, as many as a screen tells apart.
inline constexpr std::size_t kMostDots = 5000, kMostEdges = 20000;
/// Keyframes as dots and what ties them, map frame.
Layer graphLayer(const std::vector<core::Point2>& nodes, const std::vector<Connection>& edges, double line_m);
/// Loops that a method has closed, map frame.
Layer loopsLayer(const std::vector<Connection>& loops, double line_m);

/// What a robot knows of the obstacles around it, robot frame.
struct LocalObstacles {
  std::vector<core::Point2> visible;            ///< outline of what the sensor looks over
  std::vector<core::Point2> seen;               ///< obstacles seen now
  std::vector<core::Point2> remembered;         ///< obstacles that it has turned away from
  double front_m = 0, rear_m = 0, width_m = 0;  ///< of the zone that is remembered
};
/// Seen obstacles as vermillion dots, remembered ones blue.
Layer obstaclesLayer(const LocalObstacles& obstacles, double radius_m);

/// What the original goal navigation looks at.
struct StrategicView {
  double stop_radius_m = 0;
  std::vector<core::Point2> projected;  ///< where the readings of the strategic directions end
};
/// The stop radius as a dashed circle, the strategic directions as lines with a dot at their end, robot
/// frame.
Layer strategicLayer(const StrategicView& view, double line_m);

/// What a strategy chose from, and what.
struct Candidates {
  std::vector<core::Point2> places;
  core::Point2 goal;               ///< the choice; not finite: none yet
  std::vector<core::Point2> path;  ///< to the goal, from the robot
};
Layer candidatesLayer(const Candidates& candidates, double radius_m, double line_m);

}  // namespace slam::viewer

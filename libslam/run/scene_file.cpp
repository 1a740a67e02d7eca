#include "libslam/run/scene_file.h"

#include <mrpt/img/CImage.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/mapping/graph_slam.h"
#include "libslam/report/map_view.h"
#include "libslam/report/page_text.h"
#include "libslam/viewer/layers.h"

namespace slam::run {
namespace {

using mrpt::opengl::COpenGLScene;

constexpr double kLineShare =
    1.0 / 450;  // of the scene's longer side: broad enough when all of it is looked at
constexpr double kRobotSide_m = 0.3;
// A camera shows half of its distance from top to bottom; windows are broader than tall.
constexpr double kDistance = 2.1, kBreadth = 1.3;
constexpr float kNearest_m = 1, kFarthest_m = 1000;

/// What is transparent lets through what was drawn before it: from the ground up.
constexpr std::array<std::string_view, 9> kOrder = {
    viewer::kPlanLayer,  viewer::kMapLayer,  viewer::kTruthLayer, viewer::kGraphLayer,    viewer::kPathLayer,
    viewer::kLoopsLayer, viewer::kScanLayer, viewer::kRobotLayer, viewer::kParticlesLayer};

void save(const COpenGLScene& scene, const std::string& file) {
  // Otherwise walls get the rings of a photograph.
  mrpt::img::CImage::DISABLE_JPEG_COMPRESSION(true);
  mrpt::io::CMemoryStream buffer;
  mrpt::serialization::archiveFrom(buffer) << scene;
  core::writeFileAtomically(
      file, report::gzip({static_cast<const char*>(buffer.getRawBufferData()), buffer.getTotalBytesCount()}));
}

/// Some viewers have depth buffers of 16 bits, and look from far: layers stand farther apart than in a window of ours.
constexpr double kSheet_m = 0.1;

void insert(COpenGLScene& scene, const viewer::Layer& layer, const core::Pose2& T_map_layer) {
  const auto place = std::find(kOrder.begin(), kOrder.end(), layer->getName()) - kOrder.begin();
  layer->setPose(mrpt::poses::CPose3D(T_map_layer.x, T_map_layer.y, kSheet_m * static_cast<double>(place),
                                      T_map_layer.phi, 0, 0));
  scene.insert(layer);
}

/// From straight above, the whole window in view, and no layer lost in the depth buffer.
void lookAt(COpenGLScene& scene, const report::Window& window) {
  auto& camera = scene.getViewport("main")->getCamera();
  camera.setPointingAt(static_cast<float>((window.x0 + window.x1) / 2),
                       static_cast<float>((window.y0 + window.y1) / 2), 0);
  camera.setZoomDistance(
      static_cast<float>(kDistance * std::max(window.width() / kBreadth, window.height())));
  camera.setAzimuthDegrees(-90);
  camera.setElevationDegrees(89.9F);
  camera.setOrthogonal(true);
  scene.enableFollowCamera(true);  // SceneViewer3D takes it over when the file is opened
  scene.getViewport("main")->setViewportClipDistances(kNearest_m, kFarthest_m);
}

report::Window windowOf(const gridmap::OccupancyRaster& map, const core::Trajectory& path) {
  report::Window window = report::windowOf(path);
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column)
      if (map.at(column, row) > gridmap::kOccupiedAbove)
        window.include(
            core::Point2{map.x_min_m + column * map.resolution_m, map.y_min_m + row * map.resolution_m});
  return report::usable(window);
}

double lineWidth(const report::Window& window) {
  return kLineShare * std::max(window.width(), window.height());
}

void insertGraph(COpenGLScene& scene, const mapping::GraphSlam& slam, double line_m) {
  const auto& graph = slam.graph();
  std::vector<core::Point2> nodes;
  for (const auto& pose : graph.poses()) nodes.push_back(core::position(pose));
  std::vector<viewer::Connection> edges, loops;
  for (const auto& edge : graph.edges()) {
    if (!edge.on || edge.from == posegraph::kMap) continue;
    auto& list = edge.kind == posegraph::EdgeKind::kLoop ? loops : edges;
    list.emplace_back(nodes[static_cast<size_t>(edge.from)], nodes[static_cast<size_t>(edge.to)]);
  }
  insert(scene, viewer::graphLayer(nodes, edges, 0.7 * line_m), {});
  if (!loops.empty()) insert(scene, viewer::loopsLayer(loops, line_m), {});
}

/// The layers of a scene that was read, in the order in which they are drawn.
void sortLayers(COpenGLScene& scene) {
  std::vector<viewer::Layer> layers;
  for (const auto name : kOrder)
    if (const auto layer = scene.getByName(std::string(name))) layers.push_back(layer);
  for (const auto& layer : layers) scene.removeObject(layer);
  for (const auto& layer : layers) scene.insert(layer);
}

}  // namespace

void writeScene(const mapping::MapBuilder& method, const core::Trajectory& path, const robot::Scan& last_scan,
                const std::string& file) {
  const auto map = mapping::currentMap(method);
  const auto window = windowOf(map, path);
  const double line_m = lineWidth(window);
  COpenGLScene scene;
  insert(scene, viewer::mapLayer(map), {});
  if (const auto* graph = mapping::graphSlamOf(method)) insertGraph(scene, *graph, line_m);
  insert(scene, viewer::pathLayer(path, line_m), {});
  if (!path.empty()) {
    insert(scene, viewer::scanLayer(last_scan), path.back().pose);
    insert(scene, viewer::robotLayer(kRobotSide_m, 0.5 * line_m), path.back().pose);
  }
  if (const auto particles = mapping::particlePoses(method); !particles.empty())
    insert(scene, viewer::particlesLayer(particles, 3 * line_m), {});
  sortLayers(scene);
  lookAt(scene, window);
  save(scene, file);
}

void addTruthToScene(const core::Trajectory& truth, const world::Plan* plan, const core::Pose2& T_map_world,
                     const std::string& file) {
  core::requireReadableFile(file);
  COpenGLScene scene;
  if (!scene.loadFromFile(file)) throw core::InputError(file + ": is not a scene, expected MRPT's .3Dscene");
  for (const char* name : {viewer::kPlanLayer, viewer::kTruthLayer})
    if (const auto old = scene.getByName(name)) scene.removeObject(old);
  report::Window window;
  core::Trajectory truth_in_map;
  for (const auto& stamped : truth) truth_in_map.push_back({stamped.time_s, T_map_world * stamped.pose});
  window.include(report::windowOf(truth_in_map));
  if (plan) {
    window.include(report::windowOf(*plan, T_map_world * plan->T_world_plan));
    insert(scene, viewer::planLayer(*plan), T_map_world);
  }
  window = report::usable(window);
  insert(scene, viewer::truthLayer(truth, lineWidth(window)), T_map_world);
  sortLayers(scene);
  lookAt(scene, window);
  save(scene, file);
}

}  // namespace slam::run

#include "libslam/results/scene_file.h"

#include <mrpt/img/CImage.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CPointCloud.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/opengl/CSetOfTexturedTriangles.h>
#include <mrpt/opengl/CSetOfTriangles.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/draw/map_view.h"
#include "libslam/files/files.h"
#include "libslam/files/memory_guard.h"
#include "libslam/files/trial_run.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/resources/gzip.h"
#include "libslam/viewer/layers.h"

namespace slam::results {
namespace {

using mrpt::opengl::COpenGLScene;

constexpr double kLineShare =
    1.0 / 450;  // of the scene's longer side: broad enough when all of it is looked at
constexpr double kRobotSide_m = 0.3;
constexpr double kUnstretched_m = 30;
// A camera shows half of its distance from top to bottom; windows are broader than tall.
constexpr double kDistance = 2.1, kBreadth = 1.3;

void save(const COpenGLScene& scene, const std::string& file) {
  // Otherwise walls get the rings of a photograph.
  mrpt::img::CImage::DISABLE_JPEG_COMPRESSION(true);
  mrpt::io::CMemoryStream buffer;
  mrpt::serialization::archiveFrom(buffer) << scene;
  resources::writeGzipFile(
      file, {static_cast<const char*>(buffer.getRawBufferData()), buffer.getTotalBytesCount()});
}

using mrpt::img::TColor;
using Triangle = mrpt::opengl::TTriangle;

/// What an object draws, as opaque triangles: lines and points as broad as `line_m`, what is transparent as
/// on white.
void addTriangles(const mrpt::opengl::CRenderizable& object, double line_m,
                  std::vector<std::pair<Triangle, TColor>>& triangles) {
  const auto onWhite = [](const TColor& colour) {
    const auto mixed = [&](std::uint8_t c) {
      return static_cast<std::uint8_t>((c * colour.A + 255 * (255 - colour.A)) / 255);
    };
    return TColor(mixed(colour.R), mixed(colour.G), mixed(colour.B));
  };
  const auto colour = onWhite(object.getColor_u8());
  const auto addQuad = [&](const std::array<mrpt::math::TPoint3Df, 4>& corners) {
    triangles.emplace_back(Triangle(corners[0], corners[1], corners[2]), colour);
    triangles.emplace_back(Triangle(corners[0], corners[2], corners[3]), colour);
  };
  const auto half = static_cast<float>(line_m / 2);
  if (const auto* group = dynamic_cast<const mrpt::opengl::CSetOfObjects*>(&object)) {
    for (const auto& part : *group) addTriangles(*part, line_m, triangles);
  } else if (const auto* set = dynamic_cast<const mrpt::opengl::CSetOfTriangles*>(&object)) {
    for (size_t i = 0; i < set->getTrianglesCount(); ++i) {
      Triangle triangle;
      set->getTriangle(i, triangle);
      const auto& corner = triangle.vertices[0].xyzrgba;
      triangles.emplace_back(triangle, onWhite({corner.r, corner.g, corner.b, corner.a}));
    }
  } else if (const auto* lines = dynamic_cast<const mrpt::opengl::CSetOfLines*>(&object)) {
    for (size_t i = 0; i < lines->getLineCount(); ++i) {
      const auto line = (lines->begin() + static_cast<std::ptrdiff_t>(i));
      const auto from = mrpt::math::TPoint3Df(line->point1), to = mrpt::math::TPoint3Df(line->point2);
      const auto length = static_cast<float>(core::hypot(to.x - from.x, to.y - from.y));
      if (!(length > 0)) continue;
      const float dx = -(to.y - from.y) / length * half, dy = (to.x - from.x) / length * half;
      addQuad({{{from.x + dx, from.y + dy, from.z},
                {from.x - dx, from.y - dy, from.z},
                {to.x - dx, to.y - dy, to.z},
                {to.x + dx, to.y + dy, to.z}}});
    }
  } else if (const auto* points = dynamic_cast<const mrpt::opengl::CPointCloud*>(&object)) {
    for (size_t i = 0; i < points->size(); ++i) {
      const auto p = points->getPoint3Df(i);
      addQuad({{{p.x - half, p.y - half, p.z},
                {p.x + half, p.y - half, p.z},
                {p.x + half, p.y + half, p.z},
                {p.x - half, p.y + half, p.z}}});
    }
  }
}

/// A layer as triangles with a texture, a set for each colour. Seen from 50 m SceneViewer3D's depth buffer of
/// 16 bits holds all layers for equally far, and what is drawn first stays: MRPT draws what has a texture, as
/// the maps have, from near to far.
viewer::Layer painted(const viewer::Layer& layer, double line_m) {
  std::vector<std::pair<Triangle, TColor>> triangles;
  addTriangles(*layer, line_m, triangles);
  std::stable_sort(triangles.begin(), triangles.end(),
                   [](const auto& a, const auto& b) { return a.first.z(0) > b.first.z(0); });
  auto sets = mrpt::opengl::CSetOfObjects::Create();
  std::vector<std::pair<TColor, mrpt::opengl::CSetOfTexturedTriangles::Ptr>> by_colour;
  for (const auto& [triangle, colour] : triangles) {
    const auto isOfColour = [&of = colour](const auto& entry) { return entry.first == of; };
    auto found = std::find_if(by_colour.begin(), by_colour.end(), isOfColour);
    if (found == by_colour.end()) {
      constexpr int kSide = 4;
      mrpt::img::CImage image(kSide, kSide, mrpt::img::CH_RGB);
      image.filledRectangle(0, 0, kSide - 1, kSide - 1, colour);
      found = by_colour.insert(found, {colour, mrpt::opengl::CSetOfTexturedTriangles::Create()});
      found->second->assignImage(image);
      found->second->enableLight(false);
      sets->insert(found->second);
    }
    found->second->insertTriangle(triangle);
  }
  sets->setName(layer->getName());
  return sets;
}

void insertRaster(COpenGLScene& scene, const viewer::Layer& layer, const core::Pose2& T_map_layer) {
  viewer::place(layer, T_map_layer);
  scene.insert(layer);
}

void insert(COpenGLScene& scene, const viewer::Layer& layer, const core::Pose2& T_map_layer, double line_m) {
  insertRaster(scene, painted(layer, line_m), T_map_layer);
}

/// From straight above, the whole window in view.
void lookAt(COpenGLScene& scene, const draw::Window& window) {
  auto& camera = scene.getViewport("main")->getCamera();
  camera.setPointingAt(static_cast<float>((window.x0 + window.x1) / 2),
                       static_cast<float>((window.y0 + window.y1) / 2), 0);
  camera.setZoomDistance(
      static_cast<float>(kDistance * std::max(window.width() / kBreadth, window.height())));
  camera.setAzimuthDegrees(-90);
  camera.setElevationDegrees(89.9F);
  camera.setOrthogonal(true);
  scene.enableFollowCamera(true);  // SceneViewer3D takes it over when the file is opened
}

draw::Window windowOf(const gridmap::OccupancyRaster& map, const core::Trajectory& path) {
  draw::Window window = draw::windowOf(path);
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column)
      if (map.at(column, row) > gridmap::kOccupiedAbove)
        window.include(
            core::Point2{map.x_min_m + column * map.resolution_m, map.y_min_m + row * map.resolution_m});
  return draw::usable(window);
}

double lineWidth(const draw::Window& window) {
  return kLineShare * std::max(window.width(), window.height());
}

void insertGraph(COpenGLScene& scene, const graph::GraphSlam& slam, double line_m) {
  const auto& graph = slam.graph();
  std::vector<core::Point2> nodes;
  for (const auto& pose : graph.poses()) nodes.push_back(core::position(pose));
  std::vector<viewer::Connection> edges, loops;
  for (const auto& edge : graph.edges()) {
    if (!edge.on || edge.from == posegraph::kMap) continue;
    auto& list = edge.kind == posegraph::EdgeKind::kLoop ? loops : edges;
    list.emplace_back(nodes[static_cast<size_t>(edge.from)], nodes[static_cast<size_t>(edge.to)]);
  }
  insert(scene, viewer::graphLayer(nodes, edges, 0.7 * line_m), {}, 0.2 * line_m);
  if (!loops.empty()) insert(scene, viewer::loopsLayer(loops, line_m), {}, line_m);
}

/// From the ground up: what is transparent lets through only what was drawn before it. The wider the scene
/// is, the farther apart the layers lie, so that a viewer's depth buffer tells them apart when all of it is
/// looked at.
void stackLayers(COpenGLScene& scene, const draw::Window& window) {
  const double stretch = std::max(1.0, std::max(window.width(), window.height()) / kUnstretched_m);
  auto& viewport = *scene.getViewport("main");
  std::vector<viewer::Layer> layers(viewport.begin(), viewport.end());
  for (const auto& layer : layers) {
    auto pose = layer->getPose();
    viewer::place(layer, {pose.x, pose.y, pose.yaw});
    pose = layer->getPose();
    pose.z *= stretch;
    layer->setPose(pose);
  }
  std::stable_sort(layers.begin(), layers.end(),
                   [](const auto& a, const auto& b) { return a->getPose().z < b->getPose().z; });
  viewport.clear();
  for (const auto& layer : layers) scene.insert(layer);
}

}  // namespace

void writeScene(const mapping::MapBuilder& method, const gridmap::OccupancyRaster& map,
                const core::Trajectory& path, const lidar::Scan& last_scan, const std::string& file) {
  const auto window = windowOf(map, path);
  const double line_m = lineWidth(window);
  COpenGLScene scene;
  insertRaster(scene, viewer::mapLayer(map), {});
  if (const auto* graph = mapping::graphSlamOf(method)) insertGraph(scene, *graph, line_m);
  insert(scene, viewer::pathLayer(path, line_m), {}, line_m);
  if (!path.empty()) {
    insert(scene, viewer::scanLayer(last_scan), path.back().pose, 0.5 * line_m);
    insert(scene, viewer::robotLayer(kRobotSide_m, 0.5 * line_m), path.back().pose, line_m);
  }
  if (const auto particles = mapping::particlePoses(method); !particles.empty())
    insert(scene, viewer::particlesLayer(particles, 3 * line_m), {}, line_m);
  stackLayers(scene, window);
  lookAt(scene, window);
  save(scene, file);
}

void addTruthToScene(const core::Trajectory& truth, const world::Plan* plan, const core::Pose2& T_map_world,
                     const std::string& file) {
  files::requireReadableFile(file);
  COpenGLScene scene;
  try {
    files::doTried([&] {
      const files::MemoryGuard guard(files::fileHeadroomBytes(file));
      if (!scene.loadFromFile(file)) throw std::runtime_error("no scene");
    });
  } catch (const std::exception&) {
    throw core::InputError(file + ": is not a scene, expected MRPT's .3Dscene");
  }
  for (const char* name : {viewer::kPlanLayer, viewer::kTruthLayer})
    if (const auto old = scene.getByName(name)) scene.removeObject(old);
  draw::Window window;
  core::Trajectory truth_in_map;
  for (const auto& stamped : truth) truth_in_map.push_back({stamped.time_s, T_map_world * stamped.pose});
  window.include(draw::windowOf(truth_in_map));
  if (plan) {
    window.include(draw::windowOf(*plan, T_map_world * plan->T_frame_raster));
    insertRaster(scene, viewer::planLayer(*plan), T_map_world);
  }
  window = draw::usable(window);
  insert(scene, viewer::truthLayer(truth, lineWidth(window)), T_map_world, lineWidth(window));
  stackLayers(scene, window);
  lookAt(scene, window);
  save(scene, file);
}

}  // namespace slam::results

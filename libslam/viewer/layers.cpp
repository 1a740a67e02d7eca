#include "libslam/viewer/layers.h"

#include <mrpt/img/CImage.h>
#include <mrpt/opengl/CPointCloud.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/opengl/CTexturedPlane.h>

#include <array>
#include <cmath>
#include <cstring>

#include "libslam/draw/canvas.h"
#include "libslam/viewer/raster_image.h"
#include "libslam/viewer/shapes.h"

namespace slam::viewer {
namespace {

using draw::Colour;
using mrpt::opengl::CPointCloud;
using mrpt::opengl::CSetOfLines;
using mrpt::opengl::CSetOfObjects;
using mrpt::opengl::CTexturedPlane;

constexpr Colour kInk{30, 30, 30}, kGrey{130, 130, 130}, kWhite{255, 255, 255};
constexpr std::uint8_t kRayAlpha = 130;
constexpr std::uint8_t kEdgeAlpha = 60;
constexpr size_t kMostRays = 90;  // more would only be a blue area

/// The layers from the ground up; two heights each, the second for what lies on the first.
constexpr std::array<const char*, 13> kOrder = {
    kPlanLayer, kMapLayer,       kTruthLayer,  kGraphLayer,      kPathLayer,  kLoopsLayer,    kObstaclesLayer,
    kScanLayer, kStrategicLayer, kPeopleLayer, kCandidatesLayer, kRobotLayer, kParticlesLayer};
/// What the depth buffer tells apart when a whole building is looked at.
constexpr double kSheet_m = 0.02;

template <class Object>
std::shared_ptr<Object> named(std::shared_ptr<Object> object, const char* name) {
  object->setName(name);
  object->setPose(mrpt::poses::CPose3D(0, 0, heightOf(name), 0, 0, 0));
  return object;
}

/// Lighting off: a colour is to be the same wherever one looks from.
std::shared_ptr<Triangles> triangles(const char* name) {
  auto set = Triangles::Create();
  set->enableLight(false);
  return named(set, name);
}

mrpt::img::TColor colourOf(Colour colour, std::uint8_t alpha = 255) {
  return {colour.red, colour.green, colour.blue, alpha};
}

std::vector<core::Point2> placesOf(const core::Trajectory& path) {
  std::vector<core::Point2> places;
  places.reserve(path.size());
  for (const auto& stamped : path) places.push_back(core::position(stamped.pose));
  return places;
}

/// Of so many things every so-many-th makes no more than `most`.
size_t strideOf(size_t count, size_t most) {
  return std::max<size_t>(1, (count + most - 1) / most);
}

/// Over width_m x height_m from the origin; empty rasters give a plane without a picture.
std::shared_ptr<CTexturedPlane> sheet(const RasterImage& image, double resolution_m) {
  const double texel_m = resolution_m * image.reduction;
  auto plane = CTexturedPlane::Create(0.0F, static_cast<float>(texel_m * image.columns), 0.0F,
                                      static_cast<float>(texel_m * image.rows));
  if (image.texels.empty()) return plane;
  const auto width = static_cast<unsigned>(image.columns), height = static_cast<unsigned>(image.rows);
  mrpt::img::CImage colours(width, height, mrpt::img::CH_RGB), alphas(width, height, mrpt::img::CH_GRAY);
  for (unsigned row = 0; row < height; ++row) {
    auto* bgr = colours.ptrLine<std::uint8_t>(row);
    auto* alpha = alphas.ptrLine<std::uint8_t>(row);
    for (unsigned column = 0; column < width; ++column) {
      const Texel& texel = image.texels[static_cast<size_t>(row) * width + column];
      std::uint8_t* pixel = bgr + 3 * static_cast<size_t>(column);
      pixel[0] = texel.blue, pixel[1] = texel.green, pixel[2] = texel.red;
      alpha[column] = texel.alpha;
    }
  }
  plane->assignImage(colours, alphas);
  return plane;
}

Texel lookOf(world::Material material) {
  switch (material) {
    case world::Material::kGlass:
      return {draw::kSkyBlue.red, draw::kSkyBlue.green, draw::kSkyBlue.blue};
    case world::Material::kMirror:
      return {draw::kPurple.red, draw::kPurple.green, draw::kPurple.blue};
    case world::Material::kDark:
      return {0, 0, 0};
    case world::Material::kPlain:
      break;
  }
  return {150, 150, 155};
}

}  // namespace

const std::vector<LayerSwitch>& layerSwitches() {
  static const std::vector<LayerSwitch> switches = {{'1', {kPlanLayer}},
                                                    {'2', {kMapLayer}},
                                                    {'3', {kTruthLayer}},
                                                    {'4', {kPathLayer}},
                                                    {'5', {kGraphLayer, kLoopsLayer}},
                                                    {'6', {kObstaclesLayer}},
                                                    {'7', {kScanLayer}},
                                                    {'8', {kCandidatesLayer, kStrategicLayer}},
                                                    {'9', {kParticlesLayer}},
                                                    {'0', {kPeopleLayer}}};
  return switches;
}

double heightOf(const char* name) {
  for (size_t i = 0; i < kOrder.size(); ++i)
    if (std::strcmp(kOrder[i], name) == 0) return 2 * kSheet_m * static_cast<double>(i);
  return 0;
}

void place(const Layer& layer, const core::Pose2& T_scene_layer) {
  layer->setPose(mrpt::poses::CPose3D(T_scene_layer.x, T_scene_layer.y, heightOf(layer->getName().c_str()),
                                      T_scene_layer.phi, 0, 0));
}

Layer planLayer(const world::Plan& plan) {
  const auto image = rasterImage(plan.columns, plan.rows, [&plan](int column, int row) -> CellLook {
    switch (plan.at(column, row)) {
      case world::Cell::kFree:
        return {{226, 228, 232}, 1};
      case world::Cell::kUnknown:
        return {{205, 205, 208}, 0};
      case world::Cell::kOccupied:
        break;
    }
    const auto cell =
        static_cast<size_t>(row) * static_cast<size_t>(plan.columns) + static_cast<size_t>(column);
    return {lookOf(plan.materials.empty() ? world::Material::kPlain : plan.materials[cell]), 2};
  });
  // The outer object has the layer's place, the inner one the plan's in the world.
  auto plane = sheet(image, plan.resolution_m);
  const auto& T_world_plan = plan.T_frame_raster;
  plane->setPose(mrpt::poses::CPose3D(T_world_plan.x, T_world_plan.y, 0, T_world_plan.phi, 0, 0));
  auto layer = named(CSetOfObjects::Create(), kPlanLayer);
  layer->insert(plane);
  return layer;
}

Layer mapLayer(const gridmap::OccupancyRaster& map) {
  const auto image = rasterImage(map.columns, map.rows, [&map](int column, int row) -> CellLook {
    const float occupied = map.at(column, row);
    if (!(occupied > gridmap::kOccupiedAbove || occupied < gridmap::kFreeBelow)) return {{0, 0, 0, 0}, 0};
    // Certain cells hide the plan, those that were seen once let it shine through.
    const float certainty = 2 * std::abs(occupied - 0.5F);
    const auto alpha = static_cast<std::uint8_t>(std::lround(190 + 65 * certainty));
    const Colour colour = occupied > 0.5F ? kInk : kWhite;
    return {{colour.red, colour.green, colour.blue, alpha}, occupied > 0.5F ? 2 + certainty : 1};
  });
  auto plane = sheet(image, map.resolution_m);
  plane->setPose(mrpt::poses::CPose3D(map.x_min_m, map.y_min_m, 0, 0, 0, 0));
  auto layer = named(CSetOfObjects::Create(), kMapLayer);
  layer->insert(plane);
  return layer;
}

Layer robotLayer(double side_m, double line_m) {
  const double half = side_m / 2, radius_m = std::sqrt(2.0) * half;
  auto layer = triangles(kRobotLayer);
  addDisc(*layer, {0, 0}, radius_m, 0, draw::kVermillion, 60);
  addRing(*layer, {0, 0}, radius_m, line_m, kSheet_m / 3, draw::kVermillion);
  addPolygon(*layer, {{half, half}, {-half, half}, {-half, -half}, {half, -half}}, 2 * kSheet_m / 3,
             draw::kVermillion);
  addTriangle(*layer, {0.85 * half, 0}, {-0.6 * half, 0.45 * half}, {-0.6 * half, -0.45 * half}, kSheet_m,
              kWhite);
  return layer;
}

Layer scanLayer(const lidar::Scan& scan) {
  auto layer = named(CSetOfObjects::Create(), kScanLayer);
  auto rays = CSetOfLines::Create();
  rays->setColor_u8(colourOf(draw::kSkyBlue, kRayAlpha));
  auto returns = CPointCloud::Create();
  returns->setPointSize(3);
  returns->enableVariablePointSize(false);
  returns->setColor_u8(colourOf(draw::kVermillion));
  const auto& from = scan.T_robot_lidar;
  const auto points = lidar::scanPoints(scan);
  const size_t stride = 1 + points.size() / kMostRays;
  for (size_t i = 0; i < points.size(); ++i) {
    const auto& p = points[i];
    if (i % stride == 0) rays->appendLine(from.x, from.y, 0, p.x, p.y, 0);
    returns->insertPoint(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(kSheet_m));
  }
  layer->insert(rays);
  layer->insert(returns);
  return layer;
}

Layer pathLayer(const core::Trajectory& path, double line_m) {
  auto layer = triangles(kPathLayer);
  addPolyline(*layer, placesOf(path), line_m, 0, draw::kBlue);
  return layer;
}

Layer truthLayer(const core::Trajectory& path, double line_m) {
  auto layer = triangles(kTruthLayer);
  addPolyline(*layer, placesOf(path), 2.5 * line_m, 0, kGrey, 150);
  return layer;
}

Layer peopleLayer(const std::vector<Body>& people) {
  auto layer = triangles(kPeopleLayer);
  for (const auto& body : people) addDisc(*layer, body.place, body.radius_m, 0, kInk, 200);
  return layer;
}

Layer particlesLayer(const std::vector<core::Pose2>& particles, double length_m) {
  auto layer = triangles(kParticlesLayer);
  for (const auto& T_map_robot : particles)
    addTriangle(*layer, T_map_robot * core::Point2{length_m, 0},
                T_map_robot * core::Point2{-0.3 * length_m, 0.3 * length_m},
                T_map_robot * core::Point2{-0.3 * length_m, -0.3 * length_m}, 0, draw::kPurple, 200);
  return layer;
}

Layer graphLayer(const std::vector<core::Point2>& nodes, const std::vector<Connection>& edges,
                 double line_m) {
  // There are many edges, and most of them short: as thin lines they do not hide what they tie.
  auto layer = named(CSetOfObjects::Create(), kGraphLayer);
  auto lines = CSetOfLines::Create();
  lines->setColor_u8(colourOf(draw::kGreen, kEdgeAlpha));
  for (size_t i = 0; i < edges.size(); i += strideOf(edges.size(), kMostEdges)) {
    const auto& [from, to] = edges[i];
    lines->appendLine(from.x, from.y, 0, to.x, to.y, 0);
  }
  auto dots = Triangles::Create();
  dots->enableLight(false);
  for (size_t i = 0; i < nodes.size(); i += strideOf(nodes.size(), kMostDots))
    addDisc(*dots, nodes[i], line_m, kSheet_m, draw::kGreen);
  layer->insert(lines);
  layer->insert(dots);
  return layer;
}

Layer loopsLayer(const std::vector<Connection>& loops, double line_m) {
  auto layer = triangles(kLoopsLayer);
  for (const auto& [from, to] : loops) {
    addLine(*layer, from, to, line_m, 0, draw::kOrange);
    for (const auto& end : {from, to}) addDisc(*layer, end, 1.5 * line_m, 0, draw::kOrange);
  }
  return layer;
}

Layer obstaclesLayer(const LocalObstacles& obstacles, double radius_m) {
  auto layer = triangles(kObstaclesLayer);
  for (const auto& p : obstacles.remembered) addDisc(*layer, p, radius_m, 0, draw::kBlue);
  for (const auto& p : obstacles.seen) addDisc(*layer, p, radius_m, 0, draw::kVermillion);
  return layer;
}

Layer strategicLayer(const StrategicView& view, double line_m) {
  constexpr int kDashes = 12, kPieces = 4;
  auto layer = triangles(kStrategicLayer);
  for (const auto& p : view.projected) {
    addLine(*layer, {0, 0}, p, line_m, 0, draw::kGreen);
    addDisc(*layer, p, 2 * line_m, kSheet_m / 2, draw::kGreen);
  }
  for (int i = 0; i < kDashes; ++i) {
    std::vector<core::Point2> dash;
    for (int j = 0; j <= kPieces; ++j) {
      const double angle_rad = 2 * core::kPi * (i + 0.5 * j / kPieces) / kDashes;
      dash.push_back(core::polar(view.stop_radius_m, angle_rad));
    }
    addPolyline(*layer, dash, line_m, kSheet_m, kInk);
  }
  return layer;
}

Layer candidatesLayer(const Candidates& candidates, double radius_m, double line_m) {
  auto layer = triangles(kCandidatesLayer);
  addPolyline(*layer, candidates.path, 2 * line_m, 0, kInk);
  addPolyline(*layer, candidates.path, line_m, kSheet_m / 4, draw::kYellow);
  for (const auto& p : candidates.places) {
    addDisc(*layer, p, 0.7 * radius_m, kSheet_m / 2, draw::kYellow);
    addRing(*layer, p, 0.7 * radius_m, 0.25 * radius_m, kSheet_m, kInk);
  }
  addDisc(*layer, candidates.goal, 1.3 * radius_m, kSheet_m / 2, draw::kYellow);
  addRing(*layer, candidates.goal, 1.3 * radius_m, 0.4 * radius_m, kSheet_m, kInk);
  return layer;
}

}  // namespace slam::viewer

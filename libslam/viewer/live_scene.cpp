#include "libslam/viewer/live_scene.h"

#include <mrpt/img/CImage.h>
#include <mrpt/opengl/CFBORender.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/robot/drive.h"

namespace slam::viewer {
namespace {

constexpr const char *kMainViewport = "main", *kPanelViewport = "panel", *kScaleViewport = "scale";
constexpr double kAir = 0.05;          // around what is looked at, as a share of it
constexpr double kLinePixels = 2.2;    // width of lines when the whole area is looked at
constexpr double kScalePixels = 110;   // about so long is the bar of the scale
constexpr double kScaleMargin = 10;    // from the corner
constexpr double kSmallestArea_m = 8;  // a map that has only begun
// Of the camera's distance. Some depth buffers have 16 bits, and the sheets of a scene lie close together.
constexpr double kNearest = 0.01, kFarthest = 3;

/// Shows what there is at least this large.
draw::Window atLeast(draw::Window area, double side_m) {
  const core::Point2 centre{(area.x0 + area.x1) / 2, (area.y0 + area.y1) / 2};
  const double half_x = std::max(side_m, area.width()) / 2, half_y = std::max(side_m, area.height()) / 2;
  return {centre.x - half_x, centre.y - half_y, centre.x + half_x, centre.y + half_y};
}

draw::Window areaOf(const world::Plan& plan) {
  draw::Window area;
  for (const core::Point2 corner :
       {core::Point2{0, 0}, core::Point2{1.0 * plan.columns, 0}, core::Point2{0, 1.0 * plan.rows},
        core::Point2{1.0 * plan.columns, 1.0 * plan.rows}})
    area.include(world::cellsToPoint(plan, corner));
  return area;
}

mrpt::img::CImage imageOf(const std::string& png) {
  const cv::Mat bytes(1, static_cast<int>(png.size()), CV_8UC1, const_cast<char*>(png.data()));
  return {cv::imdecode(bytes, cv::IMREAD_COLOR), mrpt::img::DEEP_COPY};
}

}  // namespace

Camera cameraOver(const draw::Window& area, const WindowSize& size) {
  const double width = std::max(1, size.sceneWidth()), height = std::max(1, size.height);
  const double pixels_per_m = std::min(width / area.width(), height / area.height()) / (1 + 2 * kAir);
  Camera camera;
  camera.centre = {(area.x0 + area.x1) / 2, (area.y0 + area.y1) / 2};
  camera.zoom_m = 2 * std::min(width, height) / pixels_per_m;
  return camera;
}

draw::Pixel pixelOf(const core::Point2& p_scene, const Camera& camera, const WindowSize& size) {
  const double width = size.sceneWidth(), height = size.height;
  const double pixels_per_m = 2 * std::min(width, height) / camera.zoom_m;
  return {width / 2 + pixels_per_m * (p_scene.x - camera.centre.x),
          height / 2 - pixels_per_m * (p_scene.y - camera.centre.y)};
}

std::optional<core::Point2> placeAt(const draw::Pixel& pixel, const Camera& camera, const WindowSize& size,
                                    double height_m) {
  constexpr double kFlattest = 0.05;
  const double width = size.sceneWidth(), height = size.height;
  const double azimuth_rad = core::degToRad(camera.azimuth_deg);
  const double elevation_rad = core::degToRad(camera.elevation_deg);
  const double steepness = core::sin(elevation_rad);
  if (steepness < kFlattest) return std::nullopt;
  const double m_per_pixel = camera.zoom_m / (2 * std::min(width, height));
  const double right_m = (pixel.x - width / 2) * m_per_pixel;
  // What lies farther away on the floor is higher up in the picture, the less so the flatter the camera
  // looks.
  const double up_m = (height / 2 - pixel.y) * m_per_pixel;
  const double away_m = (up_m - height_m * core::cos(elevation_rad)) / steepness;
  const auto [s, c] = core::sinCos(azimuth_rad);
  return core::Point2{camera.centre.x - s * right_m - c * away_m, camera.centre.y + c * right_m - s * away_m};
}

LiveScene::LiveScene(const world::Plan* plan, double robot_side_m, const WindowSize& size)
    : scene_(mrpt::opengl::COpenGLScene::Create()), size_(size), robot_side_m_(robot_side_m) {
  scene_->createViewport(kPanelViewport)->setCustomBackgroundColor({0.97F, 0.97F, 0.97F});
  auto main = scene_->getViewport(kMainViewport);
  main->setCustomBackgroundColor({0.8F, 0.81F, 0.82F});
  scene_->createViewport(kScaleViewport);
  panel_.robot_side_m = robot_side_m;
  if (plan) {
    plan_area_ = areaOf(*plan);
    setLayer(kPlanLayer, planLayer(*plan));
  }
  layOut();
}

draw::Window LiveScene::area() const {
  if (!plan_area_.isEmpty()) return plan_area_;
  draw::Window area;
  if (shown_.map) {
    const auto& map = *shown_.map;
    const double x1 = map.x_min_m + map.columns * map.resolution_m,
                 y1 = map.y_min_m + map.rows * map.resolution_m;
    for (const core::Point2 corner : {core::Point2{map.x_min_m, map.y_min_m}, core::Point2{x1, map.y_min_m},
                                      core::Point2{map.x_min_m, y1}, core::Point2{x1, y1}})
      area.include(shown_.T_scene_map * corner);
  }
  for (const auto& stamped : shown_.path) area.include(shown_.T_scene_map * core::position(stamped.pose));
  for (const auto& stamped : shown_.truth) area.include(core::position(stamped.pose));
  area.include(robotPlace());
  return atLeast(area, kSmallestArea_m);
}

core::Point2 LiveScene::robotPlace() const {
  return core::position(shown_.T_scene_truth ? *shown_.T_scene_truth
                                             : shown_.T_scene_map * shown_.T_map_robot);
}

void LiveScene::setLayer(const char* name, const Layer& layer) {
  auto main = scene_->getViewport(kMainViewport);
  if (const auto old = main->getByName(name)) main->removeObject(old);
  if (!layer) return;
  layer->setVisibility(!isHidden(name));
  main->insert(layer);
}

void LiveScene::show(const Snapshot& snapshot, const PanelState& panel) {
  const bool is_new_map = snapshot.map != shown_.map;
  shown_ = snapshot;
  const auto all = area();
  line_m_ = std::max(all.width(), all.height()) * kLinePixels / std::max(1, size_.sceneWidth());
  const core::Pose2 T_scene_robot =
      snapshot.T_scene_truth ? *snapshot.T_scene_truth : snapshot.T_scene_map * snapshot.T_map_robot;
  const auto set = [this](const char* name, bool is_there, const core::Pose2& T_scene_layer,
                          const auto& make) {
    const Layer layer = is_there ? make() : nullptr;
    if (layer) place(layer, T_scene_layer);
    setLayer(name, layer);
  };
  const auto& T_scene_map = snapshot.T_scene_map;
  // What is transparent lets through what was drawn before it, so the order is that of the heights; only the
  // map is costly.
  if (is_new_map)
    set(kMapLayer, snapshot.map != nullptr, T_scene_map, [&] { return mapLayer(*snapshot.map); });
  set(kTruthLayer, snapshot.truth.size() > 1, {}, [&] { return truthLayer(snapshot.truth, line_m_); });
  set(kGraphLayer, !snapshot.nodes.empty(), T_scene_map,
      [&] { return graphLayer(snapshot.nodes, snapshot.edges, 0.7 * line_m_); });
  set(kPathLayer, snapshot.path.size() > 1, T_scene_map, [&] { return pathLayer(snapshot.path, line_m_); });
  set(kLoopsLayer, !snapshot.loops.empty(), T_scene_map,
      [&] { return loopsLayer(snapshot.loops, 1.5 * line_m_); });
  set(kObstaclesLayer, snapshot.obstacles.has_value(), T_scene_robot,
      [&] { return obstaclesLayer(*snapshot.obstacles, 0.8 * line_m_); });
  set(kScanLayer, true, T_scene_robot, [&] { return scanLayer(snapshot.scan); });
  set(kStrategicLayer, snapshot.strategic.has_value(), T_scene_robot,
      [&] { return strategicLayer(*snapshot.strategic, line_m_); });
  set(kPeopleLayer, !snapshot.people.empty(), {}, [&] { return peopleLayer(snapshot.people); });
  set(kCandidatesLayer, snapshot.candidates.has_value(), T_scene_map,
      [&] { return candidatesLayer(*snapshot.candidates, 3 * line_m_, line_m_); });
  set(kRobotLayer, true, T_scene_robot, [&] { return robotLayer(robot_side_m_, line_m_); });
  set(kParticlesLayer, !snapshot.particles.empty(), T_scene_map,
      [&] { return particlesLayer(snapshot.particles, 4 * line_m_); });
  setPanel(panel);
}

void LiveScene::setPanel(const PanelState& state) {
  panel_ = state;
  panel_.robot_side_m = robot_side_m_;
  panel_.hidden = hidden_;
  drawPanel();
}

void LiveScene::hide(const std::string& keys) {
  hidden_ = keys;
  auto main = scene_->getViewport(kMainViewport);
  for (const auto& one : layerSwitches())
    for (const char* name : one.layers)
      if (const auto layer = main->getByName(name)) layer->setVisibility(!isHidden(name));
  setPanel(panel_);
}

bool LiveScene::isHidden(const std::string& layer) const {
  for (const auto& one : layerSwitches())
    for (const char* name : one.layers)
      if (layer == name) return hidden_.find(one.key) != std::string::npos;
  return false;
}

void LiveScene::resize(const WindowSize& size) {
  size_ = size;
  layOut();
  drawPanel();
}

void LiveScene::setDepth(double zoom_m) {
  scene_->getViewport(kMainViewport)
      ->setViewportClipDistances(static_cast<float>(kNearest * zoom_m),
                                 static_cast<float>(kFarthest * zoom_m));
  zoom_m_ = zoom_m;
  drawScale();
}

void LiveScene::layOut() {
  const double scene_width = std::max(2, size_.sceneWidth()), height = std::max(2, size_.height);
  scene_->getViewport(kMainViewport)->setViewportPosition(0, 0, scene_width, height);
  scene_->getViewport(kPanelViewport)->setViewportPosition(scene_width, 0, kPanelWidth, height);
}

void LiveScene::drawScale() {
  if (!(zoom_m_ > 0)) return;
  const double pixels_per_m = 2.0 * std::min(std::max(2, size_.sceneWidth()), size_.height) / zoom_m_;
  const double scale_m = draw::niceStep(kScalePixels / pixels_per_m);
  const double pixels = scale_m * pixels_per_m;
  if (scale_m == scale_m_ && pixels == scale_pixels_) return;
  scale_m_ = scale_m, scale_pixels_ = pixels;
  const std::string png = scaleBar(scale_m, pixels);
  const auto image = imageOf(png);
  auto viewport = scene_->getViewport(kScaleViewport);
  viewport->setViewportPosition(kScaleMargin, kScaleMargin, static_cast<double>(image.getWidth()),
                                static_cast<double>(image.getHeight()));
  viewport->setImageView(image);
}

void LiveScene::drawPanel() {
  scene_->getViewport(kPanelViewport)
      ->setImageView(imageOf(sidePanel(shown_, panel_, std::max(2, size_.height))));
}

std::string renderPng(LiveScene& scene, const Camera& camera) {
  scene.setDepth(camera.zoom_m);
  mrpt::opengl::CCamera eye;
  eye.setPointingAt(static_cast<float>(camera.centre.x), static_cast<float>(camera.centre.y), 0);
  eye.setZoomDistance(static_cast<float>(camera.zoom_m));
  eye.setAzimuthDegrees(static_cast<float>(camera.azimuth_deg));
  eye.setElevationDegrees(static_cast<float>(camera.elevation_deg));
  eye.setOrthogonal(true);
  mrpt::img::CImage image;
  try {
    mrpt::opengl::CFBORender renderer(static_cast<unsigned>(scene.size().width),
                                      static_cast<unsigned>(scene.size().height));
    renderer.setCamera(*scene.scene(), eye);
    renderer.render_RGB(*scene.scene(), image);
  } catch (const std::exception&) {
    throw core::IoError(
        "cannot render without a window: EGL gives no context (Debian: apt install libegl-mesa0)");
  }
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", image.asCvMatRef(), bytes))
    throw core::IoError("a picture cannot be encoded as PNG");
  return {bytes.begin(), bytes.end()};
}

}  // namespace slam::viewer

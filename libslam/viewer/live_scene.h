#pragma once
#include <mrpt/opengl/COpenGLScene.h>

#include <memory>
#include <optional>
#include <string>

#include "libslam/draw/map_view.h"
#include "libslam/viewer/side_panel.h"
#include "libslam/viewer/snapshot.h"
#include "libslam/world/plan.h"

namespace slam::viewer {

/// Looks at a flat scene; angles as MRPT has them.
struct Camera {
  core::Point2 centre;
  double zoom_m =
      40;  ///< MRPT's distance: a view without perspective shows zoom_m / 2 along the shorter side
  double azimuth_deg = -90, elevation_deg = 90;  ///< from above, x to the right
};

/// Size of a window, pixels.
struct WindowSize {
  int width = 1280, height = 800;
  int sceneWidth() const { return width - kPanelWidth; }
};

/// The camera that shows all of a rectangle from above.
Camera cameraOver(const draw::Window& area, const WindowSize& size);
/// Where that camera shows a point, without perspective and from above: pixels from the window's upper left
/// corner.
draw::Pixel pixelOf(const core::Point2& p_scene, const Camera& camera, const WindowSize& size);

/// The other way round, from whichever side the camera looks: the place of what stands at a pixel, height_m
/// above the floor (a layer's: heightOf()). nullopt where the camera looks along the floor.
std::optional<core::Point2> placeAt(const draw::Pixel& pixel, const Camera& camera, const WindowSize& size,
                                    double height_m = 0);

/// The scene of a live window: the layers in the viewport "main", over its lower left corner the bar of the
/// scale in "scale", the side panel in "panel". Nothing here needs a display.
/// Not to be changed while another thread renders it.
class LiveScene {
 public:
  /// `plan`: the true one, nullptr when it is not known. The scene frame is then the map's, which grows.
  LiveScene(const world::Plan* plan, double robot_side_m, const WindowSize& size);

  /// Shows a moment. Layers that are the same as before stay (the map by its pointer); what the moment has
  /// not is taken out.
  void show(const Snapshot& snapshot, const PanelState& panel);
  void setPanel(const PanelState& state);
  /// Which layers are not drawn: keys of layerSwitches(), in any order. What is not shown is still there.
  void hide(const std::string& keys);
  void resize(const WindowSize& size);
  /// Fits the depth buffer and the bar of the scale to a camera; owed before the scene is rendered by it.
  void setDepth(double zoom_m);

  const WindowSize& size() const { return size_; }
  /// All that is worth seeing: the plan, else the map and the path so far, and the robot.
  draw::Window area() const;
  /// Where the robot is: truly, or as estimated.
  core::Point2 robotPlace() const;
  const mrpt::opengl::COpenGLScene::Ptr& scene() const { return scene_; }

 private:
  void setLayer(const char* name, const Layer& layer);
  void drawPanel();
  void drawScale();
  bool isHidden(const std::string& layer) const;
  void layOut();

  mrpt::opengl::COpenGLScene::Ptr scene_;
  WindowSize size_;
  double robot_side_m_;
  draw::Window plan_area_;
  double line_m_ = 0.05;
  double zoom_m_ = 0, scale_m_ = 0, scale_pixels_ = 0;
  std::string hidden_;  ///< keys of layerSwitches()
  PanelState panel_;
  Snapshot shown_;
};

/// Renders a scene without a window, as PNG. Needs EGL, as Mesa has it, and no display. Errors: IoError when
/// there is none.
std::string renderPng(LiveScene& scene, const Camera& camera);

}  // namespace slam::viewer

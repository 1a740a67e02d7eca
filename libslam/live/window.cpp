#include "libslam/live/window.h"

#include <mrpt/gui/CDisplayWindowGUI.h>  // and GLFW, in the order that OpenGL needs

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/core/parameters.h"

namespace slam::live {
namespace {

constexpr int kRefresh_ms = 33;
constexpr double kLeastShare = 0.125;

/// Where the camera looks, until someone moves it by the mouse.
class CameraMan {
 public:
  explicit CameraMan(mrpt::gui::CGlCanvasBase& canvas) : canvas_(canvas) {
    canvas_.setCameraProjective(false);
  }

  void showAll() { shows_all_ = true, follows_ = false, is_set_ = false; }
  void toggleFollow() { follows_ = !follows_, shows_all_ = false; }

  void look(viewer::LiveScene& scene) {
    if (shows_all_ && is_set_ && wasMoved()) shows_all_ = false;
    if (shows_all_) set(viewer::cameraOver(scene.area(), scene.size()));
    scene.setDepth(static_cast<double>(canvas_.getZoomDistance()));
    if (!follows_) return;
    const auto robot = scene.robotPlace();
    canvas_.setCameraPointing(static_cast<float>(robot.x), static_cast<float>(robot.y), 0);
  }

 private:
  void set(const viewer::Camera& camera) {
    canvas_.setCameraPointing(static_cast<float>(camera.centre.x), static_cast<float>(camera.centre.y), 0);
    canvas_.setZoomDistance(static_cast<float>(camera.zoom_m));
    canvas_.setAzimuthDegrees(static_cast<float>(camera.azimuth_deg));
    canvas_.setElevationDegrees(static_cast<float>(camera.elevation_deg));
    last_ = camera;
    is_set_ = true;
  }
  bool wasMoved() const {
    const auto differs = [](float is, double was) { return std::abs(static_cast<double>(is) - was) > 1e-3; };
    return differs(canvas_.getCameraPointingX(), last_.centre.x) ||
           differs(canvas_.getCameraPointingY(), last_.centre.y) ||
           differs(canvas_.getZoomDistance(), last_.zoom_m) ||
           differs(canvas_.getAzimuthDegrees(), last_.azimuth_deg) ||
           differs(canvas_.getElevationDegrees(), last_.elevation_deg);
  }

  mrpt::gui::CGlCanvasBase& canvas_;
  viewer::Camera last_;
  bool shows_all_ = true, follows_ = false, is_set_ = false;
};

class LiveWindow {
 public:
  LiveWindow(Stage& stage, viewer::LiveScene& scene, const WindowOptions& options)
      : stage_(stage),
        scene_(scene),
        options_(options),
        hands_(options.hands),
        window_(options.title, static_cast<unsigned>(scene.size().width),
                static_cast<unsigned>(scene.size().height)),
        camera_(window_.camera()) {
    window_.background_scene = scene.scene();
    window_.addKeyboardCallback([this](int key, int scancode, int action, int modifiers) {
      return onKey(key, scancode, action, modifiers);
    });
    window_.addLoopCallback([this] { refresh(); });
    window_.performLayout();
    refresh();
    window_.drawAll();
    window_.setVisible(true);
  }

 private:
  bool onKey(int key, int scancode, int action, int modifiers) {
    const bool is_down = action != GLFW_RELEASE;
    if (hands_ == Hands::kDrive && holdKey(key, is_down)) return true;
    if (!is_down) return true;
    if ((modifiers & (GLFW_MOD_CONTROL | GLFW_MOD_ALT)) != 0) return false;
    if (key == GLFW_KEY_ESCAPE) return onSymbol('q');
    if (key == GLFW_KEY_SPACE) return onSymbol(' ');
    if (key == GLFW_KEY_RIGHT) return onSymbol('n');
    // The letter on the key, whatever the keyboard's layout.
    const char* name = glfwGetKeyName(key, scancode);
    return name != nullptr && onSymbol(name[0]);
  }

  bool onSymbol(char symbol) {
    switch (symbol) {
      case 'q':
        window_.setVisible(false);
        return true;
      case ' ':
        stage_.change([](Playback& playback) { playback.togglePause(); });
        return true;
      case 'n':
        stage_.change([](Playback& playback) { playback.stepOnce(); });
        return true;
      case '+':
      case '=':  // the same key on many keyboards
        changeSpeed(true);
        return true;
      case '-':
        changeSpeed(false);
        return true;
      case 'f':
        camera_.toggleFollow();
        return true;
      case 'a':
        camera_.showAll();
        return true;
      case 'h':
        shows_keys_ = !shows_keys_;
        return true;
      default:
        return false;
    }
  }

  bool holdKey(int key, bool is_down) {
    bool* held = key == GLFW_KEY_UP      ? &keys_.ahead
                 : key == GLFW_KEY_DOWN  ? &keys_.back
                 : key == GLFW_KEY_LEFT  ? &keys_.left
                 : key == GLFW_KEY_RIGHT ? &keys_.right
                                         : nullptr;
    if (held == nullptr) return false;
    *held = is_down;
    stage_.setKeys(keys_);
    return true;
  }

  void changeSpeed(bool faster) {
    if (hands_ == Hands::kDrive) {
      keys_.share = faster ? std::min(1.0, 2 * keys_.share) : std::max(kLeastShare, keys_.share / 2);
      stage_.setKeys(keys_);
      return;
    }
    stage_.change([faster](Playback& playback) { faster ? playback.faster() : playback.slower(); });
  }

  std::string playbackText() const {
    std::string text = stage_.playbackText();
    if (hands_ != Hands::kDrive) return text;
    const std::string share = core::formatNumber(100 * keys_.share) + " % speed";
    return text == "paused" || text == "finished" ? text : "arrows drive at " + share;
  }

  void refresh() {
    const bool is_over = options_.close_at_end && stage_.isFinished();
    if (is_over || stage_.isClosed() || (options_.interrupted && options_.interrupted()))
      window_.setVisible(false);
    const viewer::WindowSize size = {window_.size().x(), window_.size().y()};
    const std::lock_guard lock(window_.background_scene_mtx);
    if (size.width != scene_.size().width || size.height != scene_.size().height) scene_.resize(size);
    viewer::PanelState panel;
    panel.playback = playbackText();
    if (shows_keys_) panel.keys = keysOf(hands_);
    const auto snapshot = stage_.take();
    if (snapshot)
      scene_.show(*snapshot, panel);
    else if (panel.playback != shown_.playback || panel.keys.size() != shown_.keys.size())
      scene_.setPanel(panel);
    shown_ = panel;
    camera_.look(scene_);
  }

  Stage& stage_;
  viewer::LiveScene& scene_;
  const WindowOptions& options_;
  Hands hands_;
  mrpt::gui::CDisplayWindowGUI window_;
  CameraMan camera_;
  HeldKeys keys_;
  bool shows_keys_ = false;
  viewer::PanelState shown_;
};

}  // namespace

std::vector<viewer::KeyHelp> keysOf(Hands hands) {
  std::vector<viewer::KeyHelp> keys;
  if (hands == Hands::kDrive)
    keys = {{"arrows", "drive and turn"}, {"+  -", "drive faster, slower"}};
  else
    keys = {{"n  right", "one step"}, {"+  -", "faster, slower"}};
  keys.insert(keys.begin(), {"space", "pause, go on"});
  for (const viewer::KeyHelp& key : {viewer::KeyHelp{"f", "follow the robot"},
                                     {"a", "show all, from above"},
                                     {"h", "keys or colours"},
                                     {"q  Esc", hands == Hands::kDrive ? "save and end" : "end"},
                                     {"wheel", "zoom"},
                                     {"left drag", "turn the view"},
                                     {"right drag", "shift the view"}})
    keys.push_back(key);
  return keys;
}

void requireDisplay() {
  glfwSetErrorCallback([](int, const char*) {});  // the exception says it
  if (glfwInit() != GLFW_TRUE)
    throw core::IoError(
        "no window can be opened: there is no display (is DISPLAY set?); --screenshot needs none");
}

void showWindow(Stage& stage, viewer::LiveScene& scene, const WindowOptions& options) {
  requireDisplay();
  nanogui::init();
  try {
    LiveWindow window(stage, scene, options);
    nanogui::mainloop(kRefresh_ms);
  } catch (const std::exception& error) {
    stage.close();
    nanogui::shutdown();
    throw core::IoError(std::string("the window failed: ") + error.what());
  }
  stage.close();
  nanogui::shutdown();
}

}  // namespace slam::live

#include "libslam/live/window.h"

#include <mrpt/gui/CDisplayWindowGUI.h>  // and GLFW, in the order that OpenGL needs

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <optional>

#include "libslam/core/error.h"
#include "libslam/files/parameters.h"
#include "libslam/live/command_line.h"
#include "libslam/live/robot_drag.h"

namespace slam::live {
namespace {

constexpr int kRefresh_ms = 33;
constexpr double kLeastShare = 0.125;
constexpr double kGrip_pixels = 12;  // a small robot can be taken hold of from so far

/// Where the camera looks, until someone moves it by the mouse.
class CameraMan {
 public:
  explicit CameraMan(mrpt::gui::CGlCanvasBase& canvas) : canvas_(canvas) {
    canvas_.setCameraProjective(false);
  }

  void showAll() { shows_all_ = true, follows_ = false, is_set_ = false; }
  void toggleFollow() { follows_ = !follows_, shows_all_ = false; }

  viewer::Camera now() const {
    return {{static_cast<double>(canvas_.getCameraPointingX()),
             static_cast<double>(canvas_.getCameraPointingY())},
            static_cast<double>(canvas_.getZoomDistance()),
            static_cast<double>(canvas_.getAzimuthDegrees()),
            static_cast<double>(canvas_.getElevationDegrees())};
  }

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

/// MRPT's window, with the events that it keeps for itself.
class EventWindow : public mrpt::gui::CDisplayWindowGUI {
 public:
  using CDisplayWindowGUI::CDisplayWindowGUI;
  std::function<bool(const nanogui::Vector2i& p, bool down, int modifiers)> on_left_button;
  std::function<bool(const nanogui::Vector2i& p, int modifiers)> on_motion;
  std::function<bool(unsigned codepoint)> on_character;

 protected:
  bool mouseButtonEvent(const nanogui::Vector2i& p, int button, bool down, int modifiers) override {
    if (button == GLFW_MOUSE_BUTTON_LEFT && on_left_button && on_left_button(p, down, modifiers)) return true;
    return CDisplayWindowGUI::mouseButtonEvent(p, button, down, modifiers);
  }
  bool mouseMotionEvent(const nanogui::Vector2i& p, const nanogui::Vector2i& rel, int button,
                        int modifiers) override {
    if (on_motion && on_motion(p, modifiers)) return true;
    return CDisplayWindowGUI::mouseMotionEvent(p, rel, button, modifiers);
  }
  bool keyboardCharacterEvent(unsigned codepoint) override {
    return (on_character && on_character(codepoint)) || CDisplayWindowGUI::keyboardCharacterEvent(codepoint);
  }
};

class LiveWindow {
 public:
  LiveWindow(Stage& stage, viewer::LiveScene& scene, const WindowOptions& options)
      : stage_(stage),
        scene_(scene),
        options_(options),
        hands_(options.hands),
        window_("rasterslam", static_cast<unsigned>(scene.size().width),
                static_cast<unsigned>(scene.size().height)),
        camera_(window_.camera()) {
    window_.background_scene = scene.scene();
    window_.addKeyboardCallback([this](int key, int scancode, int action, int modifiers) {
      return onKey(key, scancode, action, modifiers);
    });
    if (hands_ == Hands::kDrive) listenToTheDriver();
    window_.addLoopCallback([this] { refresh(); });
    window_.performLayout();
    refresh();
    window_.drawAll();
    window_.setVisible(true);
  }

 private:
  void listenToTheDriver() {
    window_.on_left_button = [this](const nanogui::Vector2i& p, bool down, int modifiers) {
      return down ? takeHold(p) : putDown(p, modifiers);
    };
    window_.on_motion = [this](const nanogui::Vector2i& p, int modifiers) {
      if (!drag_.held()) return false;
      if (const auto place = placeOf(p)) drag_.move(*place, (modifiers & GLFW_MOD_SHIFT) != 0);
      return true;
    };
    window_.on_character = [this](unsigned codepoint) {
      if (!line_.isOpen()) return false;
      line_.type(codepoint);
      return true;
    };
  }

  std::optional<core::Point2> placeOf(const nanogui::Vector2i& p) const {
    return viewer::placeAt({static_cast<double>(p.x()), static_cast<double>(p.y())}, camera_.now(),
                           scene_.size(), viewer::heightOf(viewer::kRobotLayer));
  }

  bool takeHold(const nanogui::Vector2i& p) {
    const auto place = placeOf(p);
    if (!place || !last_ || !last_->T_scene_truth || p.x() >= scene_.size().sceneWidth()) return false;
    const double m_per_pixel =
        camera_.now().zoom_m / (2 * std::min(scene_.size().sceneWidth(), scene_.size().height));
    refusal_.clear();
    return drag_.press(*place, *last_->T_scene_truth,
                       std::max(options_.robot_radius_m, kGrip_pixels * m_per_pixel));
  }

  bool putDown(const nanogui::Vector2i& p, int modifiers) {
    if (!drag_.held()) return false;
    if (const auto place = placeOf(p)) drag_.move(*place, (modifiers & GLFW_MOD_SHIFT) != 0);
    const auto pose = drag_.release();
    must_show_ = true;
    if (!pose) return true;
    refusal_ = options_.refusal(*pose);
    if (refusal_.empty())
      stage_.carry(*pose);
    else
      refusal_ = "not put down: the place is " + refusal_;
    return true;
  }

  /// While a line is typed, keys are letters.
  bool onLineKey(int key) {
    switch (key) {
      case GLFW_KEY_ESCAPE:
        line_.close();
        break;
      case GLFW_KEY_BACKSPACE:
        line_.erase();
        break;
      case GLFW_KEY_ENTER:
      case GLFW_KEY_KP_ENTER:
        if (const auto command = line_.enter()) stage_.give(*command);
        break;
      default:
        break;
    }
    return true;  // the characters come by themselves
  }

  bool onKey(int key, int scancode, int action, int modifiers) {
    const bool is_down = action != GLFW_RELEASE;
    if (hands_ == Hands::kDrive && holdKey(key, is_down)) return true;
    if (!is_down) return true;
    if (line_.isOpen()) return onLineKey(key);
    if ((modifiers & (GLFW_MOD_CONTROL | GLFW_MOD_ALT)) != 0) return false;
    if (key == GLFW_KEY_ESCAPE) return onSymbol('q');
    if (key == GLFW_KEY_SPACE) return onSymbol(' ');
    if (hands_ == Hands::kDrive && (key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER))
      return line_.open(), true;
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
        return toggleLayers(symbol);
    }
  }

  bool toggleLayers(char key) {
    const auto& switches = viewer::layerSwitches();
    if (std::none_of(switches.begin(), switches.end(), [key](const auto& one) { return one.key == key; }))
      return false;
    if (const auto at = hidden_.find(key); at != std::string::npos)
      hidden_.erase(at, 1);
    else
      hidden_ += key;
    return true;
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
    if (line_.isOpen()) return line_.refusal().empty() ? line_.text() : line_.refusal();
    if (drag_.held()) return "in your hand; Shift turns it";
    if (!refusal_.empty()) return refusal_;
    const std::string share = files::formatNumber(100 * keys_.share) + " % speed";
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
    panel.hidden = hidden_;
    if (hidden_ != shown_.hidden) scene_.hide(hidden_);
    auto snapshot = stage_.take();
    if (hands_ == Hands::kDrive) {
      if (snapshot) last_ = snapshot;
      if (drag_.held() || must_show_) snapshot = last_;
      if (drag_.held() && snapshot) snapshot->T_scene_truth = drag_.held();
      must_show_ = false;
    }
    if (snapshot && !has_title_) window_.setWindowTitle(options_.title);
    has_title_ = has_title_ || snapshot;
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
  EventWindow window_;
  CameraMan camera_;
  HeldKeys keys_;
  CommandLine line_;
  RobotDrag drag_;
  std::string refusal_;                   ///< of the last place where the robot was to be put down
  std::optional<viewer::Snapshot> last_;  ///< shown, while driving
  bool must_show_ = false;                ///< again, though there is no newer one
  bool shows_keys_ = false;
  std::string hidden_;      ///< keys of the layers that are off
  bool has_title_ = false;  ///< its own, once there is something to see
  viewer::PanelState shown_;
};

}  // namespace

std::vector<viewer::KeyHelp> keysOf(Hands hands) {
  std::vector<viewer::KeyHelp> keys;
  if (hands == Hands::kDrive)
    keys = {{"arrows", "drive and turn"},
            {"+  -", "drive faster, slower"},
            {"Enter", "type move METRES or turn DEGREES"},
            {"drag robot", "kidnap it; Shift turns it"}};
  else
    keys = {{"n  right", "one step"}, {"+  -", "faster, slower"}};
  keys.insert(keys.begin(), {"space", "pause, go on"});
  for (const viewer::KeyHelp& key : {viewer::KeyHelp{"f", "follow the robot"},
                                     {"a", "show all, from above"},
                                     {"0 to 9", "layers on and off: see the colours"},
                                     {"h", "keys or colours"},
                                     {"q  Esc", hands == Hands::kDrive ? "save and end" : "end"},
                                     {"wheel", "zoom"},
                                     {"left drag", "turn the view"},
                                     {"right drag", "shift the view"}})
    keys.push_back(key);
  return keys;
}

bool isSet(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != 0;
}

void requireDisplay() {
  glfwSetErrorCallback([](int, const char*) {});  // the exception says it
  // Asked first: a Wayland library that finds nothing complains to the terminal.
  if ((!isSet("DISPLAY") && !isSet("WAYLAND_DISPLAY")) || glfwInit() != GLFW_TRUE)
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

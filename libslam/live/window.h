#pragma once
#include <functional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/live/stage.h"
#include "libslam/viewer/live_scene.h"

namespace slam::live {

/// What a window does with its keys besides looking.
enum class Hands {
  kWatch,  ///< n and the right arrow: one step; + and -: the playback's speed
  kDrive   ///< the arrows drive the robot, + and - say how fast, Enter opens a line for commands, the mouse
           ///< carries the robot
};

/// The keys of a window, for its help and for `--help`.
std::vector<viewer::KeyHelp> keysOf(Hands hands);

/// Errors: IoError with one line when no window can be opened for want of a display.
void requireDisplay();

struct WindowOptions {
  std::string title;
  Hands hands = Hands::kWatch;
  bool close_at_end = false;               ///< do not wait for q when the loop has ended
  std::function<bool()> interrupted = {};  ///< asked often; true: close
  double robot_radius_m = 0.2;             ///< within which the mouse takes hold of it
  /// Why the robot cannot be put down there, scene frame; "": it can. REQUIRED with Hands::kDrive.
  std::function<std::string(const core::Pose2&)> refusal = {};
};

/// Shows a stage in a window until q is pressed, or the window or the stage is closed; then both are. Runs in
/// the calling thread, which must be the program's first. Once in a process. Errors: as requireDisplay();
/// IoError when the display has no OpenGL 3.3.
void showWindow(Stage& stage, viewer::LiveScene& scene, const WindowOptions& options);

}  // namespace slam::live

#pragma once
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libslam/live/stage.h"
#include "libslam/live/window.h"
#include "libslam/reach/goal_methods.h"
#include "libslam/robot/drive.h"
#include "libslam/viewer/live_scene.h"
#include "libslam/world/plan.h"

namespace slam::apps {

/// How something is shown, as the command line says.
struct ShowFlags {
  double speed = 4;  ///< 0 = as fast as it goes
  bool paused = false;
  bool close = false;  ///< the window, when the loop has ended
  std::vector<int> size = {1280, 800};
  std::string screenshot;  ///< a PNG instead of a window
  double at_s = -1;        ///< of the robot's time, of the screenshot
};

/// Something to show.
struct Show {
  std::string title, method;
  std::optional<world::Plan> plan;  ///< the true one, where it is known
  double robot_side_m = robot::RobotOptions().side_m;
  core::Pose2 T_scene_map;
  core::Trajectory truth;  ///< beside a log
  std::vector<std::pair<int, viewer::Connection>> loops;
  std::optional<core::Point2> goal;  ///< of a drive to a goal, map frame
  live::Hands hands = live::Hands::kWatch;
  std::optional<reach::StrategicOverlay> strategic;  ///< of the original goal navigation
  /// With Hands::kDrive: why the robot cannot stand there; "" when it can.
  std::function<std::string(const core::Pose2&)> refusal;
};

/// What is shown while it works. It ends by core::Interrupted when it is no longer looked at; with
/// Hands::kDrive it asks the stage.
using Loop = std::function<void(record::StepObserver& observer, live::Stage* stage)>;

enum class Shown {
  kWhole,   ///< the loop came to its end
  kClosed,  ///< the window was closed before
  kPicture  ///< a screenshot was taken
};

/// Runs the loop in a thread of its own and shows it in a window, in this one; or takes a screenshot and
/// needs no display. Errors: what the loop throws; IoError without a display; InputError for a screenshot
/// after the loop's end.
Shown show(const Show& what, const ShowFlags& flags, const Loop& loop);

}  // namespace slam::apps

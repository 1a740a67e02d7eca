#include "apps/view_commands.h"

#include <memory>
#include <string>

#include "apps/console.h"
#include "apps/navigators_slam.h"
#include "apps/user_input.h"
#include "apps/view_actions.h"

namespace slam::apps {
namespace {

void addWindowSize(CLI::App* command, ShowFlags& flags) {
  command->add_option("--size", flags.size, "of the window, WIDTHxHEIGHT in pixels")
      ->delimiter('x')
      ->expected(2)
      ->check(CLI::Range(480, 7680))
      ->default_str("1280x800");
}

void addShowFlags(CLI::App* command, ShowFlags& flags) {
  command->add_option("--speed", flags.speed, "times the robot's time, 0.125 to 64; 0 = as fast as it goes")
      ->check(CLI::Range(0.0, live::Playback::kFastest))
      ->capture_default_str();
  command->add_flag("--paused", flags.paused, "begin paused");
  command->add_flag("--close", flags.close, "close the window at the end");
  addWindowSize(command, flags);
  command->add_option("--screenshot", flags.screenshot,
                      "a PNG to write instead of opening a window; needs no display");
  command
      ->add_option("--at", flags.at_s, "of the screenshot: seconds of the robot's time since the first scan")
      ->check(CLI::NonNegativeNumber);
}

std::string keysText(live::Hands hands) {
  std::string text;
  for (const auto& key : live::keysOf(hands)) text += "\n  " + padded(key.key, 12) + key.meaning;
  return text;
}

using Action = int (*)(const Context&, const ViewArguments&);

std::shared_ptr<ViewArguments> onCall(CLI::App* command, Context& context, Action action) {
  auto arguments = std::make_shared<ViewArguments>();
  command->callback([&context, arguments, action] {
    context.action = [&context, arguments, action] { return action(context, *arguments); };
  });
  return arguments;
}

constexpr const char* kPlanMeaning = "bmp, png, pgm, jpg, a ROS map yaml, or a world by name";

void addDrive(CLI::App* view, Context& context) {
  auto* drive = view->add_subcommand("drive", "drive by the arrow keys; writes a rawlog and its truth");
  auto driving = onCall(drive, context, viewDrive);
  drive->add_option("plan", driving->input, kPlanMeaning)->required();
  addOutput(drive, context, "the rawlog to write (default run.rawlog)");
  addSeed(drive, context);
  drive->add_option("--lidar", driving->simulation.lidars,
                    "a lidar by name (see 'rasterslam list lidars') or an .ini file");
  addSensorFlag(drive, driving->simulation);
  driving->slam = "naive";
  drive
      ->add_option("--slam", driving->slam,
                   "the method whose map grows and whose pose is shown, or odometry for none")
      ->capture_default_str();
  addCommands(drive, driving->commands);
  addCarry(drive, driving->carries);
  drive->add_option("--duration", driving->simulation.duration_s, "longest recording, seconds")
      ->check(isDuration);
  addStartFlag(drive, driving->simulation);
  drive->add_option("--form", driving->simulation.form, "form of the rawlog: action or observation");
  addConfig(drive, context);
  driving->show.speed = 1;
  addShowFlags(drive, driving->show);
  drive->footer(
      "Keys:" + keysText(live::Hands::kDrive) +
      "\nThe files are those of 'rasterslam simulate'; closing the window saves them, Ctrl-C does not.\n"
      "--commands come first; --close ends the drive after them.\n"
      "Examples:\n"
      "  rasterslam view drive flat -o run.rawlog --set living.people=3\n"
      "  rasterslam view drive flat --slam graph --commands drive.txt\n"
      "  rasterslam view drive flat --commands drive.txt --screenshot map.png --at 20");
}

void addSimulate(CLI::App* view, Context& context) {
  auto* simulate = view->add_subcommand("simulate", "watch 'rasterslam simulate'");
  auto simulating = onCall(simulate, context, viewSimulate);
  simulate->add_option("plan", simulating->input, kPlanMeaning)->required();
  addOutput(simulate, context, "the rawlog to write (default: none)");
  addSeed(simulate, context);
  addSimulationFlags(simulate, simulating->simulation);
  addCarry(simulate, simulating->carries);
  addConfig(simulate, context);
  addShowFlags(simulate, simulating->show);
  simulate->footer("Example:\n  rasterslam view simulate office_loop --set living.people=8 --speed 8");
}

void addExplore(CLI::App* view, Context& context) {
  auto* explore = view->add_subcommand("explore", "watch 'rasterslam explore' with one strategy");
  auto exploring = onCall(explore, context, viewExplore);
  explore->add_option("plan", exploring->input, kPlanMeaning)->required();
  explore
      ->add_option("--slam", exploring->slam, "the method that estimates pose and map, or truth (reference)")
      ->capture_default_str();
  addOutput(explore, context, "folder to write (default: none)");
  addSeed(explore, context);
  addSimulationFlags(explore, exploring->simulation);
  addCarry(explore, exploring->carries);
  addConfig(explore, context);
  addShowFlags(explore, exploring->show);
  explore->footer(
      "Examples:\n"
      "  rasterslam view explore flat --strategy information_gain --slam particles\n"
      "  rasterslam view explore flat --strategy quadrant --screenshot flat.png --at 60");
}

void addNavigate(CLI::App* view, Context& context) {
  auto* navigate = view->add_subcommand("navigate", "watch 'rasterslam navigate' with one method");
  auto navigating = onCall(navigate, context, viewNavigate);
  navigating->slam.clear();
  navigating->method = "tangent";
  navigate->add_option("plan", navigating->input, kPlanMeaning)->required();
  navigate->add_option("--start", navigating->start, "x_m,y_m,yaw_deg in the world frame, or auto")
      ->capture_default_str();
  navigate->add_option("--goal", navigating->goal, "x_m,y_m in the world frame")->required();
  navigate->add_option("--method", navigating->method, "bug1, bug2, tangent, lidar_bug or mrpt_reactive")
      ->capture_default_str();
  navigate->add_option("--slam", navigating->slam, kNavigatorsSlamMeaning);
  navigate->add_option("--lidar", navigating->simulation.lidars,
                       "a lidar by name (see 'rasterslam list lidars') or an .ini file");
  addSensorFlag(navigate, navigating->simulation);
  addCarry(navigate, navigating->carries);
  addOutput(navigate, context, "folder to write (default: none)");
  addSeed(navigate, context);
  addConfig(navigate, context);
  addShowFlags(navigate, navigating->show);
  navigate->footer("Example:\n  rasterslam view navigate office_loop --goal 3,2 --method bug2 --speed 8");
}

void addRun(CLI::App* view, Context& context) {
  auto* run_method = view->add_subcommand("run", "watch 'rasterslam run': a method at work on a log");
  auto running = onCall(run_method, context, viewRun);
  run_method->add_option("method", running->method, "a name of 'rasterslam list methods', or an .ini file")
      ->required();
  run_method->add_option("log", running->input, "a log: MRPT rawlog, CARMEN, ...")->required();
  run_method->add_option("--plan", running->plan, "true plan to show (default: the one the log was made in)");
  addOutput(run_method, context, "folder to write (default: none)");
  addSeed(run_method, context);
  addConfig(run_method, context);
  addShowFlags(run_method, running->show);
  run_method->footer(
      "Examples:\n"
      "  rasterslam view run graph run.rawlog --speed 16\n"
      "  rasterslam view run rbpf_exact intel.clf -o out");
}

void addReplay(CLI::App* view, Context& context) {
  auto* replay =
      view->add_subcommand("replay", "watch a finished run again: the scans at the poses of its final path");
  auto replaying = onCall(replay, context, viewReplay);
  replay->add_option("folder", replaying->input, "what 'rasterslam run' or 'explore' wrote")->required();
  replay->add_option("--log", replaying->log, "the run's log, where it is no longer in its place");
  replay->add_option("--plan", replaying->plan, "true plan to show (default: the one the log was made in)");
  addShowFlags(replay, replaying->show);
  replay->footer("Example:\n  rasterslam view replay out --speed 16");
}

}  // namespace

void addViewCommands(CLI::App& app, Context& context) {
  auto* view = app.add_subcommand("view", "watch a robot live in a window, or drive it by hand");
  view->require_subcommand(1);
  view->footer("Keys:" + keysText(live::Hands::kWatch) +
               "\nExit codes: as rasterslam's; 1 without a display (--screenshot needs none).\n"
               "'rasterslam view --mrpt FILE' shows a file in MRPT's own viewer instead.\n"
               "'rasterslam view COMMAND --help' shows examples.");
  addDrive(view, context);
  addSimulate(view, context);
  addExplore(view, context);
  addNavigate(view, context);
  addRun(view, context);
  addReplay(view, context);
}

}  // namespace slam::apps

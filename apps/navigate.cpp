#include <iostream>
#include <memory>

#include "apps/commands.h"
#include "apps/console.h"
#include "apps/navigators_slam.h"
#include "apps/user_input.h"
#include "libslam/core/error.h"
#include "libslam/reach/reach_goal.h"
#include "libslam/record/record.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/resources.h"

namespace slam::apps {
namespace {

struct NavigateArguments {
  std::string plan, start = "auto", goal;
  std::string slam;
  std::vector<std::string> methods = {"bug1", "bug2", "tangent", "lidar_bug"};
  SimulationFlags flags;
  std::vector<std::string> carries;
};

int navigateTo(const Context& context, const NavigateArguments& arguments) {
  reach::ReachGoalRequest request;
  request.config =
      reach::readReachGoalConfig(withCarries(simulationConfig(context, arguments.flags), arguments.carries));
  if (context.print_config) {
    printParameters(request.config.parameters, context.json);
    return 0;
  }
  request.p_world_goal = reach::parsePlace(arguments.goal, "--goal");
  const std::string plan_path = resources::resolvePlan(arguments.plan);
  request.plan = record::planOfVisit(world::loadPlan(plan_path), request.config.living, context.seed);
  request.T_world_start = reach::goalStart(request.plan, request.config, arguments.start);
  request.methods = arguments.methods;
  const std::string slam = navigatorsSlam(arguments.slam, request.config.camera.has_value());
  request.slam = slam == "odometry" ? "" : slam;
  request.methods_folder = resources::configsFolder() + "/methods";
  request.output = context.output.empty() ? "navigation" : context.output;
  request.seed = context.seed;
  request.overwrite = context.overwrite;
  auto manifest = context.manifest();
  manifest.inputs[plan_path] = resources::fileSha256(plan_path);
  ConsoleProgress progress(context.quiet);
  const auto comparison = reach::reachGoal(request, manifest, progress);
  if (context.json)
    std::cout << table::toJson(comparison.table) << "\n";
  else
    std::cout << tableText(comparison.table) << "\npaths, states, logs, pictures: " << request.output << "\n";
  return static_cast<int>(comparison.wrong ? core::ExitCode::kMethodFailed : core::ExitCode::kOk);
}

}  // namespace

void addNavigate(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("navigate", "drive to a goal without a map; prints a table");
  auto arguments = std::make_shared<NavigateArguments>();
  command->add_option("plan", arguments->plan, "bmp, png, pgm, jpg, a ROS map yaml, or a world by name")
      ->required();
  command->add_option("--start", arguments->start, "x_m,y_m,yaw_deg in the world frame, or auto")
      ->capture_default_str();
  command->add_option("--goal", arguments->goal, "x_m,y_m in the world frame")->required();
  command
      ->add_option("--method", arguments->methods,
                   "bug1, bug2, tangent, lidar_bug, mrpt_reactive; separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--slam", arguments->slam, kNavigatorsSlamMeaning);
  command->add_option("--lidar", arguments->flags.lidars,
                      "a lidar by name (see 'rasterslam list lidars') or an .ini file");
  addSensorFlag(command, arguments->flags);
  addCarry(command, arguments->carries);
  addOutput(command, context, "folder to write (default navigation)");
  addSeed(command, context);
  addConfig(command, context);
  addJson(command, context);
  command->footer(
      "Exit code 0: every method reached the goal (truly, within 0.5 m), or said rightly that no way leads\n"
      "there. 4: one missed it, gave up, or was wrong.\n"
      "Examples:\n"
      "  rasterslam navigate office_loop --goal 3,2 --method bug2,tangent -o out\n"
      "  rasterslam navigate maze --start 1.45,1.45,0 --goal 15.9,15.9 --method tangent --slam icp\n"
      "  rasterslam navigate flat --goal 3,2 --method bug2 --sensor camera --set camera.pitch_deg=30\n"
      "  rasterslam navigate flat --goal 3,2 --carry 10:11,2,90 -o out");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return navigateTo(context, *arguments); };
  });
}

}  // namespace slam::apps

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "libslam/check/plan_check.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/pictures/plan_changes.h"
#include "libslam/resources/resources.h"
#include "libslam/robot/drive.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct WorldCheckArguments {
  std::string plan;
  double resolution_m = 0, robot_side_m = 0, widest_gap_m = -1;
  std::vector<std::string> only, skip;
  bool fix = false, yes = false;
};

void printFindings(const check::PlanCheck& check, bool fixed) {
  for (const auto& finding : check.findings) {
    printWrapped(padded(check::severityName(finding.severity), 8) + padded(finding.key, 11) + " ",
                 finding.text + ".");
    const std::string does = finding.is_mendable ? (fixed ? "mended: " : "--fix ") : "";
    printWrapped(std::string(20, ' '), does + finding.remedy + ".");
  }
}

void printFigures(const check::PlanCheck& check) {
  const auto& f = check.figures;
  const auto& plan = check.after;
  std::printf("size        %d x %d pixels of %s m: %.1f x %.1f m, walls %.1f x %.1f m\n", plan.columns,
              plan.rows, files::formatNumber(plan.resolution_m).c_str(), plan.columns * plan.resolution_m,
              plan.rows * plan.resolution_m, f.width_m, f.height_m);
  std::printf("cells       %.1f %% free, %.1f %% wall, %.1f %% unknown; %.0f MB to simulate in\n",
              100 * f.free_share, 100 * f.occupied_share, 100 * f.unknown_share, f.megabytes);
  std::printf("free        %.1f m2, of which the robot covers %.1f m2\n", f.free_m2, f.reachable_m2);
  std::printf("rooms       %d", f.rooms);
  if (const auto& widths = f.door_widths_m; !widths.empty())
    std::printf(", %zu passages %.2f to %.2f m wide, median %.2f m", widths.size(), widths.front(),
                widths.back(), widths[widths.size() / 2]);
  std::printf("\n");
}

ordered_json toJson(const check::PlanCheck& check) {
  auto findings = ordered_json::array();
  for (const auto& f : check.findings) {
    auto places = ordered_json::array();
    for (const auto& place : f.places)
      places.push_back({{"pixel", {place.x, place.y}}, {"world_m", {place.p_world.x, place.p_world.y}}});
    findings.push_back({{"key", f.key},
                        {"severity", check::severityName(f.severity)},
                        {"text", f.text},
                        {"fix", f.remedy},
                        {"fixable", f.is_mendable},
                        {"count", f.count},
                        {"places", places}});
  }
  const auto& f = check.figures;
  return {{"kind", check.is_map ? "map" : "drawing"},
          {"usable", check.isUsable()},
          {"hidden_m2", check.hidden_m2},
          {"hidden_share", check.hidden_share},
          {"findings", findings},
          {"columns", check.after.columns},
          {"rows", check.after.rows},
          {"resolution_m", check.after.resolution_m},
          {"figures",
           {{"width_m", f.width_m},
            {"height_m", f.height_m},
            {"free_share", f.free_share},
            {"occupied_share", f.occupied_share},
            {"unknown_share", f.unknown_share},
            {"free_m2", f.free_m2},
            {"reachable_m2", f.reachable_m2},
            {"rooms", f.rooms},
            {"passage_widths_m", f.door_widths_m},
            {"megabytes", f.megabytes}}}};
}

/// What a second look at the mended plan finds.
check::PlanCheck checkAgain(const std::string& yaml_path, check::PlanCheckOptions options) {
  options.resolution_m.reset();  // stands in the yaml now
  return check::checkPlan(yaml_path, options);
}

std::string pictureOf(const std::string& yaml_path) {
  return fs::path(yaml_path).replace_extension(".png").string();
}
std::string changesBeside(const std::string& yaml_path) {
  return fs::path(yaml_path).replace_extension(".before_after.png").string();
}

/// The mended plan goes beside the one that was read, never over it.
void requireWritable(const std::string& yaml_path, const std::vector<std::string>& inputs, bool overwrite) {
  const std::string suffix = fs::path(yaml_path).extension();
  if (suffix != ".yaml" && suffix != ".yml")
    throw core::InputError("--output: found '" + yaml_path + "', expected a name that ends with .yaml");
  const std::string materials = fs::path(yaml_path).replace_extension(".materials.png");
  for (const auto& path : {yaml_path, pictureOf(yaml_path), materials, changesBeside(yaml_path)}) {
    for (const auto& input : inputs) {
      std::error_code ignored;
      if (fs::equivalent(path, input, ignored))
        throw core::InputError("--output: found '" + yaml_path + "', which would replace the plan's own " +
                               input);
    }
    files::refuseToOverwrite(path, overwrite);
  }
}

/// Beyond this share of the free space mending has taken rooms for the outside, until somebody says
/// otherwise.
constexpr double kMostHidden = 0.2;

std::string hiddenText(const check::PlanCheck& check) {
  char text[96];
  std::snprintf(text, sizeof text, "%.1f m2, %.0f %% of the free space amid the walls", check.hidden_m2,
                100 * check.hidden_share);
  return text;
}

/// A copy that lacks much of the plan is not written unasked.
void requireLittleHidden(const check::PlanCheck& check, const std::string& plan_path, bool yes) {
  if (yes || check.hidden_share <= kMostHidden) return;
  const bool are_shut_in =
      std::any_of(check.findings.begin(), check.findings.end(), [](const check::Finding& finding) {
        return finding.key == "isolated" && finding.severity != check::Severity::kNote;
      });
  const std::string remedy = are_shut_in ? "open the doorways in the drawing, or give a smaller --robot-side"
                                         : "close the outline in the drawing or by --close-gaps METRES";
  throw core::InputError(plan_path + ": mending would make unknown " + hiddenText(check) + "; " + remedy +
                         ", or say --yes");
}

int checkWorld(const Context& context, const WorldCheckArguments& arguments) {
  const std::string plan_path = resources::resolvePlan(arguments.plan);
  check::PlanCheckOptions options;
  options.robot_side_m = robot::RobotOptions().side_m;
  files::IniFile flags;
  const auto give = [&](const char* key, double value, const char* flag) {
    flags.set("check", key, files::formatNumber(value), flag);
  };
  if (arguments.robot_side_m != 0) give("robot_side_m", arguments.robot_side_m, "--robot-side");
  if (arguments.widest_gap_m >= 0) give("widest_gap_m", arguments.widest_gap_m, "--close-gaps");
  files::readParameters(flags, check::PlanCheckOptions::table(), options);
  if (arguments.resolution_m != 0) options.resolution_m = arguments.resolution_m;
  options.only = arguments.only;
  options.skip = arguments.skip;

  std::string fixed_path = context.output;
  if (fixed_path.empty())
    fixed_path = (fs::path(plan_path).parent_path() / fs::path(plan_path).stem()).string() + ".fixed.yaml";
  const auto check = check::checkPlan(plan_path, options);
  if (arguments.fix) requireWritable(fixed_path, check.files, context.overwrite);
  if (!context.json) {
    std::printf("plan        %s, read as a %s\n", plan_path.c_str(), check.is_map ? "map" : "drawing");
    printFindings(check, arguments.fix);
    if (check.findings.empty()) std::cout << "nothing to mend\n";
  }
  auto json = ordered_json{{"plan", plan_path}};
  json.update(toJson(check));
  bool is_usable = check.isUsable();
  if (arguments.fix && check.isMendable()) {
    requireLittleHidden(check, plan_path, arguments.yes);
    world::savePlan(check.after, fixed_path);
    pictures::drawPlanChanges(check.before, check.after, check.changes,
                              fs::path(plan_path).filename().string(), changesBeside(fixed_path));
    const auto again = checkAgain(fixed_path, options);
    is_usable = again.isUsable();
    json["fixed"] = toJson(again);
    json["files"] = {fixed_path, pictureOf(fixed_path), changesBeside(fixed_path)};
    if (!context.json) {
      std::cout << "\nafter fixing:\n";
      if (check.hidden_m2 > 0) std::cout << "made unknown: " << hiddenText(check) << "\n";
      printFindings(again, false);
      if (again.findings.empty()) std::cout << "nothing to mend\n";
      printFigures(again);
      for (const auto& file : json["files"]) std::cout << "  " << file.get<std::string>() << "\n";
      std::cout << "next: rasterslam simulate " << fixed_path << "\n";
    }
  } else if (!context.json) {
    printFigures(check);
    if (check.isMendable() && check.hidden_share > kMostHidden)
      std::cout << "--fix would make unknown " << hiddenText(check) << "\n";
    if (check.isMendable()) std::cout << "next: rasterslam world check " << arguments.plan << " --fix\n";
  }
  if (context.json) std::cout << json.dump(2) << "\n";
  return static_cast<int>(is_usable ? core::ExitCode::kOk : core::ExitCode::kBadInput);
}

std::string footer() {
  std::string text = "What is looked for, in this order (--only and --skip take these keys):\n";
  for (const auto& [key, meaning] : check::planCheckKeys()) text += "  " + padded(key, 12) + meaning + "\n";
  return text +
         "Exit code: 0 the plan can be used (also with warnings), 3 it cannot as it is; with --fix of the "
         "result.\n"
         "Examples:\n"
         "  rasterslam world check plan.png\n"
         "  rasterslam world check plan.png --resolution 0.02 --fix -o flat.yaml\n"
         "  rasterslam world check map.yaml --only isolated,open_edge --robot-side 0.6";
}

}  // namespace

void addWorldCheck(CLI::App& world, Context& context) {
  auto* command = world.add_subcommand("check", "say what is wrong with a plan, and mend it");
  auto arguments = std::make_shared<WorldCheckArguments>();
  command->add_option("plan", arguments->plan, "bmp, png, pgm, jpg, a ROS map yaml, or a world by name")
      ->required();
  command->add_flag("--fix", arguments->fix,
                    "write a mended copy and a picture of the changes; the plan stays");
  command->add_flag("--yes", arguments->yes,
                    "with --fix: also when more than 20 % of the free space amid the walls becomes unknown");
  addOutput(command, context, "with --fix: the yaml to write (default NAME.fixed.yaml beside the plan)");
  command
      ->add_option("--resolution", arguments->resolution_m,
                   "metres per pixel, over any yaml and any estimate")
      ->check(CLI::PositiveNumber);
  command->add_option("--robot-side", arguments->robot_side_m, "side of the robot that has to pass, metres")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--close-gaps", arguments->widest_gap_m,
                   "widest gap in a drawing's outline that is closed, metres (default " +
                       files::formatNumber(check::PlanCheckOptions().widest_gap_m) + ")")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--only", arguments->only, "look for these keys only")->delimiter(',');
  command->add_option("--skip", arguments->skip, "do not look for these keys")->delimiter(',');
  addJson(command, context);
  command->footer(footer());
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return checkWorld(context, *arguments); };
  });
}

}  // namespace slam::apps

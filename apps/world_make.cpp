#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/pictures/picture.h"
#include "libslam/record/generated_world.h"
#include "libslam/resources/ini_yaml.h"

namespace slam::apps {
namespace {

struct WorldMakeArguments {
  std::string kind, size, preview;
  double resolution_m = -1;
};

/// "80x50" as width and height in metres.
void setSize(files::IniFile& config, const std::string& size) {
  const size_t cross = size.find('x');
  double width = 0, height = 0;
  if (cross == std::string::npos || !files::parseNumber(size.substr(0, cross), width) ||
      !files::parseNumber(size.substr(cross + 1), height) || width < 5 || height < 5)
    throw core::InputError("--size: found '" + size +
                           "', expected width x height in metres, each 5 to 500, such as 80x50");
  config.set("building", "width_m", files::formatNumber(width), "--size");
  config.set("building", "height_m", files::formatNumber(height), "--size");
}

files::IniFile configOf(const Context& context, const WorldMakeArguments& arguments) {
  files::IniFile config;
  if (!context.config.empty()) config = resources::readConfigFile(context.config);
  for (const auto& setting : context.settings) config.setFromArgument(setting, "--set");
  if (!arguments.size.empty()) setSize(config, arguments.size);
  if (arguments.resolution_m >= 0)
    config.set("building", "resolution_m", files::formatNumber(arguments.resolution_m), "--resolution");
  files::rejectUnknownSections(config, {"building"});
  return config;
}

int makeWorld(const Context& context, const WorldMakeArguments& arguments) {
  buildings::BuildingOptions options;
  std::vector<files::ParameterReport> parameters;
  const files::IniFile config = configOf(context, arguments);
  files::readParameters(config, buildings::BuildingOptions::table(), options, &parameters);
  if (context.print_config) {
    printParameters(parameters, context.json);
    return 0;
  }
  const std::string path = context.output.empty() ? arguments.kind + ".yaml" : context.output;
  if (std::filesystem::path(path).extension() != ".yaml")
    throw core::InputError("--output: found '" + path + "', expected a name that ends with .yaml");
  const std::string picture = std::filesystem::path(path).replace_extension(".png").string();
  if (!arguments.preview.empty() &&
      std::filesystem::absolute(arguments.preview) == std::filesystem::absolute(picture))
    throw core::InputError("--preview: found '" + arguments.preview +
                           "', expected another file than the plan's own picture");
  std::vector<std::string> files = {path, picture};
  if (options.glass > 0)
    files.push_back(std::filesystem::path(path).replace_extension(".materials.png").string());
  if (!arguments.preview.empty()) files.push_back(arguments.preview);
  for (const auto& file : files) files::refuseToOverwrite(file, context.overwrite);

  auto building = record::generateWorld(arguments.kind, config, context.seed);
  world::Plan& plan = building.plan;
  plan.name = std::filesystem::path(path).stem().string();
  world::savePlan(plan, path);
  if (!arguments.preview.empty())
    pictures::drawMap(plan, {}, plan.name + ", seed " + std::to_string(context.seed), arguments.preview);
  const auto isMissing = [](const std::string& file) { return !std::filesystem::exists(file); };
  files.erase(std::remove_if(files.begin(), files.end(), isMissing), files.end());  // no glass after all
  size_t free = 0, glass = 0;
  for (const world::Cell cell : plan.cells) free += cell == world::Cell::kFree;
  for (const world::Material material : plan.materials) glass += material == world::Material::kGlass;
  const double cell_m2 = plan.resolution_m * plan.resolution_m, free_m2 = static_cast<double>(free) * cell_m2;
  const double width_m = plan.columns * plan.resolution_m, height_m = plan.rows * plan.resolution_m;
  if (context.json) {
    std::cout << nlohmann::ordered_json{{"files", files},          {"kind", arguments.kind},
                                        {"seed", context.seed},    {"width_m", width_m},
                                        {"height_m", height_m},    {"resolution_m", plan.resolution_m},
                                        {"columns", plan.columns}, {"rows", plan.rows},
                                        {"rooms", building.rooms}, {"doors", plan.doors.size()},
                                        {"free_m2", free_m2},      {"glass_cells", glass}}
                     .dump(2)
              << "\n";
    return 0;
  }
  std::printf("%g x %g m, %d x %d cells of %g m, ", width_m, height_m, plan.columns, plan.rows,
              plan.resolution_m);
  if (building.rooms > 0) std::printf("%d rooms, %zu doors, ", building.rooms, plan.doors.size());
  std::printf("%.0f m2 free\n", free_m2);
  for (const auto& file : files) std::printf("  %s\n", file.c_str());
  std::printf("next: rasterslam simulate %s\n", path.c_str());
  return 0;
}

}  // namespace

void addWorldMake(CLI::App& world, Context& context) {
  auto* command = world.add_subcommand("make", "draw a building of any size; writes a plan");
  auto arguments = std::make_shared<WorldMakeArguments>();
  command
      ->add_option("kind", arguments->kind,
                   "flat | office | hall | hospital | cave | campus; office_loop, pillar_hall, corridor or "
                   "maze of fixed size")
      ->required();
  addOutput(command, context, "the yaml to write, its picture beside it (default KIND.yaml)");
  command->add_option("--size", arguments->size, "width x height in metres, each 5 to 500, such as 80x50");
  command->add_option(
      "--resolution", arguments->resolution_m,
      "metres a cell (default " + files::formatNumber(buildings::BuildingOptions().resolution_m) + ")");
  command->add_option("--preview", arguments->preview, "also draw the plan into this png, with a scale");
  addSeed(command, context);
  addConfig(command, context);
  addJson(command, context);
  command->footer(
      "Examples:\n"
      "  rasterslam world make office -o office.yaml --seed 7\n"
      "  rasterslam world make hospital -o wing.yaml --size 120x60 --preview wing_preview.png\n"
      "  rasterslam world make flat -o flats.yaml --size 40x24 --set building.clutter=0.3\n"
      "  rasterslam world make campus -o yard.yaml --size 200x200 --set building.room_m=200\n"
      "  rasterslam world make hall -o open.yaml --size 200x150 --set building.pillars_m=25\n"
      "  rasterslam list buildings");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return makeWorld(context, *arguments); };
  });
}

}  // namespace slam::apps

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/plot.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/logs/log_reader.h"
#include "libslam/pictures/journal_picture.h"
#include "libslam/pictures/picture.h"
#include "libslam/reach/turn_away.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/resources.h"
#include "libslam/results/journal_file.h"
#include "libslam/score/compare.h"
#include "libslam/world/plan.h"

namespace slam::apps {
namespace {

/// Of a number with one of the units, or without in the first of them; in that. Errors: InputError with the
/// option's name.
double lengthOf(const std::string& text, const std::string& option,
                const std::vector<std::pair<std::string, double>>& units) {
  std::string number = text;
  double factor = 1;
  for (const auto& [unit, size] : units) {
    if (text.size() <= unit.size() || text.compare(text.size() - unit.size(), unit.size(), unit) != 0)
      continue;
    number = files::trimmed(text.substr(0, text.size() - unit.size()));
    factor = size;
    break;
  }
  double value = 0;
  if (!files::parseNumber(number, value) || !(value > 0)) {
    std::string known;
    for (const auto& [unit, size] : units) known += (known.empty() ? "" : ", ") + unit;
    throw core::InputError(option + ": found '" + text + "', expected a length above 0 in " + known);
  }
  return value * factor;
}

}  // namespace

std::shared_ptr<PaperArguments> addPicture(CLI::App* command, Context& context,
                                           const std::string& default_name) {
  auto paper = std::make_shared<PaperArguments>();
  addOutput(command, context, "the picture to write: .png, .svg or .pdf (default " + default_name + ")");
  command->add_option(
      "--width", paper->width,
      "of the picture on paper: 85mm is a column, 170mm a page, also cm, in, pt (default: a PNG is made "
      "for the screen, the others are as wide as a page)");
  command->add_option("--font", paper->font, "size of the text on paper")->capture_default_str();
  command->add_option("--dpi", paper->dpi, "of a PNG that has a --width")
      ->check(CLI::Range(30.0, 2400.0))
      ->capture_default_str();
  addJson(command, context);
  return paper;
}

PicturePlace picturePlace(const Context& context, const PaperArguments& arguments,
                          const std::string& default_name) {
  PicturePlace place;
  place.file = context.output.empty() ? default_name : context.output;
  draw::requirePicturePath(place.file);
  files::refuseToOverwrite(place.file, context.overwrite);
  constexpr double kPage_mm = 170;
  auto& paper = place.paper;
  if (!arguments.width.empty())
    paper.width_mm =
        lengthOf(arguments.width, "--width", {{"mm", 1}, {"cm", 10}, {"in", 25.4}, {"pt", 25.4 / 72}});
  else if (std::filesystem::path(place.file).extension() != ".png")
    paper.width_mm = kPage_mm;
  paper.font_pt = lengthOf(arguments.font, "--font", {{"pt", 1}, {"mm", 72 / 25.4}});
  paper.dpi = arguments.dpi;
  constexpr double kLeastUnits = 300;  // narrower, labels have no room
  if (!paper.isScreen() && !(paper.unitsWide() >= kLeastUnits && paper.width_mm <= 2000))
    throw core::InputError("--width: found " + files::formatNumber(paper.width_mm) + " mm with text of " +
                           files::formatNumber(paper.font_pt) + " pt, expected " +
                           files::formatNumber(std::ceil(kLeastUnits / paper.unitsWide() * paper.width_mm)) +
                           " to 2000 mm");
  return place;
}

void sayPicture(const Context& context, const nlohmann::ordered_json& facts, const std::string& line) {
  if (context.json)
    std::cout << facts.dump(2) << "\n";
  else
    std::printf("%s\n", line.c_str());
}

namespace {

// --- plot scan

struct ScanArguments {
  std::string log;
  int index = 0;
};

lidar::Scan scanAt(const std::string& log_path, int index) {
  logs::LogReader log(log_path);
  int count = 0;
  while (const auto entry = log.next())
    if (count++ == index) return entry->scan;
  if (count == 0) throw core::InputError(log_path + ": holds 0 laser scans, expected at least 1");
  throw core::InputError(log_path + ": --index: found " + std::to_string(index) + ", expected 0 to " +
                         std::to_string(count - 1));
}

int plotScan(const Context& context, const ScanArguments& arguments, const PaperArguments& how) {
  const auto [path, paper] = picturePlace(context, how, "scan.png");
  const auto scan = scanAt(arguments.log, arguments.index);
  pictures::drawScan(scan, path, paper);
  sayPicture(
      context,
      {{"file", path}, {"index", arguments.index}, {"time_s", scan.time_s}, {"beams", scan.ranges_m.size()}},
      path);
  return 0;
}

void addPlotScan(CLI::App& plot, Context& context) {
  auto* command = plot.add_subcommand("scan", "one scan of a log: range over angle, and from above");
  auto arguments = std::make_shared<ScanArguments>();
  command->add_option("log", arguments->log, "a log: MRPT rawlog, CARMEN, ...")->required();
  command->add_option("--index", arguments->index, "which scan, the first is 0")->capture_default_str();
  const auto how = addPicture(command, context, "scan.png");
  command->footer("Example:\n  rasterslam plot scan run.rawlog --index 20 -o scan.png");
  command->callback([&context, arguments, how] {
    context.action = [&context, arguments, how] { return plotScan(context, *arguments, *how); };
  });
}

// --- plot obstacles

int plotObstacles(const Context& context, const std::string& sensor, const PaperArguments& how) {
  files::IniFile ini;
  if (!context.config.empty()) ini = resources::readConfigFile(context.config);
  for (const auto& setting : context.settings) ini.setFromArgument(setting, "--set");
  if (!sensor.empty()) ini.set("turn_away", "sensor", sensor, "--sensor");
  const auto config = reach::readTurnAwayConfig(ini);
  if (context.print_config) {
    printParameters(config.parameters, context.json);
    return 0;
  }
  const auto [path, paper] = picturePlace(context, how, "obstacles.png");
  const auto moments = reach::turnAway(config);
  reach::drawTurnAway(moments, config, path, paper);
  auto list = nlohmann::ordered_json::array();
  for (const auto& moment : moments)
    list.push_back(
        {{"moment", moment.what}, {"seen", moment.seen.size()}, {"remembered", moment.remembered.size()}});
  sayPicture(context, {{"file", path}, {"moments", list}}, path);
  return 0;
}

void addPlotObstacles(CLI::App& plot, Context& context) {
  auto* command = plot.add_subcommand(
      "obstacles", "the local obstacle map's experiment: turn away from obstacles and remember them");
  auto sensor = std::make_shared<std::string>();
  command->add_option("--sensor", *sensor, "camera or lidar");
  const auto how = addPicture(command, context, "obstacles.png");
  addConfig(command, context);
  command->footer(
      "Examples:\n"
      "  rasterslam plot obstacles -o obstacles.png\n"
      "  rasterslam plot obstacles --sensor lidar --set sector.width_deg=90\n"
      "  rasterslam plot obstacles --set camera.area=original --set camera.pitch_deg=40");
  command->callback([&context, sensor, how] {
    context.action = [&context, sensor, how] { return plotObstacles(context, *sensor, *how); };
  });
}

// --- plot plans

int plotPlans(const Context& context, const std::vector<std::string>& plans, const PaperArguments& how) {
  const auto [path, paper] = picturePlace(context, how, "plans.png");
  std::vector<pictures::Panel> panels;
  auto list = nlohmann::ordered_json::array();
  for (const auto& name : plans) {
    pictures::Panel panel;
    panel.map = world::loadPlan(resources::resolvePlan(name));
    panel.T_world_map =
        core::inverse(panel.map.T_frame_raster);  // beside one another, each from its own corner
    panel.title = panel.map.name;
    panel.is_true = true;
    char size[64];
    std::snprintf(size, sizeof size, "%g x %g m", panel.map.columns * panel.map.resolution_m,
                  panel.map.rows * panel.map.resolution_m);
    panel.subtitle = size;
    list.push_back({{"plan", name}, {"size", panel.subtitle}});
    panels.push_back(std::move(panel));
  }
  pictures::drawPanels(panels, path, paper);
  sayPicture(context, {{"file", path}, {"plans", list}}, path);
  return 0;
}

void addPlotPlans(CLI::App& plot, Context& context) {
  auto* command = plot.add_subcommand("plans", "floor plans side by side, all at one scale");
  auto plans = std::make_shared<std::vector<std::string>>();
  command->add_option("plans", *plans, "1 to 8 plans: bmp, png, pgm, jpg, a ROS map yaml, or a world by name")
      ->required()
      ->expected(1, 8);
  const auto how = addPicture(command, context, "plans.png");
  command->footer("Example:\n  rasterslam plot plans flat office_loop pillar_hall -o plans.png");
  command->callback([&context, plans, how] {
    context.action = [&context, plans, how] { return plotPlans(context, *plans, *how); };
  });
}

// --- plot journal

int plotJournal(const Context& context, const std::string& folder, const PaperArguments& how) {
  const auto [path, paper] = picturePlace(context, how, "journal.png");
  const auto run = results::loadRun(folder);
  const std::string file = folder + "/journal.csv";
  if (!std::filesystem::exists(file))
    throw core::InputError(folder + ": holds no journal.csv: method " + run.method + " wrote no journal");
  const auto events = results::readJournal(file);
  pictures::drawJournal(run.map, run.final_estimate.value_or(run.estimate), events,
                        "What " + run.method + " did", path, paper);
  sayPicture(context, {{"file", path}, {"events", events.size()}}, path);
  return 0;
}

void addPlotJournal(CLI::App& plot, Context& context) {
  auto* command = plot.add_subcommand(
      "journal", "what a method said of its work, on its map and over time: loops, trouble");
  auto folder = std::make_shared<std::string>();
  command->add_option("folder", *folder, "what 'rasterslam run' wrote")->required();
  const auto how = addPicture(command, context, "journal.png");
  command->footer(
      "Example:\n  rasterslam run graph run.rawlog -o out\n  rasterslam plot journal out -o journal.png");
  command->callback([&context, folder, how] {
    context.action = [&context, folder, how] { return plotJournal(context, *folder, *how); };
  });
}

}  // namespace

void addPlot(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand(
      "plot", "figures as PNG, SVG or PDF: maps, errors, cost, seeds, stress, exploration, a scan, plans");
  command->require_subcommand(1);
  command->footer(
      "Examples:\n"
      "  rasterslam plot map out -o map.pdf --width 170mm        maps and paths of a comparison\n"
      "  rasterslam plot paths out -o paths.svg                  all paths over the true plan\n"
      "  rasterslam plot errors out -o errors.pdf --width 85mm   position error over time\n"
      "  rasterslam plot consistency out -o true.pdf             whether covariances are true\n"
      "  rasterslam plot seeds sweep -o seeds.pdf                box plots over the seeds of a sweep\n"
      "  rasterslam plot stress fov -o fov.pdf                   curves of a stress test\n"
      "  rasterslam plot exploration ex -o coverage.pdf          explored share over time and path\n"
      "  rasterslam plot scan run.rawlog --index 20 -o scan.pdf  one scan\n"
      "Text is 8 pt in Liberation Sans, lines are 0.5 to 1.4 pt, colours those of Okabe and Ito.");
  addPlotResults(*command, context);
  addPlotScan(*command, context);
  addPlotOperations(*command, context);
  addPlotPlans(*command, context);
  addPlotObstacles(*command, context);
  addPlotJournal(*command, context);
}

}  // namespace slam::apps

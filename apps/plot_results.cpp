#include <algorithm>
#include <filesystem>

#include "apps/console.h"
#include "apps/plot.h"
#include "libslam/core/error.h"
#include "libslam/draw/axis_title.h"
#include "libslam/files/files.h"
#include "libslam/files/word_list.h"
#include "libslam/pages/cost_chart.h"
#include "libslam/pages/coverage_chart.h"
#include "libslam/pages/figures.h"
#include "libslam/pages/report_data.h"
#include "libslam/pictures/picture.h"
#include "libslam/study/stress_charts.h"

namespace slam::apps {
namespace {

struct PlotResultsArguments {
  std::vector<std::string> inputs;
  std::string methods, title;
  bool is_linear = false, is_overlaid = false;
  pages::SeedSelection seeds;
  std::shared_ptr<PaperArguments> how;
};

/// Leaves the methods on a folder's page that were asked for. Errors: InputError for a method that is not in
/// the folder.
void keepMethods(const PlotResultsArguments& arguments, const std::string& folder, report::ReportPage& page) {
  const auto wanted = files::namesIn(arguments.methods, ',');
  if (wanted.empty()) return;
  std::vector<std::string> known;
  for (const auto& run : page.runs) known.push_back(run.method);
  for (const auto& name : wanted)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw core::InputError("--methods: found '" + name + "', expected a method in " + folder +
                             core::didYouMean(name, known));
  const auto is_unwanted = [&](const report::ReportRun& run) {
    return std::find(wanted.begin(), wanted.end(), run.method) == wanted.end();
  };
  page.runs.erase(std::remove_if(page.runs.begin(), page.runs.end(), is_unwanted), page.runs.end());
}

/// What the HTML report knows of a folder, with the methods that were asked for.
report::ReportPage pageOf(const Context& context, const PlotResultsArguments& arguments) {
  const auto& folder = arguments.inputs.front();
  ConsoleProgress progress(context.quiet);
  auto page = pages::gatherReport(folder, progress);
  keepMethods(arguments, folder, page);
  return page;
}

std::vector<report::ReportPage> pagesOf(const Context& context, const PlotResultsArguments& arguments) {
  std::vector<report::ReportPage> pages;
  for (const auto& folder : arguments.inputs) {
    ConsoleProgress progress(context.quiet);
    pages.push_back(pages::gatherReport(folder, progress));
    keepMethods(arguments, folder, pages.back());
  }
  return pages;
}

void sayLines(const Context& context, const draw::Chart& chart, const std::string& file) {
  auto lines = nlohmann::ordered_json::array();
  for (const auto& curve : chart.curves)
    if (curve.style == draw::Curve::Style::kLine) lines.push_back(curve.label);
  sayPicture(context, {{"file", file}, {"lines", lines}}, file);
}

int plotMap(const Context& context, const PlotResultsArguments& arguments) {
  const auto [file, paper] = picturePlace(context, *arguments.how, "map.png");
  const auto page = pageOf(context, arguments);
  const auto panels = pages::mapPanels(page, arguments.inputs.front());
  if (panels.size() == 1) {
    auto map = panels.front().map;
    map.T_frame_raster = panels.front().T_world_map * map.T_frame_raster;
    pictures::drawMap(map, panels.front().paths, arguments.title, file, {}, paper);
  } else {
    pictures::drawPanels(panels, file, paper);
  }
  auto methods = nlohmann::ordered_json::array();
  for (const auto& panel : panels) methods.push_back(panel.title);
  sayPicture(context, {{"file", file}, {"methods", methods}}, file);
  return 0;
}

int plotPaths(const Context& context, const PlotResultsArguments& arguments) {
  const auto [file, paper] = picturePlace(context, *arguments.how, "paths.png");
  const auto page = pageOf(context, arguments);
  const auto paths = pages::allPaths(page);
  if (paths.empty())
    throw core::InputError(arguments.inputs.front() + ": holds no path, expected a run that has one");
  const auto plan = page.replays.empty() ? world::Plan{} : page.replays.front().plan.value_or(world::Plan{});
  const auto panels = pages::pathPanels(page);
  constexpr std::size_t kMostPanels = 8;
  if (arguments.is_overlaid || panels.size() < 2 || panels.size() > kMostPanels)
    pictures::drawMap(plan, paths, arguments.title, file, {}, paper);
  else
    pictures::drawPanels(panels, file, paper);
  auto list = nlohmann::ordered_json::array();
  for (const auto& path : paths) list.push_back(path.label);
  sayPicture(context, {{"file", file}, {"paths", list}}, file);
  return 0;
}

int plotErrors(const Context& context, const PlotResultsArguments& arguments) {
  const auto [file, paper] = picturePlace(context, *arguments.how, "errors.png");
  const auto page = pageOf(context, arguments);
  const auto chart = pages::errorChart(page, arguments.inputs.front(), !arguments.is_linear);
  draw::drawCharts({chart}, arguments.title, file, paper);
  auto methods = nlohmann::ordered_json::array();
  for (const auto& curve : chart.curves) methods.push_back(curve.label);
  sayPicture(context, {{"file", file}, {"methods", methods}}, file);
  return 0;
}

int plotCost(const Context& context, const PlotResultsArguments& arguments) {
  const auto [file, paper] = picturePlace(context, *arguments.how, "cost.png");
  const auto chart = pages::costChart(pagesOf(context, arguments), arguments.inputs, !arguments.is_linear);
  draw::drawCharts({chart}, arguments.title, file, paper);
  sayLines(context, chart, file);
  return 0;
}

int plotConsistency(const Context& context, const PlotResultsArguments& arguments) {
  const auto [file, paper] = picturePlace(context, *arguments.how, "consistency.png");
  const auto pages = pagesOf(context, arguments);
  const auto chart = pages::coverageChart(pages, arguments.inputs.front());
  draw::drawCharts({chart}, arguments.title, file, paper);
  sayLines(context, chart, file);
  return 0;
}

/// The file itself, or the one of that name in a folder.
std::string tableIn(const std::string& input, const std::string& name) {
  return std::filesystem::is_directory(input) ? input + "/" + name : input;
}

int plotSeeds(const Context& context, PlotResultsArguments& arguments) {
  const auto [file, paper] = picturePlace(context, *arguments.how, "seeds.png");
  const auto path = tableIn(arguments.inputs.front(), "results.csv");
  arguments.seeds.methods = files::namesIn(arguments.methods, ',');
  const auto charts =
      pages::seedBoxes(table::fromCsv(files::readTextFile(path), path), arguments.seeds, path);
  draw::drawBoxes(charts, draw::axisTitle(arguments.seeds.metric), !arguments.is_linear, arguments.title,
                  file, paper);
  auto list = nlohmann::ordered_json::array();
  for (const auto& chart : charts)
    for (const auto& sample : chart.samples)
      list.push_back({{"chart", chart.title},
                      {"method", sample.label},
                      {"values", sample.values.size()},
                      {"failed", sample.failed}});
  sayPicture(context, {{"file", file}, {"metric", arguments.seeds.metric}, {"boxes", list}}, file);
  return 0;
}

int plotStress(const Context& context, const PlotResultsArguments& arguments) {
  const auto [file, paper] = picturePlace(context, *arguments.how, "stress.png");
  const auto path = tableIn(arguments.inputs.front(), "stress.csv");
  const auto charts = study::stressCharts(table::fromCsv(files::readTextFile(path), path), path);
  draw::drawCharts(charts, arguments.title, file, paper);
  sayPicture(context, {{"file", file}, {"varied", charts.front().x_title}}, file);
  return 0;
}

int plotExploration(const Context& context, const PlotResultsArguments& arguments) {
  const auto [file, paper] = picturePlace(context, *arguments.how, "exploration.png");
  const auto charts = pages::explorationCharts(arguments.inputs);
  draw::drawCharts(charts, arguments.title, file, paper);
  sayPicture(context, {{"file", file}, {"runs", charts.front().curves.size()}}, file);
  return 0;
}

/// A kind of figure: what every one of them has.
CLI::App* addKind(CLI::App& plot, Context& context, const std::shared_ptr<PlotResultsArguments>& arguments,
                  const std::string& name, const std::string& what, const std::string& input,
                  int (*draw)(const Context&, PlotResultsArguments&)) {
  auto* command = plot.add_subcommand(name, what);
  command->add_option("input", arguments->inputs, input)->required()->expected(1);
  command->add_option("--title", arguments->title, "above the picture (default: none)");
  arguments->how = addPicture(command, context, name + ".png");
  command->callback([&context, arguments, draw] {
    context.action = [&context, arguments, draw] { return draw(context, *arguments); };
  });
  return command;
}

template <int (*kDraw)(const Context&, const PlotResultsArguments&)>
int asMutable(const Context& context, PlotResultsArguments& arguments) {
  return kDraw(context, arguments);
}

constexpr const char* kOfRuns = "what 'rasterslam compare', 'run' or 'explore' wrote";

void addMethods(CLI::App* command, const std::shared_ptr<PlotResultsArguments>& arguments) {
  command->add_option("--methods", arguments->methods, "these alone, separated by commas (default: all)");
}

void addLinear(CLI::App* command, const std::shared_ptr<PlotResultsArguments>& arguments) {
  command->add_flag("--linear", arguments->is_linear, "no logarithmic axis");
}

void addMapPlot(CLI::App& plot, Context& context) {
  const auto arguments = std::make_shared<PlotResultsArguments>();
  auto* command =
      addKind(plot, context, arguments, "map", "the map of each method with its path and the true one",
              kOfRuns, asMutable<plotMap>);
  addMethods(command, arguments);
  command->footer(
      "Examples:\n"
      "  rasterslam plot map out -o map.pdf --width 170mm\n"
      "  rasterslam plot map out --methods graph -o graph.svg --width 85mm");
}

void addPathsPlot(CLI::App& plot, Context& context) {
  const auto arguments = std::make_shared<PlotResultsArguments>();
  auto* command = addKind(plot, context, arguments, "paths", "the paths of all methods over the true plan",
                          kOfRuns, asMutable<plotPaths>);
  addMethods(command, arguments);
  command->add_flag("--overlay", arguments->is_overlaid, "all on one plan (default: a plan for each method)");
  command->footer("Example:\n  rasterslam plot paths out -o paths.pdf --width 85mm");
}

void addErrorsPlot(CLI::App& plot, Context& context) {
  const auto arguments = std::make_shared<PlotResultsArguments>();
  auto* command = addKind(plot, context, arguments, "errors", "position error over time, a line per method",
                          kOfRuns, asMutable<plotErrors>);
  addMethods(command, arguments);
  addLinear(command, arguments);
  command->footer("Example:\n  rasterslam plot errors out -o errors.pdf --width 85mm");
}

void addCostPlot(CLI::App& plot, Context& context) {
  const auto arguments = std::make_shared<PlotResultsArguments>();
  auto* command = addKind(plot, context, arguments, "cost", "CPU time a scan over the scans: mean and 99 %",
                          kOfRuns, asMutable<plotCost>);
  command->get_option("input")->expected(1, 100);
  addMethods(command, arguments);
  addLinear(command, arguments);
  command->footer("Example:\n  rasterslam plot cost out -o cost.pdf --width 85mm");
}

void addConsistencyPlot(CLI::App& plot, Context& context) {
  const auto arguments = std::make_shared<PlotResultsArguments>();
  auto* command = addKind(plot, context, arguments, "consistency",
                          "whether covariances are true: the errors that ellipsoids hold and should hold",
                          kOfRuns, asMutable<plotConsistency>);
  command->get_option("input")->expected(1, 100);
  addMethods(command, arguments);
  command->footer(
      "Above the diagonal a method is conservative, below it overconfident. Of three and more folders, "
      "such as runs with other\nseeds, the whiskers at 50 and 95 % are 95 % intervals over the runs.\n"
      "Example:\n  rasterslam plot consistency out -o consistency.pdf --width 85mm");
}

void addSeedsPlot(CLI::App& plot, Context& context) {
  const auto arguments = std::make_shared<PlotResultsArguments>();
  auto* command = addKind(plot, context, arguments, "seeds", "box plots over the seeds of a sweep",
                          "what 'rasterslam bench' wrote, or its results.csv", plotSeeds);
  addMethods(command, arguments);
  addLinear(command, arguments);
  command
      ->add_option("--metric", arguments->seeds.metric,
                   "a column of results.csv: see 'rasterslam list metrics'")
      ->capture_default_str();
  command
      ->add_option("--where", arguments->seeds.where,
                   "KEY=VALUE, runs whose column KEY holds VALUE; repeat for more")
      ->take_all()
      ->expected(1);
  command->footer(
      "Boxes from the lower to the upper quartile with the median; whiskers to the last value within 1.5 "
      "boxes.\n"
      "Examples:\n"
      "  rasterslam plot seeds sweep -o seeds.pdf\n"
      "  rasterslam plot seeds sweep/results.csv --where world=flat --metric wall_f1 --linear -o walls.svg "
      "--width 85mm");
}

void addStressPlot(CLI::App& plot, Context& context) {
  const auto arguments = std::make_shared<PlotResultsArguments>();
  auto* command =
      addKind(plot, context, arguments, "stress", "error and failures over what a stress test varied",
              "what 'rasterslam stress' wrote, or its stress.csv", asMutable<plotStress>);
  command->footer("Example:\n  rasterslam plot stress fov -o fov.pdf --width 170mm");
}

void addExplorationPlot(CLI::App& plot, Context& context) {
  const auto arguments = std::make_shared<PlotResultsArguments>();
  auto* command = addKind(
      plot, context, arguments, "exploration", "explored share over time and over the path",
      "what 'rasterslam explore' wrote; several folders are drawn together", asMutable<plotExploration>);
  command->get_option("input")->expected(1, 100);
  command->footer("Example:\n  rasterslam plot exploration ex1 ex2 -o coverage.pdf --width 170mm");
}

}  // namespace

void addPlotResults(CLI::App& plot, Context& context) {
  for (const auto add : {addMapPlot, addPathsPlot, addErrorsPlot, addCostPlot, addConsistencyPlot,
                         addSeedsPlot, addStressPlot, addExplorationPlot})
    add(plot, context);
}

}  // namespace slam::apps

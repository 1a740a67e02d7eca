#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/posegraph/g2o_io.h"
#include "libslam/posegraph/optimize.h"

namespace slam::apps {
namespace {

using posegraph::EdgeKind;
using posegraph::G2oGraph;

struct Arguments {
  std::string file, robust;
};

nlohmann::ordered_json contentOf(const std::string& file, const G2oGraph& g2o) {
  const auto& graph = g2o.graph;
  std::size_t loops = 0, priors = 0, fixed = 0;
  for (const auto& edge : graph.edges()) {
    priors += edge.from == posegraph::kMap;
    loops += edge.from != posegraph::kMap && edge.kind == EdgeKind::kLoop;
  }
  for (int node = 0; node < graph.nodeCount(); ++node) fixed += graph.isFixed(node);
  core::Trajectory path;
  for (const auto& pose : graph.poses()) path.push_back({static_cast<double>(path.size()), pose});
  return {{"file", file},
          {"nodes", graph.nodeCount()},
          {"fixed", fixed},
          {"odometry_edges", graph.edges().size() - loops - priors},
          {"loop_edges", loops},
          {"priors", priors},
          {"chi2", graph.chi2()},
          {"path_length_m", core::pathLength(path)},
          {"passed_over", g2o.passed_over}};
}

void print(const Context& context, const nlohmann::ordered_json& facts) {
  if (context.json) {
    std::cout << facts.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << "\n";
    return;
  }
  const auto count = [&facts](const char* key) { return facts.at(key).get<unsigned long>(); };
  std::printf("%s: %lu nodes along %.1f m, %lu fixed\n", facts["file"].get<std::string>().c_str(),
              count("nodes"), facts["path_length_m"].get<double>(), count("fixed"));
  std::printf("%lu edges of odometry, %lu loops, %lu priors; chi2 %.6g\n", count("odometry_edges"),
              count("loop_edges"), count("priors"), facts["chi2"].get<double>());
  for (const auto& [tag, lines] : facts["passed_over"].items())
    std::printf("passed over: %lu lines %s\n", lines.get<unsigned long>(), tag.c_str());
}

int info(const Context& context, const Arguments& arguments) {
  print(context, contentOf(arguments.file, posegraph::readG2oFile(arguments.file)));
  return 0;
}

posegraph::OptimizeOptions readOptions(const Context& context, const Arguments& arguments,
                                       std::vector<core::ParameterReport>& report) {
  core::IniFile ini;
  if (!context.config.empty()) ini = core::IniFile::load(context.config);
  for (const auto& setting : context.settings) ini.setFromArgument(setting, "--set");
  const auto& table = posegraph::OptimizeOptions::table();
  if (!arguments.robust.empty()) ini.set(table.section(), "robust", arguments.robust, "--robust");
  core::rejectUnknownSections(ini, {table.section()});
  posegraph::OptimizeOptions options;
  core::readParameters(ini, table, options, &report);
  return options;
}

int optimise(const Context& context, const Arguments& arguments) {
  std::vector<core::ParameterReport> parameters;
  const auto options = readOptions(context, arguments, parameters);
  if (context.print_config) {
    printParameters(parameters, context.json);
    return 0;
  }
  if (context.output.empty())
    throw core::InputError("graph optimise: found no --output, expected a .g2o file to write");
  core::refuseToOverwrite(context.output, context.overwrite);
  auto g2o = posegraph::readG2oFile(arguments.file);
  const auto result = posegraph::optimize(g2o.graph, options);
  posegraph::writeG2oFile(g2o.graph, g2o.ids, context.output);

  auto facts = contentOf(arguments.file, g2o);
  auto switched_off = nlohmann::ordered_json::array();
  for (const int edge : result.switched_off) {
    const auto& loop = g2o.graph.edges()[static_cast<std::size_t>(edge)];
    switched_off.push_back(
        {g2o.ids[static_cast<std::size_t>(loop.from)], g2o.ids[static_cast<std::size_t>(loop.to)]});
  }
  facts["chi2_before"] = result.initial_chi2;
  facts["iterations"] = result.iterations;
  facts["converged"] = result.converged;
  facts["switched_off"] = switched_off;
  facts["output"] = context.output;
  print(context, facts);
  if (!context.json) {
    std::printf("%s in %d iterations from chi2 %.6g; %zu loops switched off\n",
                result.converged ? "optimised" : "NOT converged", result.iterations, result.initial_chi2,
                result.switched_off.size());
    for (const auto& loop : switched_off)
      std::printf("  off: %lld - %lld\n", loop[0].get<long long>(), loop[1].get<long long>());
    std::printf("  %s\n", context.output.c_str());
  }
  return static_cast<int>(result.converged ? core::ExitCode::kOk : core::ExitCode::kMethodFailed);
}

}  // namespace

void addGraph(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("graph", "pose graphs as g2o files: what is in one, and solve it");
  command->require_subcommand(1);
  auto arguments = std::make_shared<Arguments>();

  auto* look = command->add_subcommand("info", "nodes, edges and chi2 of a g2o file");
  look->add_option("file", arguments->file, "VERTEX_SE2, EDGE_SE2, EDGE_PRIOR_SE2 and FIX lines")->required();
  addJson(look, context);
  look->footer("Example:\n  rasterslam graph info intel.g2o");
  look->callback([&context, arguments] {
    context.action = [&context, arguments] { return info(context, *arguments); };
  });

  auto* solve = command->add_subcommand("optimise", "move the nodes to where chi2 is least");
  solve->alias("optimize");
  solve->add_option("file", arguments->file, "a g2o file; edges between consecutive ids are odometry")
      ->required();
  solve->add_option(
      "--robust", arguments->robust,
      "which loops count: none (all do), local (switch off the wrong ones) or global (any start)");
  addConfig(solve, context);
  addOutput(solve, context, "the g2o file to write; loops that are off are left out");
  addJson(solve, context);
  solve->footer(
      "Exit code 4 when it did not converge; what was reached is written all the same.\n"
      "Examples:\n"
      "  rasterslam graph optimise intel.g2o -o solved.g2o\n"
      "  rasterslam graph optimise doubtful.g2o --robust global -o solved.g2o\n"
      "  rasterslam graph optimise a.g2o -o b.g2o --set posegraph.switch_off_chi2=20");
  solve->callback([&context, arguments] {
    context.action = [&context, arguments] { return optimise(context, *arguments); };
  });
}

}  // namespace slam::apps

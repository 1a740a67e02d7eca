#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "apps/help_text.h"
#include "libslam/certified/global.h"
#include "libslam/certified/relaxation.h"
#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/files/files.h"
#include "libslam/posegraph/chaining.h"
#include "libslam/posegraph/g2o_io.h"
#include "libslam/posegraph/optimize.h"
#include "libslam/posegraph/parts.h"
#include "libslam/resources/ini_yaml.h"

namespace slam::apps {
namespace {

using posegraph::EdgeKind;
using posegraph::G2oGraph;

struct GraphArguments {
  std::string file, robust, from = "file";
  bool local = false;
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
          {"parts", posegraph::partsOf(graph).size()},
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
  if (count("parts") > 1) std::printf("%lu parts that no edge ties together\n", count("parts"));
  for (const auto& [tag, lines] : facts["passed_over"].items())
    std::printf("passed over: %lu lines %s\n", lines.get<unsigned long>(), tag.c_str());
}

int info(const Context& context, const GraphArguments& arguments) {
  print(context, contentOf(arguments.file, posegraph::readG2oFile(arguments.file)));
  return 0;
}

posegraph::OptimizeOptions readOptions(const Context& context, const GraphArguments& arguments,
                                       std::vector<files::ParameterReport>& report) {
  files::IniFile ini;
  if (!context.config.empty()) ini = resources::readConfigFile(context.config);
  for (const auto& setting : context.settings) ini.setFromArgument(setting, "--set");
  const auto& table = posegraph::OptimizeOptions::table();
  if (!arguments.robust.empty()) ini.set(table.section(), "robust", arguments.robust, "--robust");
  files::rejectUnknownSections(ini, {table.section()});
  posegraph::OptimizeOptions options;
  files::readParameters(ini, table, options, &report);
  return options;
}

using GraphWriter = void (*)(const posegraph::PoseGraph&, const std::vector<long long>&, const std::string&);

/// By the name of the file. Errors: InputError.
GraphWriter writerFor(const std::string& path) {
  const std::string suffix = std::filesystem::path(path).extension().string();
  if (suffix == ".g2o") return posegraph::writeG2oFile;
  if (suffix == ".graph") return posegraph::writeMrptGraphFile;
  throw core::InputError("--output: found '" + path +
                         "', expected a name that ends in .g2o or .graph (MRPT's)");
}

int convert(const Context& context, const GraphArguments& arguments) {
  if (context.output.empty())
    throw core::InputError("graph convert: found no --output, expected a .g2o or .graph file to write");
  const auto write = writerFor(context.output);
  files::refuseToOverwrite(context.output, context.overwrite);
  const auto g2o = posegraph::readG2oFile(arguments.file);
  write(g2o.graph, g2o.ids, context.output);
  auto facts = contentOf(arguments.file, g2o);
  facts["output"] = context.output;
  print(context, facts);
  if (!context.json) std::printf("  %s\n", context.output.c_str());
  return 0;
}

/// Errors: InputError that names the parts, when something in the graph is held by nothing.
void requireOnePart(const std::string& file, const G2oGraph& g2o) {
  constexpr std::size_t kMostNamed = 5;
  const auto parts = posegraph::partsOf(g2o.graph);
  if (parts.size() == 1) return;
  std::string named;
  for (std::size_t i = 0; i < std::min(parts.size(), kMostNamed); ++i) {
    const auto id = [&](int node) { return std::to_string(g2o.ids[static_cast<std::size_t>(node)]); };
    const auto& part = parts[i];
    named += (i ? ", " : "") + id(part.front()) + (part.size() > 1 ? " to " + id(part.back()) : "") + " (" +
             std::to_string(part.size()) + (part.size() > 1 ? " vertices)" : " vertex)");
  }
  if (parts.size() > kMostNamed) named += " and " + std::to_string(parts.size() - kMostNamed) + " more";
  throw core::InputError(file + ": found " + std::to_string(parts.size()) +
                         " parts that no edge ties together: " + named +
                         "; expected one, or a FIX line or a prior in each");
}

void setStart(posegraph::PoseGraph& graph, const GraphArguments& arguments, std::uint64_t seed) {
  if (arguments.from == "file") return;
  posegraph::startAt(graph, arguments.from == "odometry" ? posegraph::chained(graph)
                            : arguments.from == "random" ? posegraph::scattered(graph, {seed, "start"})
                                                         : certified::relaxedPoses(graph));
}

void printSolved(const nlohmann::ordered_json& facts) {
  std::printf("%s in %d iterations from chi2 %.6g; %zu loops switched off\n",
              facts["converged"].get<bool>() ? "optimised" : "NOT converged", facts["iterations"].get<int>(),
              facts["chi2_before"].get<double>(), facts["switched_off"].size());
  for (const auto& loop : facts["switched_off"])
    std::printf("  off: %lld - %lld\n", loop[0].get<long long>(), loop[1].get<long long>());
  if (facts.contains("globally_optimal")) {
    const char* of_these = facts["switched_off"].empty() ? "" : " with these loops";
    if (facts["globally_optimal"].get<bool>())
      std::printf("globally optimal: no poses have a lower chi2%s\n", of_these);
    else
      std::printf(
          "not certified: no poses are known to have a lower chi2%s, but only less than %.6g is excluded\n",
          of_these, facts["chi2_lower_bound"].get<double>());
  }
  std::printf("  %s\n", facts["output"].get<std::string>().c_str());
}

int optimise(const Context& context, const GraphArguments& arguments) {
  std::vector<files::ParameterReport> parameters;
  const auto options = readOptions(context, arguments, parameters);
  if (context.print_config) {
    printParameters(parameters, context.json);
    return 0;
  }
  if (context.output.empty())
    throw core::InputError("graph optimise: found no --output, expected a .g2o or .graph file to write");
  const auto write = writerFor(context.output);
  files::refuseToOverwrite(context.output, context.overwrite);
  auto g2o = posegraph::readG2oFile(arguments.file);
  requireOnePart(arguments.file, g2o);
  setStart(g2o.graph, arguments, context.seed);
  certified::GlobalResult solved;
  if (arguments.local)
    solved.optimum = posegraph::optimize(g2o.graph, options);
  else
    solved = certified::optimizeGlobally(g2o.graph, options);
  const auto& result = solved.optimum;
  write(g2o.graph, g2o.ids, context.output);

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
  if (!arguments.local) {
    facts["from"] = solved.from_relaxation ? "relaxation" : arguments.from;
    facts["globally_optimal"] = solved.certificate.is_optimal;
    facts["chi2_lower_bound"] = solved.certificate.lower_bound;
  }
  facts["output"] = context.output;
  print(context, facts);
  if (!context.json) printSolved(facts);
  return static_cast<int>(result.converged ? core::ExitCode::kOk : core::ExitCode::kMethodFailed);
}

}  // namespace

void addGraph(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand(
      "graph", "pose graphs as files of g2o or MRPT: what is in one; solve it; convert it");
  command->require_subcommand(1);
  auto arguments = std::make_shared<GraphArguments>();

  auto* look = command->add_subcommand("info", "nodes, edges and chi2 of a .g2o or .graph file");
  look->add_option("file", arguments->file,
                   "a graph as g2o, MRPT or TORO write it; what it holds counts, not its name")
      ->required();
  addJson(look, context);
  look->footer("Example:\n  rasterslam graph info intel.g2o");
  look->callback([&context, arguments] {
    context.action = [&context, arguments] { return info(context, *arguments); };
  });

  auto* change = command->add_subcommand("convert", "write it as g2o or as MRPT's text graph");
  change->add_option("file", arguments->file, "a graph as g2o, MRPT or TORO write it")->required();
  addOutput(change, context, "the file to write: g2o's where it ends in .g2o, MRPT's in .graph");
  addJson(change, context);
  change->footer(
      "A graph of MRPT's has one fixed vertex, its root, no priors, and ids of zero and above.\n"
      "Examples:\n"
      "  rasterslam graph convert intel.g2o -o intel.graph\n"
      "  rasterslam graph convert graphslam_results/output_graph.graph -o engine.g2o");
  change->callback([&context, arguments] {
    context.action = [&context, arguments] { return convert(context, *arguments); };
  });

  auto* solve = command->add_subcommand("optimise", "move the nodes to where chi2 is least, and prove it");
  solve->alias("optimize");
  solve->add_option("file", arguments->file, "a graph's file; edges between consecutive ids are odometry")
      ->required();
  solve->add_option(
      "--robust", arguments->robust,
      "which loops count: none (all do), local (switch off the wrong ones) or global (any start)");
  solve
      ->add_option("--from", arguments->from,
                   "where to start: file, odometry (chained), random (see --seed) or relaxation (all "
                   "headings at once)")
      ->check(oneOf({"file", "odometry", "random", "relaxation"}));
  solve->add_flag("--local", arguments->local,
                  "only down from there: no second start from the relaxation, no certificate");
  addSeed(solve, context);
  addConfig(solve, context);
  addOutput(solve, context, "the .g2o or .graph file to write; loops that are off are left out");
  addJson(solve, context);
  solve->footer(
      "Starts where --from says; where the end is not certified as globally optimal, at the relaxation too.\n"
      "Exit code 4 when it did not converge; what was reached is written all the same.\n"
      "Examples:\n"
      "  rasterslam graph optimise intel.g2o -o solved.g2o\n"
      "  rasterslam graph optimise intel.g2o --from random --seed 3 -o solved.g2o\n"
      "  rasterslam graph optimise doubtful.g2o --robust global -o solved.g2o\n"
      "  rasterslam graph optimise a.g2o -o b.g2o --set posegraph.switch_off_chi2=20");
  solve->callback([&context, arguments] {
    context.action = [&context, arguments] { return optimise(context, *arguments); };
  });
}

}  // namespace slam::apps

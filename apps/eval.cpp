#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "apps/gate_flags.h"
#include "libslam/core/error.h"
#include "libslam/logs/relations_io.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/run/compare.h"
#include "libslam/run/evaluate.h"
#include "libslam/run/failure.h"
#include "libslam/run/relation_tables.h"
#include "libslam/run/resources.h"

namespace slam::apps {
namespace {

struct Arguments {
  std::string folder, truth, plan, relations, align, map_truth;
  GateFlags gate;
};

nlohmann::ordered_json parsed(const report::Table& table) {
  return nlohmann::ordered_json::parse(report::toJson(table));
}

void print(const Context& context, const std::vector<std::pair<std::string, report::Table>>& tables,
           const GateResult& gate) {
  nlohmann::ordered_json json;
  std::string text;
  for (const auto& [name, table] : tables) {
    json[name] = parsed(table);
    text += (text.empty() ? "" : "\n") + tableText(table);
  }
  if (gate.table) {
    json["gate"] = parsed(*gate.table);
    text += "\n" + gateText(*gate.table);
  }
  std::cout << (context.json ? json.dump(2) + "\n" : text);
}

/// Of a run's folder, or of a trajectory by itself.
int evaluateByRelations(const Context& context, const Arguments& arguments) {
  if (!arguments.truth.empty() || !arguments.plan.empty())
    throw core::InputError("--relations: is a truth of its own, expected no --truth and no --plan beside it");
  const auto relations = logs::readRelations(arguments.relations);
  std::vector<run::RelationScore> scores;
  if (std::filesystem::is_directory(arguments.folder))
    scores = run::scoreByRelations(run::loadRun(arguments.folder), relations);
  else
    scores = {{std::filesystem::path(arguments.folder).filename().string(),
               metrics::relationError(relations, logs::readTrajectory(arguments.folder))}};
  if (scores[0].error.scored == 0)
    throw core::InputError(arguments.relations + ": no stamp in common with " + arguments.folder +
                           ", expected the relations of the same log");
  const auto gate = checkGate(context, arguments.gate, run::scoresOf(scores));
  writeGate(context, arguments.gate, run::scoresOf(scores));
  const auto detail = context.json ? run::Detail::kFull : run::Detail::kShort;
  print(context,
        {{"relations", run::relationTable(scores, detail)},
         {"worst", run::worstRelationsTable(relations, scores, detail)}},
        gate);
  return gate.exit_code;
}

const std::vector<std::pair<std::string, metrics::Align>>& alignments() {
  static const std::vector<std::pair<std::string, metrics::Align>> all = {
      {"none", metrics::Align::kNone}, {"first", metrics::Align::kFirst}, {"se2", metrics::Align::kSe2}};
  return all;
}

run::Alignment alignmentOf(const Arguments& arguments, const core::Manifest& manifest) {
  run::Alignment alignment = run::alignmentOf(manifest);
  for (const auto& [name, how] : alignments())
    if (arguments.align == name) alignment.how = how;
  if (arguments.map_truth.empty()) return alignment;
  if (alignment.how != metrics::Align::kNone)
    throw core::InputError("--map-truth: places a known map, expected --align none beside it");
  alignment.T_truth_map = run::mapFrame(manifest, arguments.map_truth);
  return alignment;
}

int evaluateRun(const Context& context, const Arguments& arguments) {
  if (!arguments.relations.empty()) return evaluateByRelations(context, arguments);
  const auto run_folder = run::loadRun(arguments.folder);
  const std::string plan_path = arguments.plan.empty() ? "" : run::resolvePlan(arguments.plan);
  if (arguments.truth.empty() && !plan_path.empty())
    throw core::InputError("--plan needs --truth: without the true path the map cannot be laid on the plan");
  std::optional<run::Truth> truth;
  if (!arguments.truth.empty()) truth = run::loadTruth(arguments.truth, plan_path, run_folder);
  if (!truth && !(arguments.align.empty() && arguments.map_truth.empty()))
    throw core::InputError("--align and --map-truth need --truth");
  const auto evaluation = run::evaluate(run_folder, truth, alignmentOf(arguments, run_folder.manifest));
  if (truth && evaluation.trajectory.position_m.count == 0 && evaluation.trajectory.unmatched > 0)
    throw core::InputError(arguments.truth + ": no stamp in common with " + arguments.folder +
                           "/trajectory.tum, expected the truth of the same log");
  const auto gate = checkGate(context, arguments.gate, run::scoresOf(evaluation));
  writeGate(context, arguments.gate, run::scoresOf(evaluation));
  const auto detail = context.json ? run::Detail::kFull : run::Detail::kShort;
  const auto table =
      truth ? run::accuracyTable({evaluation}, *truth, detail) : run::agreementTable({evaluation}, detail);
  std::vector<std::pair<std::string, report::Table>> tables = {{"scores", table},
                                                               {"cost", run::costTable({evaluation})}};
  if (truth) {
    const auto failure = run::explainFailure(
        run_folder, *truth,
        run::readEvidence(run_folder, arguments.truth, run::logInput(run_folder.manifest)));
    if (failure.divergence || !evaluation.failure.empty())
      tables.emplace_back("failure", run::failureTable(failure, evaluation.method));
  }
  print(context, tables, gate);
  if (truth && evaluation.trajectory.unmatched > 0)
    std::fprintf(stderr,
                 "rasterslam: %zu of %zu poses lie outside the truth's time span and are not scored\n",
                 evaluation.trajectory.unmatched, run_folder.estimate.size());
  return gate.exit_code;
}

}  // namespace

void addEval(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("eval", "score the folder of one run");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("folder", arguments->folder, "what 'rasterslam run' wrote")->required();
  command->add_option("--truth", arguments->truth, "true path: TUM, or MRPT's .GT.txt");
  command->add_option("--plan", arguments->plan,
                      "true plan, to score the map too (needs a TUM truth in the plan's frame)");
  command->add_option(
      "--relations", arguments->relations,
      "relations of the Freiburg benchmark (t1 t2 x y z roll pitch yaw per line): the truth of real "
      "logs; FOLDER may then be a trajectory too. Poses at their stamps: the same stamp to 1 us, else "
      "interpolated "
      "between the neighbours; outside the path's time not scored");
  std::vector<std::string> names;
  for (const auto& [name, how] : alignments()) names.push_back(name);
  command
      ->add_option("--align", arguments->align,
                   "how the path is laid onto the truth: none (a map's own frame), first (at the first pose) "
                   "or se2 (least "
                   "squares); default: none for a run of 'run --localise', else se2")
      ->check(CLI::IsMember(names));
  command->add_option(
      "--map-truth", arguments->map_truth,
      "align none: true path of the run that made the map, if the map's frame is not the truth's");
  addGateFlags(command, arguments->gate);
  command->add_flag("--overwrite", context.overwrite,
                    "with --write-gate: replace this method's values; its tolerances stay");
  addJson(command, context);
  command->footer(
      "Examples:\n"
      "  rasterslam eval out --truth run.gt.tum\n"
      "  rasterslam eval out --truth run.gt.tum --plan flat --json\n"
      "  rasterslam eval out --truth run.gt.tum --plan flat --write-gate baseline.json\n"
      "  rasterslam eval out --truth run.gt.tum --plan flat --gate baseline.json\n"
      "  rasterslam eval found --truth tuesday.gt.tum --map-truth monday.gt.tum\n"
      "  rasterslam eval path.tum --relations intel.relations");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return evaluateRun(context, *arguments); };
  });
}

}  // namespace slam::apps

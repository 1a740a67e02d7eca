#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "libslam/core/error.h"
#include "libslam/logs/relations_io.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/run/compare.h"
#include "libslam/run/evaluate.h"
#include "libslam/run/failure.h"
#include "libslam/run/gate.h"
#include "libslam/run/relation_tables.h"
#include "libslam/run/resources.h"

namespace slam::apps {
namespace {

struct Arguments {
  std::string folder, truth, plan, relations, gate, write_gate;
};

nlohmann::ordered_json parsed(const report::Table& table) {
  return nlohmann::ordered_json::parse(report::toJson(table));
}

/// What was measured, held against --gate.
struct GateResult {
  std::optional<report::Table> table;
  int exit_code = 0;
};

GateResult checkGate(const Context& context, const Arguments& arguments,
                     const std::vector<run::Score>& scores) {
  if (arguments.gate.empty()) return {};
  const auto gate = run::rowsOfMeasured(run::readGate(arguments.gate), scores, arguments.gate);
  const auto findings = run::checkGate(gate, scores);
  const auto detail = context.json ? run::Detail::kFull : run::Detail::kShort;
  const auto code = run::gateIsShut(findings) ? core::ExitCode::kGotWorse : core::ExitCode::kOk;
  return {run::gateTable(findings, arguments.gate, detail), static_cast<int>(code)};
}

/// Rows of other methods stay, so that one file can hold several runs.
void writeGate(const Context& context, const Arguments& arguments, const std::vector<run::Score>& scores) {
  if (arguments.write_gate.empty()) return;
  run::Gate old;
  if (std::filesystem::exists(arguments.write_gate)) old = run::readGate(arguments.write_gate);
  for (const auto& row : old.rows)
    for (const auto& score : scores)
      if (row.baseline.cell == score.cell && !context.overwrite)
        throw core::InputError(arguments.write_gate + ": holds rows of '" + score.cell +
                               "'; give --overwrite to replace their values");
  run::writeGate(run::updatedGate(old, scores), arguments.write_gate);
}

void print(const Context& context, std::vector<std::pair<std::string, report::Table>> tables,
           const GateResult& gate) {
  if (gate.table && (context.json || !gate.table->rows.empty())) tables.emplace_back("gate", *gate.table);
  nlohmann::ordered_json json;
  std::string text;
  for (const auto& [name, table] : tables) {
    json[name] = parsed(table);
    text += (text.empty() ? "" : "\n") + tableText(table);
  }
  if (gate.table && gate.table->rows.empty())
    for (const auto& note : gate.table->notes) text += "\n" + note + "\n";
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
  const auto gate = checkGate(context, arguments, run::scoresOf(scores));
  writeGate(context, arguments, run::scoresOf(scores));
  const auto detail = context.json ? run::Detail::kFull : run::Detail::kShort;
  print(context,
        {{"relations", run::relationTable(scores, detail)},
         {"worst", run::worstRelationsTable(relations, scores, detail)}},
        gate);
  return gate.exit_code;
}

int evaluateRun(const Context& context, const Arguments& arguments) {
  if (!arguments.relations.empty()) return evaluateByRelations(context, arguments);
  const auto run_folder = run::loadRun(arguments.folder);
  const std::string plan_path = arguments.plan.empty() ? "" : run::resolvePlan(arguments.plan);
  if (arguments.truth.empty() && !plan_path.empty())
    throw core::InputError("--plan needs --truth: without the true path the map cannot be laid on the plan");
  std::optional<run::Truth> truth;
  if (!arguments.truth.empty()) truth = run::loadTruth(arguments.truth, plan_path, run_folder);
  const auto evaluation = run::evaluate(run_folder, truth);
  if (truth && evaluation.trajectory.position_m.count == 0)
    throw core::InputError(arguments.truth + ": no stamp in common with " + arguments.folder +
                           "/trajectory.tum, expected the truth of the same log");
  const auto gate = checkGate(context, arguments, run::scoresOf(evaluation));
  writeGate(context, arguments, run::scoresOf(evaluation));
  const auto detail = context.json ? run::Detail::kFull : run::Detail::kShort;
  const auto table =
      truth ? run::accuracyTable({evaluation}, *truth, detail) : run::agreementTable({evaluation}, detail);
  std::vector<std::pair<std::string, report::Table>> tables = {{"scores", table},
                                                               {"cost", run::costTable({evaluation})}};
  if (truth) {
    const auto& inputs = run_folder.manifest.inputs;
    const std::string log = inputs.empty() ? "" : inputs.begin()->first;
    const auto failure =
        run::explainFailure(run_folder, *truth, run::readEvidence(run_folder, arguments.truth, log));
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
  auto* gate = command->add_option(
      "--gate", arguments->gate,
      "baseline to hold the scores against, as --write-gate writes it; exit code 5 and a table of the "
      "figures that got worse");
  command
      ->add_option("--write-gate", arguments->write_gate,
                   "write the scores as a baseline, or add them to one that has none of this method; "
                   "tolerances (10 % and one unit of the last digit shown) are there to be edited")
      ->excludes(gate);
  command->add_flag("--overwrite", context.overwrite,
                    "with --write-gate: replace this method's values; its tolerances stay");
  addJson(command, context);
  command->footer(
      "Examples:\n"
      "  rasterslam eval out --truth run.gt.tum\n"
      "  rasterslam eval out --truth run.gt.tum --plan flat --json\n"
      "  rasterslam eval out --truth run.gt.tum --plan flat --write-gate baseline.json\n"
      "  rasterslam eval out --truth run.gt.tum --plan flat --gate baseline.json\n"
      "  rasterslam eval path.tum --relations intel.relations");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return evaluateRun(context, *arguments); };
  });
}

}  // namespace slam::apps

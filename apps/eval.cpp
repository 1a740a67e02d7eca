#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "apps/gate_flags.h"
#include "apps/help_text.h"
#include "apps/quiet.h"
#include "libslam/core/error.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/resources/resources.h"
#include "libslam/score/compare.h"
#include "libslam/score/evaluate.h"
#include "libslam/score/failure.h"
#include "libslam/score/path_score.h"
#include "libslam/score/relation_tables.h"

namespace slam::apps {
namespace {

struct EvalArguments {
  std::string folder, truth, plan, relations, align, map_truth, rpe;
  GateFlags gate;
};

nlohmann::ordered_json parsed(const table::Table& table) {
  return nlohmann::ordered_json::parse(table::toJson(table));
}

void print(const Context& context, const std::vector<std::pair<std::string, table::Table>>& tables,
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
int evaluateByRelations(const Context& context, const EvalArguments& arguments) {
  if (!arguments.truth.empty() || !arguments.plan.empty())
    throw core::InputError("--relations: is a truth of its own, expected no --truth and no --plan beside it");
  const auto relations = logs::readRelations(arguments.relations);
  std::vector<score::RelationScore> scores;
  if (std::filesystem::is_directory(arguments.folder))
    scores = score::scoreByRelations(results::loadRun(arguments.folder), relations);
  else
    scores = {{std::filesystem::path(arguments.folder).filename().string(),
               metrics::relationError(relations, logs::readTrajectory(arguments.folder))}};
  if (scores[0].error.scored == 0)
    throw core::InputError(arguments.relations + ": no stamp in common with " + arguments.folder +
                           ", expected the relations of the same log");
  const auto gate = checkGate(context, arguments.gate, score::scoresOf(scores));
  writeGate(context, arguments.gate, score::scoresOf(scores));
  const auto detail = context.json ? score::Detail::kFull : score::Detail::kShort;
  print(context,
        {{"relations", score::relationTable(scores, detail)},
         {"worst", score::worstRelationsTable(relations, scores, detail)}},
        gate);
  return gate.exit_code;
}

const std::vector<std::pair<std::string, metrics::Align>>& alignments() {
  static const std::vector<std::pair<std::string, metrics::Align>> all = {
      {"none", metrics::Align::kNone}, {"first", metrics::Align::kFirst}, {"se2", metrics::Align::kSe2}};
  return all;
}

score::Alignment alignmentOf(const EvalArguments& arguments, const resources::Manifest& manifest) {
  score::Alignment alignment = score::alignmentOf(manifest);
  for (const auto& [name, how] : alignments())
    if (arguments.align == name) alignment.how = how;
  if (arguments.map_truth.empty()) return alignment;
  if (alignment.how != metrics::Align::kNone)
    throw core::InputError("--map-truth: places a known map, expected --align none beside it");
  alignment.T_truth_map = score::mapFrame(manifest, arguments.map_truth);
  return alignment;
}

/// A run's folder, or a trajectory by itself, which has neither map nor cost.
results::RunFolder loadRunOrPath(const std::string& path) {
  if (std::filesystem::is_directory(path) || !std::filesystem::exists(path)) return results::loadRun(path);
  results::RunFolder run;
  run.path = path;
  run.method = std::filesystem::path(path).stem().string();
  run.estimate = logs::readTrajectory(path);
  return run;
}

/// A truth of another drive with the same stamps gives figures, too; simulations all begin at the same time.
void warnOfOtherTruth(const Context& context, const core::Trajectory& truth, const core::Trajectory& estimate,
                      const std::string& truth_path) {
  const double agreement = score::motionAgreement(truth, estimate);
  if (agreement < score::kLeastMotionAgreement)
    note(context, "warning: " + truth_path +
                      ": is it of another run? The poses do not move when it does (correlation " +
                      files::formatNumber(std::round(100 * agreement) / 100) + ")");
}

int evaluatePath(const Context& context, const EvalArguments& arguments, const results::RunFolder& path) {
  if (arguments.truth.empty())
    throw core::InputError(arguments.folder +
                           ": is a file, expected a run's folder, or --truth or --relations beside it");
  if (!arguments.plan.empty())
    throw core::InputError("--plan scores a map, and " + arguments.folder + " is a path alone");
  if (!arguments.gate.gate.empty() || !arguments.gate.write_gate.empty())
    throw core::InputError("--gate and --write-gate hold runs, and " + arguments.folder + " is a path alone");
  const auto truth = score::loadTruth(arguments.truth, "", path).trajectory;
  const auto alignment = alignmentOf(arguments, resources::Manifest());
  std::vector<std::pair<std::string, table::Table>> tables = {
      {"scores", score::pathTable(arguments.folder, truth, path.estimate, alignment)},
      {"rpe",
       score::rpeTable(truth, path.estimate,
                       score::parseRpeSteps(arguments.rpe.empty() ? "1m,1s" : arguments.rpe, "--rpe"))}};
  print(context, tables, {});
  warnOfOtherTruth(context, truth, path.estimate, arguments.truth);
  return 0;
}

int evaluateRun(const Context& context, const EvalArguments& arguments) {
  if (!arguments.relations.empty()) return evaluateByRelations(context, arguments);
  const auto run_folder = loadRunOrPath(arguments.folder);
  if (run_folder.path == arguments.folder && !std::filesystem::is_directory(arguments.folder))
    return evaluatePath(context, arguments, run_folder);
  const std::string plan_path = arguments.plan.empty() ? "" : resources::resolvePlan(arguments.plan);
  if (arguments.truth.empty() && !plan_path.empty())
    throw core::InputError("--plan needs --truth: without the true path the map cannot be laid on the plan");
  std::optional<score::Truth> truth;
  if (!arguments.truth.empty()) truth = score::loadTruth(arguments.truth, plan_path, run_folder);
  if (!truth && !arguments.rpe.empty()) throw core::InputError("--rpe needs --truth");
  if (!arguments.rpe.empty()) score::parseRpeSteps(arguments.rpe, "--rpe");
  if (!truth && !(arguments.align.empty() && arguments.map_truth.empty()))
    throw core::InputError("--align and --map-truth need --truth");
  const auto evaluation = score::evaluate(run_folder, truth, alignmentOf(arguments, run_folder.manifest));
  if (truth && evaluation.trajectory.position_m.count == 0 && evaluation.trajectory.unmatched > 0)
    throw core::InputError(arguments.truth + ": no stamp in common with " + arguments.folder +
                           "/trajectory.tum, expected the truth of the same log");
  const auto gate = checkGate(context, arguments.gate, score::scoresOf(evaluation));
  writeGate(context, arguments.gate, score::scoresOf(evaluation));
  const auto detail = context.json ? score::Detail::kFull : score::Detail::kShort;
  const auto table = truth ? score::accuracyTable({evaluation}, *truth, detail)
                           : score::agreementTable({evaluation}, detail);
  std::vector<std::pair<std::string, table::Table>> tables = {{"scores", table},
                                                              {"cost", score::costTable({evaluation})}};
  if (truth) {
    const auto failure = score::explainFailure(
        run_folder, *truth,
        score::readEvidence(run_folder, arguments.truth, results::logInput(run_folder.manifest)));
    if (failure.divergence || !evaluation.failure.empty())
      tables.emplace_back("failure", score::failureTable(failure, evaluation.method));
  }
  if (truth && !arguments.rpe.empty())
    tables.emplace_back("rpe", score::rpeTable(truth->trajectory, run_folder.estimate,
                                               score::parseRpeSteps(arguments.rpe, "--rpe")));
  print(context, tables, gate);
  if (truth) warnOfOtherTruth(context, truth->trajectory, run_folder.estimate, arguments.truth);
  if (truth && evaluation.trajectory.unmatched > 0)
    note(context, std::to_string(evaluation.trajectory.unmatched) + " of " +
                      std::to_string(run_folder.estimate.size()) +
                      " poses lie outside the truth's time span and are not scored");
  return gate.exit_code;
}

}  // namespace

void addEval(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("eval", "score the folder of one run, or a path by itself");
  auto arguments = std::make_shared<EvalArguments>();
  command->add_option("folder", arguments->folder, "what 'rasterslam run' wrote, or a path: TUM")->required();
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
      ->check(oneOf(names));
  command->add_option(
      "--map-truth", arguments->map_truth,
      "align none: true path of the run that made the map, if the map's frame is not the truth's");
  command->add_option(
      "--rpe", arguments->rpe,
      "relative pose error over these distances and times as well: 1m,10m,1s (a path by itself: 1m,1s)");
  addGateFlags(command, arguments->gate);
  command->add_flag("--overwrite", context.overwrite,
                    "with --write-gate: replace this method's values; its tolerances stay");
  addQuiet(command, context);
  addJson(command, context);
  command->footer(
      "Examples:\n"
      "  rasterslam eval out --truth run.gt.tum\n"
      "  rasterslam eval out --truth run.gt.tum --plan flat --json\n"
      "  rasterslam eval out --truth run.gt.tum --plan flat --write-gate baseline.json\n"
      "  rasterslam eval out --truth run.gt.tum --plan flat --gate baseline.json\n"
      "  rasterslam eval path.tum --truth run.gt.tum --rpe 1m,10m,1s\n"
      "  rasterslam eval found --truth tuesday.gt.tum --map-truth monday.gt.tum\n"
      "  rasterslam eval path.tum --relations intel.relations");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return evaluateRun(context, *arguments); };
  });
}

}  // namespace slam::apps

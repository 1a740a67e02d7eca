#include "apps/gate_flags.h"

#include <filesystem>
#include <set>

#include "apps/console.h"
#include "libslam/core/error.h"

namespace slam::apps {
namespace {

/// What is in the file of --write-gate; nothing when there is none yet.
score::Gate readOldGate(const Context& context, const std::string& path,
                        const std::vector<score::Score>& scores) {
  if (!std::filesystem::exists(path)) return {};
  auto old = score::readGate(path);
  std::set<std::string> cells;
  for (const auto& score : scores) cells.insert(score.cell);
  for (const auto& row : old.rows)
    if (cells.count(row.baseline.cell) > 0 && !context.overwrite)
      throw core::InputError(path + ": holds rows of '" + row.baseline.cell +
                             "'; give --overwrite to replace their values");
  return old;
}

}  // namespace

void addGateFlags(CLI::App* command, GateFlags& flags) {
  auto* gate = command->add_option(
      "--gate", flags.gate,
      "baseline to hold the scores against, as --write-gate writes it; exit code 5 and a table of the "
      "figures that got worse");
  command
      ->add_option("--write-gate", flags.write_gate,
                   "write the scores as a baseline, or add them to one that has none of this method; "
                   "tolerances (10 % and one unit of the last digit shown) are there to be edited")
      ->excludes(gate);
}

GateResult checkGate(const Context& context, const GateFlags& flags,
                     const std::vector<score::Score>& scores) {
  if (flags.gate.empty()) return {};
  const auto gate = score::rowsOfMeasured(score::readGate(flags.gate), scores, flags.gate);
  const auto findings = score::checkGate(gate, scores);
  const auto detail = context.json ? score::Detail::kFull : score::Detail::kShort;
  const auto code = score::gateIsShut(findings) ? core::ExitCode::kGotWorse : core::ExitCode::kOk;
  return {score::gateTable(findings, flags.gate, detail), static_cast<int>(code)};
}

void requireUsableGate(const Context& context, const GateFlags& flags,
                       const std::vector<score::Score>& scores) {
  if (!flags.gate.empty()) score::rowsOfMeasured(score::readGate(flags.gate), scores, flags.gate);
  if (!flags.write_gate.empty()) readOldGate(context, flags.write_gate, scores);
}

void writeGate(const Context& context, const GateFlags& flags, const std::vector<score::Score>& scores) {
  if (flags.write_gate.empty()) return;
  score::writeGate(score::updatedGate(readOldGate(context, flags.write_gate, scores), scores),
                   flags.write_gate);
}

std::string gateText(const table::Table& table) {
  if (!table.rows.empty()) return tableText(table);
  std::string text;
  for (const auto& note : table.notes) text += note + "\n";
  return text;
}

}  // namespace slam::apps

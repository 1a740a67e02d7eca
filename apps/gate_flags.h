#pragma once
#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/commands.h"
#include "libslam/score/gate.h"
#include "libslam/table/table.h"

namespace slam::apps {

/// --gate and --write-gate, which exclude each other; "" where they are not given.
struct GateFlags {
  std::string gate, write_gate;
};
void addGateFlags(CLI::App* command, GateFlags& flags);

/// What was measured, held against --gate; no table without it.
struct GateResult {
  std::optional<table::Table> table;
  int exit_code = 0;  ///< of kOk and kGotWorse
};
GateResult checkGate(const Context& context, const GateFlags& flags, const std::vector<score::Score>& scores);

/// The same errors that checkGate() and writeGate() will have, before anything is measured: of `scores` only
/// the names count.
void requireUsableGate(const Context& context, const GateFlags& flags,
                       const std::vector<score::Score>& scores);

/// Into --write-gate, where it is given. Rows of other cells stay, so that one file can hold several runs.
/// Errors: InputError when it holds rows of these cells already, unless --overwrite is given.
void writeGate(const Context& context, const GateFlags& flags, const std::vector<score::Score>& scores);

/// For people: the table, or where no row is worth one its notes.
std::string gateText(const table::Table& table);

}  // namespace slam::apps

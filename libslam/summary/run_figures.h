#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libslam/stats/paired.h"
#include "libslam/sweep/cell.h"
#include "libslam/sweep/sweep_plan.h"
#include "libslam/table/table.h"

namespace slam::summary {

/// The results of a sweep's runs, results[i] of plan.runs[i]; none where the run is missing.
using SweepResults = std::vector<std::optional<sweep::CellResult>>;

/// A run that gave no usable path: its status is not ok, or it ended farther off than the suite allows
/// (failure_ate_m).
bool isFailed(const sweep::SweepPlan& plan, const sweep::CellResult& result);
/// The figures that a run may have, in the order of the tables; none that depends on the machine.
std::vector<table::Column> figureColumns();
std::vector<std::string> figureKeys();
/// The title of a figure and how many decimals people see. REQUIRES a key of figureKeys() (ContractError).
table::Column figureColumn(const std::string& key);
/// Those that the summary shows, the suite's metric first.
std::vector<std::string> summaryKeys(const sweep::SweepPlan& plan);
/// NaN where there is no such figure.
double figureOf(const sweep::CellResult& result, const std::string& key);
/// Of a suite's metric.
stats::Better betterOf(const std::string& metric);
/// The suite's metric of a run, of a failed one stats::failedValue(); NaN where it is missing or has no such
/// figure.
double rankedValue(const sweep::SweepPlan& plan, const std::optional<sweep::CellResult>& result);
/// "0.012 [0.008, 0.020]"; from 100000 on as 1.2e+05; "-" for NaN, "failed" for infinity.
std::string withInterval(const stats::Estimate& estimate, int decimals);

}  // namespace slam::summary

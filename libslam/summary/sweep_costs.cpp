#include "libslam/summary/sweep_costs.h"

#include <cmath>
#include <limits>

#include "libslam/stats/bootstrap.h"
#include "libslam/summary/sweep_groups.h"

namespace slam::summary {
namespace {

struct CostColumn {
  const char *key, *title;
  int decimals;
  double sweep::CellCost::*member;
};
const std::vector<CostColumn>& costColumns() {
  static const std::vector<CostColumn> list = {
      {"ms_per_scan", "ms/scan", 3, &sweep::CellCost::mean_ms_per_scan},
      {"p99_ms", "p99 ms", 3, &sweep::CellCost::p99_ms_per_scan},
      {"peak_memory_mb", "MB", 1, &sweep::CellCost::peak_memory_mb},
      {"cpu_s", "process CPU s", 2, &sweep::CellCost::cpu_s},
      {"wall_s", "by the clock s", 2, &sweep::CellCost::wall_s}};
  return list;
}

}  // namespace

table::Table sweepCostTable(const sweep::SweepPlan& plan, const std::vector<sweep::CellCost>& costs) {
  table::Table table;
  table.caption = "Time and memory of every run";
  table.columns = {{"run", "run", 0}, {"method", "method", 0}};
  for (const auto& column : costColumns())
    table.columns.push_back({column.key, column.title, column.decimals});
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    std::vector<table::CellValue> row = {plan.runs[i].id, fullName(plan.runs[i])};
    for (const auto& column : costColumns()) row.emplace_back(costs[i].*column.member);
    table.rows.push_back(std::move(row));
  }
  return table;
}

table::Table sweepCostSummary(const sweep::SweepPlan& plan, const std::vector<sweep::CellCost>& costs) {
  table::Table table;
  table.caption = "Cost on this machine, medians over all runs";
  table.columns = {{"method", "method", 0}};
  for (const auto& column : costColumns())
    table.columns.push_back({column.key, column.title, column.decimals});
  for (const auto& name : methodNames(plan)) {
    std::vector<table::CellValue> row = {name};
    for (const auto& column : costColumns()) {
      std::vector<double> values;
      for (std::size_t i = 0; i < costs.size(); ++i)
        if (fullName(plan.runs[i]) == name && std::isfinite(costs[i].*column.member))
          values.push_back(costs[i].*column.member);
      row.emplace_back(values.empty() ? std::numeric_limits<double>::quiet_NaN() : stats::median(values));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace slam::summary

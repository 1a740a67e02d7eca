#include "libslam/summary/sweep_brief.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "libslam/core/error.h"
#include "libslam/summary/sweep_groups.h"

namespace slam::summary {
namespace {

std::size_t columnOf(const table::Table& table, const std::string& key) {
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    if (table.columns[c].key == key) return c;
  throw core::ContractError("table '" + table.caption + "' has no column '" + key + "'");
}

double numberIn(const table::Table& table, std::size_t row, const std::string& key) {
  return std::get<double>(table.rows[row][columnOf(table, key)]);
}

/// Whether the first row is the worse one. Rows of `all`, one per setting; a median that is not there is no
/// worse than any.
bool isWorse(const sweep::SweepPlan& plan, const table::Table& all, std::size_t one, std::size_t other) {
  const double rate = numberIn(all, one, "failure_rate"), other_rate = numberIn(all, other, "failure_rate");
  if (rate != other_rate) return rate > other_rate;
  const double value = numberIn(all, one, plan.metric), other_value = numberIn(all, other, plan.metric);
  if (std::isnan(value) || std::isnan(other_value)) return std::isnan(other_value) && !std::isnan(value);
  return betterOf(plan.metric) == stats::Better::kLarger ? value < other_value : value > other_value;
}

std::string settingText(const table::Table& main, std::size_t row, std::size_t axes) {
  std::string text;
  for (std::size_t c = 0; c < axes; ++c)
    text += (c > 0 ? ", " : "") + std::get<std::string>(main.rows[row][c]);
  return text;
}

}  // namespace

SweepBrief briefOf(const sweep::SweepPlan& plan, const SweepSummary& summary) {
  const auto& main = summary.main;
  const std::size_t axes = varyingAxes(plan).size();
  SweepBrief brief{main, {}};
  if (axes == 0) return brief;
  const std::size_t methods = methodNames(plan).size();
  auto& overall = brief.overall;
  overall.caption += "; all settings together";
  overall.rows.resize(methods);
  overall.columns.erase(overall.columns.begin(), overall.columns.begin() + static_cast<std::ptrdiff_t>(axes));
  for (auto& row : overall.rows) row.erase(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(axes));

  const std::size_t settings = main.rows.size() / methods - 1;
  const std::size_t failed = columnOf(main, "failed"), metric = columnOf(main, plan.metric);
  brief.worst.caption = "The worst of " + std::to_string(settings) + " settings, by method";
  brief.worst.columns = {
      {"method", "method", 0}, {"setting", "setting", 0}, main.columns[failed], main.columns[metric]};
  for (std::size_t m = 0; m < methods; ++m) {
    std::size_t worst = 0;  // the row of all together stands for none
    for (std::size_t row = methods + m; row < main.rows.size(); row += methods)
      if (numberIn(summary.all, row, "runs") > 0 && (worst == 0 || isWorse(plan, summary.all, row, worst)))
        worst = row;
    if (worst == 0) continue;
    brief.worst.rows.push_back({main.rows[worst][columnOf(main, "method")], settingText(main, worst, axes),
                                main.rows[worst][failed], main.rows[worst][metric]});
  }
  return brief;
}

}  // namespace slam::summary

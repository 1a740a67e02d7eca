#include "libslam/summary/sweep_failures.h"

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "libslam/core/numbers.h"
#include "libslam/files/parameters.h"
#include "libslam/files/word_wrap.h"
#include "libslam/score/failure.h"
#include "libslam/summary/sweep_groups.h"

namespace slam::summary {
namespace fs = std::filesystem;
namespace {

using core::kNaN;

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const auto& part : parts) text += (text.empty() ? "" : "; ") + part;
  return text;
}

std::string whereOf(const score::FailureReport& report) {
  if (!report.divergence) return "no divergence";
  char text[120];
  const auto& d = *report.divergence;
  std::snprintf(text, sizeof text, "%s at %.1f s, (%.2f, %.2f)",
                d.kind == score::Divergence::kJump ? "jump" : "drift", d.time_s, d.place.x, d.place.y);
  return text;
}

SweepFailures emptyTables() {
  SweepFailures tables;
  tables.main.columns = {{"run", "run", 0},           {"method", "method", 0},
                         {"seed", "seed", 0},         {"status", "status", 0},
                         {"ate_final_m", "ATE m", 2}, {"where", "first divergence", 0},
                         {"suspect", "suspect", 0}};
  for (const std::string& key : files::words(
           "run world lidar odometry strategy fault seed method parameters status message ate_final_m "
           "divergence time_s x_m y_m error_m error_deg suspect around wrong_loops worst_region_x_m "
           "worst_region_y_m missing_wall_m false_wall_m folder"))
    tables.all.columns.push_back({key, key, 3});
  return tables;
}

/// A row of SweepFailures::all. report: none where the run left no path.
std::vector<table::CellValue> fullRow(const sweep::PlannedRun& run, const sweep::PlannedLog& log,
                                      const sweep::CellResult& result, const std::string& suspect,
                                      const std::optional<score::FailureReport>& report) {
  std::vector<table::CellValue> row = {run.id,
                                       log.world,
                                       log.lidar,
                                       log.odometry,
                                       log.strategy,
                                       log.fault,
                                       std::to_string(run.seed),
                                       run.method,
                                       run.parameters,
                                       result.status,
                                       result.message,
                                       figureOf(result, "ate_final_m")};
  if (report && report->divergence) {
    const auto& d = *report->divergence;
    row.insert(row.end(), {d.kind == score::Divergence::kJump ? "jump" : "drift", d.time_s, d.place.x,
                           d.place.y, d.error_m, core::radToDeg(d.error_rad)});
  } else {
    row.insert(row.end(), {"-", kNaN, kNaN, kNaN, kNaN, kNaN});
  }
  row.insert(row.end(), {suspect, report ? joined(report->around) : "",
                         report ? static_cast<double>(report->wrong_loops.size()) : kNaN});
  if (report && report->region)
    row.insert(row.end(), {report->region->centre.x, report->region->centre.y, report->region->missing_wall_m,
                           report->region->false_wall_m});
  else
    row.insert(row.end(), {kNaN, kNaN, kNaN, kNaN});
  row.emplace_back("cells/" + run.id);
  return row;
}

}  // namespace

SweepFailures sweepFailures(const sweep::SweepPlan& plan, const SweepResults& results,
                            const std::string& folder) {
  SweepFailures tables = emptyTables();
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    if (!results[i]) continue;
    const auto& result = *results[i];
    const bool was_off = figureOf(result, "ate_max_m") > score::FailureLimits().drift_m;
    if (!isFailed(plan, result) && !was_off) continue;
    const auto& run = plan.runs[i];
    const std::string path = folder + "/cells/" + run.id + "/failure.json";
    std::optional<score::FailureReport> report;
    if (fs::exists(path)) report = score::readFailure(path);
    const std::string suspect = report && report->divergence ? report->suspect : "-";
    tables.main.rows.push_back({run.id, fullName(run), std::to_string(run.seed), result.status,
                                figureOf(result, "ate_final_m"), report ? whereOf(*report) : result.message,
                                suspect});
    tables.all.rows.push_back(fullRow(run, plan.logs[run.log], result, suspect, report));
  }
  for (auto* table : {&tables.main, &tables.all}) {
    table->caption = "Where and why runs of sweep " + plan.name + " failed or were more than " +
                     files::formatNumber(score::FailureLimits().drift_m) + " m off";
    if (table->rows.empty()) table->notes.emplace_back("None did.");
  }
  return tables;
}

}  // namespace slam::summary

#include "libslam/summary/sweep_merge.h"

#include <unistd.h>

#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/summary/sweep_consistency.h"
#include "libslam/summary/sweep_costs.h"
#include "libslam/summary/sweep_failures.h"
#include "libslam/summary/sweep_index.h"
#include "libslam/summary/sweep_tables.h"
#include "libslam/sweep/cell.h"
#include "libslam/table/latex.h"

namespace slam::summary {
namespace fs = std::filesystem;
namespace {

sweep::SweepPlan commonPlan(const std::vector<std::string>& folders) {
  const auto pathOf = [](const std::string& folder) { return folder + "/plan.json"; };
  for (const auto& folder : folders)
    if (!fs::exists(pathOf(folder)))
      throw core::InputError(folder + ": is not the folder of a sweep (no plan.json)");
  auto plan = sweep::readSweepPlan(pathOf(folders.front()));
  for (const auto& folder : folders)
    if (!sweep::areSame(sweep::readSweepPlan(pathOf(folder)), plan))
      throw core::InputError(folder + ": is of another sweep than " + folders.front() +
                             " (their plan.json differ)");
  return plan;
}

/// Puts a whole cell into another folder: linked where the disk is the same.
void bringOver(const std::string& from, const std::string& to) {
  const std::string beside = to + ".tmp" + std::to_string(getpid());
  std::error_code error;
  fs::remove_all(beside, error);
  fs::copy(from, beside, fs::copy_options::recursive | fs::copy_options::create_hard_links, error);
  if (error) {
    fs::remove_all(beside, error);
    fs::copy(from, beside, fs::copy_options::recursive, error);
  }
  if (!error) fs::rename(beside, to, error);
  if (!error) return;
  std::error_code ignored;
  fs::remove_all(beside, ignored);
  throw core::IoError(to + ": cannot be written: " + error.message());
}

class Merger {
 public:
  explicit Merger(const MergeRequest& request) : request_(request) {}

  /// The cell's result, which then is in the output; none when no folder has it whole.
  std::optional<sweep::CellResult> collect(const std::string& id) {
    const std::string target = request_.output + "/cells/" + id;
    std::optional<sweep::CellResult> found;
    std::string found_in, damage;
    bool target_is_whole = false;
    for (const auto& folder : request_.folders) {
      const std::string cell = folder + "/cells/" + id;
      auto state = sweep::readCell(cell, id, request_.check_bytes);
      if (state.kind == sweep::CellState::kDamaged) damage += "; " + state.reason;
      if (state.kind != sweep::CellState::kComplete) continue;
      target_is_whole = target_is_whole || (fs::exists(target) && fs::equivalent(cell, target));
      if (found)
        requireEqual(id, found_in, cell);
      else
        found = std::move(state.result), found_in = cell;
    }
    if (!found)
      missing_.push_back("cell " + id + ": " + (damage.empty() ? "is missing" : damage.substr(2)));
    else if (!target_is_whole) {
      fs::remove_all(target);  // damaged, or not there
      bringOver(found_in, target);
    }
    return found;
  }

  std::vector<std::string> takeMissing() { return std::move(missing_); }

 private:
  static void requireEqual(const std::string& id, const std::string& one, const std::string& other) {
    if (files::readTextFile(one + "/result.json") != files::readTextFile(other + "/result.json"))
      throw core::InputError("cell " + id + " has two different results: " + one + " and " + other);
  }

  const MergeRequest& request_;
  std::vector<std::string> missing_;
};

void writeTables(const sweep::SweepPlan& plan, const SweepResults& results, const std::string& output,
                 MergedSweep& merged) {
  const auto write = [&](const std::string& name, const std::string& text) {
    files::writeFileAtomically(output + "/" + name, text);
  };
  {
    const auto table = resultsTable(plan, results);
    write("results.csv", table::toCsv(table));
    write("results.json", table::toJson(table));
  }
  auto summary = summarize(plan, results);
  merged.summary = std::move(summary.main);
  merged.full_summary = std::move(summary.all);
  write("summary.txt", table::toText(merged.summary));
  write("summary.md", table::toMarkdown(merged.summary));
  write("summary.tex", table::toLatex(merged.summary, {"tab:summary", {}}));
  write("summary.csv", table::toCsv(merged.full_summary));
  write("summary.json", table::toJson(merged.full_summary));
  auto consistency = sweepConsistency(plan, results);
  write("consistency.txt", table::toText(consistency.main));
  write("consistency.md", table::toMarkdown(consistency.main));
  write("consistency.tex", table::toLatex(consistency.main, {"tab:consistency", {}}));
  write("consistency.csv", table::toCsv(consistency.all));
  write("consistency.json", table::toJson(consistency.all));
  merged.consistency = std::move(consistency.all);
  const auto failures = sweepFailures(plan, results, output);
  write("failures.txt", table::toText(failures.main));
  write("failures.csv", table::toCsv(failures.all));
  write("failures.json", table::toJson(failures.all));
  std::vector<sweep::CellCost> costs(plan.runs.size());
  for (std::size_t i = 0; i < costs.size(); ++i)
    if (results[i]) costs[i] = sweep::readCellCost(output + "/cells/" + plan.runs[i].id);
  const auto table = sweepCostTable(plan, costs);
  write("cost.csv", table::toCsv(table));
  write("cost.json", table::toJson(table));
  merged.costs = sweepCostSummary(plan, costs);
  write("cost_summary.txt", table::toText(merged.costs));
  write("cost_summary.csv", table::toCsv(merged.costs));
}

}  // namespace

MergedSweep mergeSweep(const MergeRequest& request, resources::Manifest manifest, core::Progress& progress) {
  if (request.folders.empty()) throw core::InputError("no folder to merge, expected at least one");
  MergedSweep merged;
  merged.plan = commonPlan(request.folders);
  const sweep::SweepPlan& plan = merged.plan;
  std::error_code error;
  fs::create_directories(request.output + "/cells", error);
  if (error) throw core::IoError(request.output + ": cannot be made: " + error.message());
  if (!fs::exists(request.output + "/plan.json")) {
    files::writeFileAtomically(request.output + "/suite.ini",
                               files::readTextFile(request.folders.front() + "/suite.ini"));
    files::writeFileAtomically(request.output + "/plan.json", sweep::toJson(merged.plan, request.output));
  } else {
    commonPlan({request.folders.front(), request.output});
  }

  Merger merger(request);
  SweepResults& results = merged.results;
  results.resize(plan.runs.size());
  progress.begin("merging " + plan.name);
  const auto total = static_cast<double>(plan.logs.size() + plan.runs.size());
  double done = 0;
  for (const auto& log : plan.logs) {
    if (log.simulated) merger.collect(log.id);
    progress.update(++done / total, 0);
  }
  for (std::size_t i = 0; i < results.size(); ++i) {
    results[i] = merger.collect(plan.runs[i].id);
    merged.complete += results[i] ? 1 : 0;
    merged.failed += results[i] && isFailed(plan, *results[i]) ? 1 : 0;
    progress.update(++done / total, 0);
  }
  merged.missing = merger.takeMissing();
  writeTables(plan, results, request.output, merged);
  writeSweepIndex(plan, results, request.output + "/index.sqlite");
  manifest.results["runs"] = std::to_string(plan.runs.size());
  manifest.results["missing"] = std::to_string(merged.missing.size());
  manifest.results["failed"] = std::to_string(merged.failed);
  manifest.files = {{"summary.txt", "statistics over the seeds; also .md, .tex, .csv, .json"},
                    {"results.csv", "one row per run; also .json"},
                    {"consistency.txt", "whether covariances are true; also .md, .tex, .csv, .json"},
                    {"failures.csv", "where and why runs failed; also .json, .txt"},
                    {"cost.csv", "time and memory of every run; also .json; medians in cost_summary.txt"},
                    {"index.sqlite", "logs, runs and figures as a database: sqlite3"},
                    {"plan.json", "the cells"},
                    {"suite.ini", "the suite: rasterslam bench exec suite.ini --cell ID -o again"}};
  resources::writeManifest(manifest, request.output + "/manifest.json");
  progress.end();
  return merged;
}

}  // namespace slam::summary

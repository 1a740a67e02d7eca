#include "libslam/study/tune.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/files/files.h"
#include "libslam/files/ini_text.h"
#include "libslam/files/word_list.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/resources.h"
#include "libslam/stats/paired.h"
#include "libslam/stats/ranking.h"
#include "libslam/summary/run_figures.h"
#include "libslam/summary/sweep_groups.h"
#include "libslam/summary/sweep_merge.h"
#include "libslam/sweep/cell.h"
#include "libslam/sweep/sweep.h"

namespace slam::study {
namespace fs = std::filesystem;
namespace {

using core::kNaN;
constexpr std::uint64_t kFirstHeldOutSeed = 1001;
constexpr const char* kParameters = "tune.parameters";
constexpr const char* kDefault = "default";

std::string seedsText(std::uint64_t first, std::uint64_t count) {
  return std::to_string(first) + ".." + std::to_string(first + count - 1);
}

struct Candidate {
  std::string name;
  std::vector<std::string> values;  ///< of the parameters, in their order; none: the default
  std::vector<double> mean_ranks;   ///< by rung, as far as it came
};

class Tuner {
 public:
  Tuner(const TuneRequest& request, const resources::Manifest& manifest, core::Progress& progress)
      : request_(request), manifest_(manifest), progress_(progress) {
    ini_ = resources::readConfigFile(request.suite_path);
    files::readParameters(ini_, TuneOptions::table(), options_);
    train_ = worldsOf("train", options_.train);
    hold_out_ = worldsOf("hold_out", options_.hold_out);
    for (const auto& world : train_)
      if (std::count(hold_out_.begin(), hold_out_.end(), world))
        throw core::InputError(placeOf("hold_out") + ": '" + world +
                               "' is among the training worlds too, expected others");
    folder_ = fs::absolute(request.suite_path).parent_path().string();
    const bool is_path = request.method.find_first_of("/.") != std::string::npos;
    method_ = is_path ? fs::absolute(request.method).string() : request.method;
    readParameterRanges();
  }

  TuneResult run() {
    const auto probe = planOf({{kDefault, {}, {}}}, train_, seedsText(1, 1));
    const auto schedule =
        tuneSchedule(request_.budget, probe.plan.logs.size(), static_cast<std::size_t>(options_.reduction));
    metric_ = probe.plan.metric;
    draw(schedule.front().candidates);
    std::vector<std::size_t> alive(candidates_.size());
    std::iota(alive.begin(), alive.end(), 0);
    for (std::size_t r = 0; r < schedule.size(); ++r) {
      alive.resize(std::min(alive.size(), schedule[r].candidates));
      std::sort(alive.begin(), alive.end());
      climb(alive, schedule[r].seeds, r == 0);
    }
    TuneResult result;
    result.candidates = candidatesTable(schedule);
    result.sensitivity = sensitivityTable();
    judge(alive, result);
    result.lost = lost_;
    write(result);
    return result;
  }

 private:
  std::string placeOf(const std::string& key) const {
    const auto* entry = ini_.find("tune", key);
    return (entry ? entry->origin : request_.suite_path) + ": section [tune], key '" + key + "'";
  }

  std::vector<std::string> worldsOf(const std::string& key, const std::string& list) const {
    auto worlds = files::splitAt(list, ',');
    const auto* all = ini_.find("suite", "worlds");
    const auto known = all ? files::splitAt(all->value, ',') : std::vector<std::string>();
    if (worlds.empty())
      throw core::InputError(placeOf(key) + ": names no world, expected some of [suite] worlds");
    for (const auto& world : worlds)
      if (!std::count(known.begin(), known.end(), world))
        throw core::InputError(placeOf(key) + ": found '" + world + "', expected one of [suite] worlds" +
                               core::didYouMean(world, known));
    return worlds;
  }

  void readParameterRanges() {
    files::IniFile source = ini_;
    if (!ini_.hasSection(kParameters)) {
      const std::string shipped =
          resources::configsFolder() + "/tune/" + fs::path(request_.method).stem().string() + ".ini";
      if (!fs::exists(shipped))
        throw core::InputError(request_.suite_path + ": has no section [" + kParameters +
                               "], and no ranges come with the program for " + request_.method);
      source = resources::readConfigFile(shipped);
      files::rejectUnknownSections(source, {kParameters});
    }
    const auto section = source.sections().find(kParameters);
    if (section == source.sections().end() || section->second.empty())
      throw core::InputError(request_.suite_path + ": section [" + kParameters +
                             "] names none, expected section.key = LOW..HIGH or a list");
    for (const auto& [key, entry] : section->second) {
      const auto dot = key.find('.');
      if (dot == std::string::npos || dot == 0 || dot + 1 == key.size())
        throw core::InputError(entry.origin + ": found key '" + key + "', expected section.key");
      keys_.push_back(key);
      ranges_.push_back(
          readValueRange(entry.value, entry.origin + ": section [" + kParameters + "], key '" + key + "'"));
    }
  }

  void draw(std::size_t count) {
    core::RandomStream random(request_.seed, "tune");
    candidates_ = {{kDefault, {}, {}}};
    while (candidates_.size() < count) {
      Candidate candidate{"candidate_" + std::to_string(candidates_.size()), {}, {}};
      for (const auto& range : ranges_) candidate.values.push_back(drawValue(range, random));
      candidates_.push_back(std::move(candidate));
    }
  }

  /// The suite with these candidates as its methods.
  sweep::Sweep planOf(const std::vector<Candidate>& candidates, const std::vector<std::string>& worlds,
                      const std::string& seeds) const {
    files::IniFile ini;
    for (const auto& [section, entries] : ini_.sections()) {
      const auto blank = section.find(' ');
      const std::string kind = section.substr(0, blank);
      if (kind == "tune" || kind == kParameters || kind == "log" || kind == "method" || kind == "parameters")
        continue;
      if (kind == "world" && !std::count(worlds.begin(), worlds.end(), section.substr(blank + 1))) continue;
      // A section without keys is a setting, too: wheels as they are built in.
      if (entries.empty())
        ini.overrideWith(files::IniFile::parse("[" + section + "]\n", request_.suite_path));
      for (const auto& [key, entry] : entries) ini.set(section, key, entry.value, entry.origin);
    }
    const auto set = [&](const char* key, const std::string& value) {
      const auto* entry = ini_.find("suite", key);
      ini.set("suite", key, value, entry ? entry->origin : request_.suite_path);
    };
    const auto joined = [](const std::vector<std::string>& names) {
      std::string list;
      for (const auto& name : names) list += (list.empty() ? "" : ", ") + name;
      return list;
    };
    std::vector<std::string> names;
    for (const auto& candidate : candidates) {
      names.push_back(candidate.name);
      ini.set("method " + candidate.name, "base", method_, "METHOD");
      for (std::size_t k = 0; k < candidate.values.size(); ++k)
        ini.set("method " + candidate.name, keys_[k], candidate.values[k], "tune: " + candidate.name);
    }
    set("worlds", joined(worlds));
    set("logs", "");
    set("methods", joined(names));
    set("seeds", seeds);
    set("baseline", names.front());
    return sweep::planSweep(sweep::readSuite(ini, request_.suite_path, folder_));
  }

  sweep::SweepOutcome work(const sweep::Sweep& plan, const std::string& name, bool is_first) {
    sweep::SweepRequest sweep_request;
    sweep_request.output = request_.output + "/" + name;
    sweep_request.program = request_.program;
    sweep_request.jobs = request_.jobs;
    sweep_request.cell_progress = request_.cell_progress;
    sweep_request.resume = request_.resume || !is_first;
    sweep_request.overwrite = request_.overwrite && is_first;
    auto outcome = sweep::sweep(plan, sweep_request, manifest_, progress_);
    lost_.insert(lost_.end(), outcome.lost.begin(), outcome.lost.end());
    return outcome;
  }

  /// By method, one per log and seed. What is missing counts as failed.
  static std::vector<std::vector<double>> valuesOf(const sweep::SweepPlan& plan,
                                                   const summary::SweepResults& results) {
    const auto names = summary::methodNames(plan);
    std::vector<std::vector<double>> values(names.size());
    for (std::size_t i = 0; i < plan.runs.size(); ++i) {
      const double value = summary::rankedValue(plan, results[i]);
      const auto m = std::find(names.begin(), names.end(), summary::fullName(plan.runs[i])) - names.begin();
      values[static_cast<std::size_t>(m)].push_back(
          std::isnan(value) ? stats::failedValue(summary::betterOf(plan.metric)) : value);
    }
    return values;
  }

  summary::SweepResults resultsOf(const sweep::SweepPlan& plan, const std::string& name) const {
    summary::SweepResults results;
    for (const auto& run : plan.runs) {
      auto cell = sweep::readCell(request_.output + "/" + name + "/cells/" + run.id, run.id);
      if (cell.kind == sweep::CellState::kComplete)
        results.emplace_back(std::move(cell.result));
      else
        results.emplace_back();
    }
    return results;
  }

  /// Ranks those alive; afterwards the best stands first.
  void climb(std::vector<std::size_t>& alive, std::size_t seeds, bool is_first) {
    std::vector<Candidate> here;
    here.reserve(alive.size());
    for (const auto c : alive) here.push_back(candidates_[c]);
    const auto plan = planOf(here, train_, seedsText(1, seeds));
    work(plan, "training", is_first);
    const auto values = valuesOf(plan.plan, resultsOf(plan.plan, "training"));
    const auto ranks = stats::meanRanks(values, summary::betterOf(metric_));
    for (std::size_t i = 0; i < alive.size(); ++i) candidates_[alive[i]].mean_ranks.push_back(ranks[i]);
    // Of equals the default, then the one drawn first.
    std::stable_sort(alive.begin(), alive.end(), [&](std::size_t a, std::size_t b) {
      return candidates_[a].mean_ranks.back() < candidates_[b].mean_ranks.back();
    });
  }

  table::Table candidatesTable(const std::vector<TuneRung>& schedule) const {
    table::Table table;
    table.caption = "Candidates of " + request_.method + ", mean rank on each rung (1 is best)";
    table.columns = {{"candidate", "candidate", 0}};
    for (std::size_t r = 0; r < schedule.size(); ++r)
      table.columns.push_back(
          {"rank_" + std::to_string(r + 1),
           std::to_string(schedule[r].seeds) + (schedule[r].seeds == 1 ? " seed" : " seeds"), 2});
    for (const auto& key : keys_) table.columns.push_back({key, key, 0});
    for (const auto& candidate : candidates_) {
      std::vector<table::CellValue> row = {candidate.name};
      for (std::size_t r = 0; r < schedule.size(); ++r)
        row.emplace_back(r < candidate.mean_ranks.size() ? candidate.mean_ranks[r] : kNaN);
      for (std::size_t k = 0; k < keys_.size(); ++k)
        row.emplace_back(candidate.values.empty() ? "as it is" : candidate.values[k]);
      table.rows.push_back(std::move(row));
    }
    return table;
  }

  table::Table sensitivityTable() const {
    std::vector<std::vector<std::string>> settings;
    std::vector<double> scores;
    for (const auto& candidate : candidates_)
      if (!candidate.values.empty()) {
        settings.push_back(candidate.values);
        scores.push_back(candidate.mean_ranks.front());
      }
    table::Table table;
    table.caption = "Which parameters of " + request_.method + " matter, by " + metric_;
    table.columns = {{"parameter", "parameter", 0},
                     {"explained_share", "explained", 2},
                     {"p_holm", "p", 3, true},
                     {"best", "best", 0}};
    auto list = sensitivities(keys_, ranges_, settings, scores);
    std::stable_sort(list.begin(), list.end(),
                     [](const Sensitivity& a, const Sensitivity& b) { return a.share > b.share; });
    for (const auto& of : list) table.rows.push_back({of.key, of.share, of.p, of.best});
    table.notes.push_back("Explained: share of the variance of the " + std::to_string(scores.size()) +
                          " candidates' mean ranks on the first rung that lies between thirds of the values, "
                          "less chance; p: by permutation, Holm's method. Best: the third that ranks best.");
    return table;
  }

  std::string textOf(const Candidate& candidate) const {
    files::IniFile config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", method_);
    for (std::size_t k = 0; k < candidate.values.size(); ++k) {
      const auto dot = keys_[k].find('.');
      config.set(keys_[k].substr(0, dot), keys_[k].substr(dot + 1), candidate.values[k], "tune");
    }
    return files::toText(config);
  }

  /// finalists: the best in training first.
  void judge(const std::vector<std::size_t>& finalists, TuneResult& result) {
    tuned_text_ = textOf(candidates_[finalists.front()]);
    if (candidates_[finalists.front()].values.empty()) {
      result.verdict = "No candidate beat the default of " + request_.method + " in training: keep it.";
      result.held_out.caption = result.verdict;
      result.held_out.columns = {{"method", "method", 0}};
      return;
    }
    std::vector<Candidate> judged = {{kDefault, {}, {}}};
    for (const auto c : finalists)
      if (!candidates_[c].values.empty()) judged.push_back(candidates_[c]);
    const auto seeds = seedsText(kFirstHeldOutSeed, static_cast<std::uint64_t>(options_.hold_out_seeds));
    const auto plan = planOf(judged, hold_out_, seeds);
    work(plan, "held_out", true);
    const std::string folder = request_.output + "/held_out";
    summary::MergeRequest whole;
    whole.folders = {folder};
    whole.output = folder;
    const auto merged = summary::mergeSweep(whole, manifest_, core::silentProgress());
    result.held_out = merged.summary;
    const auto values = valuesOf(merged.plan, merged.results);
    const auto verdict = heldOutVerdict(values, summary::betterOf(metric_), settingsOfLogs(merged.plan));
    const Candidate& chosen = judged[verdict.method];
    tuned_text_ = textOf(chosen);
    result.is_better = verdict.is_better;
    result.verdict =
        chosen.name + " is " +
        (verdict.is_better  ? "better than the default"
         : verdict.is_worse ? "worse than the default: keep the default"
                            : "not to be told from the default: keep the default") +
        " on the held-out worlds (" + metric_ + ", better on " +
        files::formatNumber(std::round(verdict.share * 1000) / 10) + " % of " +
        std::to_string(values[0].size()) +
        " logs, signed-rank p = " + files::formatNumber(std::round(verdict.p * 1e4) / 1e4) +
        (judged.size() > 2 ? " by Holm's method, best of " + std::to_string(judged.size() - 1) : "") + ").";
  }

  /// Of the logs in the order of valuesOf().
  static std::vector<std::size_t> settingsOfLogs(const sweep::SweepPlan& plan) {
    std::vector<std::size_t> runs;
    for (std::size_t i = 0; i < plan.runs.size(); ++i)
      if (summary::fullName(plan.runs[i]) == summary::fullName(plan.runs.front())) runs.push_back(i);
    return summary::settingsOf(plan, runs);
  }

  void write(TuneResult& result) const {
    const auto writeTable = [&](const table::Table& table, const std::string& name) {
      const std::string stem = request_.output + "/" + name;
      files::writeFileAtomically(stem + ".txt", table::toText(table));
      files::writeFileAtomically(stem + ".csv", table::toCsv(table));
      files::writeFileAtomically(stem + ".json", table::toJson(table));
    };
    writeTable(result.candidates, "candidates");
    writeTable(result.sensitivity, "sensitivity");
    files::writeFileAtomically(request_.output + "/verdict.txt", result.verdict + "\n");
    result.tuned_path = request_.output + "/" + fs::path(request_.method).stem().string() + "_tuned.ini";
    files::writeFileAtomically(
        result.tuned_path,
        "# " + request_.method + " tuned on " + fs::path(request_.suite_path).filename().string() +
            " (worlds " + options_.train + "), budget " + std::to_string(request_.budget) + " runs, seed " +
            std::to_string(request_.seed) + ".\n# " + result.verdict + "\n" + tuned_text_);
  }

  const TuneRequest& request_;
  const resources::Manifest& manifest_;
  core::Progress& progress_;
  files::IniFile ini_;
  TuneOptions options_;
  std::vector<std::string> train_, hold_out_, keys_, lost_;
  std::vector<ValueRange> ranges_;
  std::string folder_, method_, metric_, tuned_text_;
  std::vector<Candidate> candidates_;
};

}  // namespace

const files::ParameterTable<TuneOptions>& TuneOptions::table() {
  using O = TuneOptions;
  static const files::ParameterTable<O> rows(
      "tune", {{"train", &O::train, "", {}, "worlds of [suite] to tune on"},
               {"hold_out", &O::hold_out, "", {}, "worlds of [suite] to judge the result on"},
               {"hold_out_seeds", &O::hold_out_seeds, 10, 2, 10000, "seeds there"},
               {"reduction", &O::reduction, 3, 2, 10,
                "on every rung so many times the seeds, for so many times fewer candidates"}});
  return rows;
}

TuneOptions::TuneOptions() {
  table().setDefaults(*this);
}

TuneResult tune(const TuneRequest& request, const resources::Manifest& manifest, core::Progress& progress) {
  return Tuner(request, manifest, progress).run();
}

}  // namespace slam::study

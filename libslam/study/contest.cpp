#include "libslam/study/contest.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/stats/bootstrap.h"
#include "libslam/stats/proportion.h"
#include "libslam/stats/ranking.h"
#include "libslam/summary/sweep_groups.h"

namespace slam::study {
namespace fs = std::filesystem;
namespace {

constexpr int kResamples = 2000;
constexpr std::uint64_t kSeeds = 1000000000;  // seeds are drawn below it
constexpr double kAlpha = 0.05;

/// An entry as a suite's list has it: the name of a method, or a path from the suite's folder, so that none
/// of the machine stands in what is written.
std::string listed(const std::string& entry, const std::string& folder, const fs::path& suite_folder) {
  if (entry.find_first_of("/.") == std::string::npos) return entry;
  const fs::path path = folder.empty() ? fs::absolute(entry) : fs::path(folder) / entry;
  if (!fs::is_regular_file(path))
    throw core::InputError(entry + ": no such file, expected the .ini of a method");
  return path.lexically_normal().lexically_proximate(suite_folder).string();
}

/// The drives on which every entry has a run, as indices of runs by entry.
struct Drives {
  std::vector<std::vector<double>> values;  ///< by entry
  std::vector<std::size_t> settings;
};

Drives drivesOf(const summary::SweepGroup& group, const sweep::SweepPlan& plan,
                const summary::SweepResults& results) {
  Drives drives;
  drives.values.resize(group.methods.size());
  for (std::size_t i = 0; i < group.methods.front().size(); ++i) {
    std::vector<double> of_drive;
    for (const auto& runs : group.methods) of_drive.push_back(summary::rankedValue(plan, results[runs[i]]));
    if (std::any_of(of_drive.begin(), of_drive.end(), [](double v) { return std::isnan(v); })) continue;
    for (std::size_t m = 0; m < of_drive.size(); ++m) drives.values[m].push_back(of_drive[m]);
    if (!group.settings.empty()) drives.settings.push_back(group.settings[i]);
  }
  return drives;
}

struct Failures {
  std::size_t runs = 0, failed = 0;
  std::string first;  ///< what the first said
};

Failures failuresOf(const std::vector<std::size_t>& runs, const sweep::SweepPlan& plan,
                    const summary::SweepResults& results) {
  Failures failures;
  for (const auto run : runs) {
    if (!results[run]) continue;
    ++failures.runs;
    if (!summary::isFailed(plan, *results[run])) continue;
    if (failures.failed++ > 0) continue;
    const auto& result = *results[run];
    failures.first = result.status == "ok"
                         ? "ended more than " + files::formatNumber(plan.failure_ate_m) + " m off"
                         : result.status + (result.message.empty() ? "" : ": " + result.message);
  }
  return failures;
}

bool shareALetter(const std::string& a, const std::string& b) {
  return a.find_first_of(b) != std::string::npos;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

}  // namespace

sweep::Suite contestSuite(const ContestRequest& request) {
  if (request.entries.size() < 2)
    throw core::InputError("contest: found " + std::to_string(request.entries.size()) +
                           " entries, expected two at least");
  auto ini = resources::readConfigFile(request.suite_path);
  const auto suite_folder = fs::absolute(request.suite_path).lexically_normal().parent_path();
  std::string methods;
  for (const auto& entry : request.entries)
    methods += (methods.empty() ? "" : ", ") + listed(entry, request.folder, suite_folder);
  core::RandomStream worlds(request.seed, "contest worlds"), drives(request.seed, "contest drives");
  const auto given = ini.sections();  // a copy: it is written to below
  for (const auto& [section, entries] : given)
    if (section.compare(0, 6, "world ") == 0 && entries.count("kind") != 0)
      ini.set(section, "seed", std::to_string(1 + worlds.below(kSeeds)), "--seed");
  std::string seeds;
  std::set<std::uint64_t> drawn;
  while (drawn.size() < static_cast<std::size_t>(request.seeds)) {
    const auto seed = 1 + drives.below(kSeeds);
    if (drawn.insert(seed).second) seeds += (seeds.empty() ? "" : ", ") + std::to_string(seed);
  }
  ini.set("suite", "methods", methods, "the entries");
  ini.set("suite", "seeds", seeds, "--seed");
  const std::string& first = request.entries.front();
  const bool is_file = first.find_first_of("/.") != std::string::npos;
  ini.set("suite", "baseline", is_file ? fs::path(first).stem().string() : first, "the first entry");
  return sweep::readSuite(ini, request.suite_path, suite_folder.string());
}

Standings standingsOf(const sweep::SweepPlan& plan, const summary::SweepResults& results) {
  const auto names = summary::methodNames(plan);
  const auto group = summary::groupsOf(plan, names).front();
  const auto drives = drivesOf(group, plan, results);
  Standings standings;
  auto& table = standings.table;
  table.caption = "Standings";
  table.columns = {{"place", "place"},         {"entry", "entry"},
                   {plan.metric, plan.metric}, {"mean_rank", "mean rank", 2},
                   {"failed", "failed"},       {"group", "group"}};
  if (drives.values.front().empty()) {
    standings.full = table;
    standings.verdict.push_back("No drive was finished by every entry.");
    return standings;
  }
  const auto ranking =
      stats::rankingGroups(drives.values, summary::betterOf(plan.metric), kAlpha, drives.settings).methods;
  const auto decimals = summary::figureColumn(plan.metric).decimals;
  std::vector<std::string> first, first_failures;
  for (std::size_t i = 0; i < ranking.size(); ++i) {
    const auto& ranked = ranking[i];
    const auto& values = drives.values[ranked.method];
    const auto median = stats::bootstrapMedian(values, {0.95, 1, kResamples, drives.settings});
    const auto failures = failuresOf(group.methods[ranked.method], plan, results);
    const bool shares_first = shareALetter(ranked.letters, ranking.front().letters);
    if (shares_first) first.push_back(names[ranked.method]);
    table.rows.push_back({shares_first ? std::string("1") : std::to_string(i + 1), names[ranked.method],
                          summary::withInterval(median, decimals), ranked.mean_rank,
                          std::to_string(failures.failed) + " of " + std::to_string(failures.runs),
                          ranked.letters});
    if (!failures.first.empty())
      table.notes.push_back("First failure of " + names[ranked.method] + ": " +
                            core::oneLine(failures.first) + ".");
    first_failures.push_back(failures.first.empty() ? "-" : core::oneLine(failures.first));
  }
  table.notes.push_back("Median over " + std::to_string(drives.values.front().size()) +
                        " drives with its 95 % bootstrap interval; a failed run is worse than any other. "
                        "Entries that share a letter "
                        "cannot be told apart (signed-rank test on the same drives, Holm's method, 5 %). "
                        "They hold for these settings, not for others.");
  standings.full = table;
  standings.full.columns.push_back({"first_failure", "first failure"});
  for (std::size_t i = 0; i < first_failures.size(); ++i)
    standings.full.rows[i].emplace_back(first_failures[i]);
  standings.verdict.push_back(first.size() == 1 ? first.front() + " wins."
                                                : "First place is shared: " + joined(first) +
                                                      " cannot be told apart on these drives.");
  return standings;
}

}  // namespace slam::study

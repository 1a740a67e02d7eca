// Answers that are a sweep of the student's, and a word about it.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/learn/check_answer.h"
#include "libslam/learn/student_folder.h"
#include "libslam/summary/run_figures.h"
#include "libslam/summary/sweep_groups.h"
#include "libslam/sweep/cell.h"
#include "libslam/sweep/suite.h"
#include "libslam/sweep/sweep_plan.h"

namespace slam::learn {
namespace fs = std::filesystem;
namespace {

const std::string kDefault = "naive_flow", kOther = "naive_correlation";
constexpr std::size_t kFewestSeeds = 8;
constexpr double kAlpha = 0.05;

/// The pairs of both methods, log by log; nothing where a run is missing.
struct Pairs {
  std::vector<double> first, second;
  std::vector<std::size_t> settings;
};

std::optional<Pairs> pairsOf(const sweep::SweepPlan& plan, const std::string& folder) {
  const std::size_t logs = plan.logs.size();
  std::vector<std::optional<double>> first(logs), second(logs);
  for (const auto& run : plan.runs) {
    if (run.method != kDefault && run.method != kOther) continue;
    const auto cell = sweep::readCell(folder + "/cells/" + run.id, run.id);
    if (cell.kind != sweep::CellState::kComplete || cell.result.status != "ok") return std::nullopt;
    (run.method == kDefault ? first : second)[run.log] = summary::figureOf(cell.result, "ate_final_m");
  }
  Pairs pairs;
  std::vector<std::string> settings;
  for (std::size_t i = 0; i < logs; ++i) {
    if (!first[i] || !second[i]) return std::nullopt;
    const std::string key = summary::settingKey(plan.logs[i]);
    auto known = std::find(settings.begin(), settings.end(), key);
    if (known == settings.end()) known = settings.insert(settings.end(), key);
    pairs.first.push_back(*first[i]), pairs.second.push_back(*second[i]);
    pairs.settings.push_back(static_cast<std::size_t>(known - settings.begin()));
  }
  return pairs;
}

bool holds(const sweep::SweepPlan& plan, const std::string& method) {
  return std::any_of(plan.runs.begin(), plan.runs.end(),
                     [&](const auto& run) { return run.method == method; });
}

/// What is unfair about it, as the name of a hint.
std::optional<std::string> unfairness(const sweep::SweepPlan& plan, const std::string& fair,
                                      const std::string& folder, std::uint64_t student) {
  if (!holds(plan, kDefault) || !holds(plan, kOther)) return "not_both";
  const std::string claimed = sweep::planSha256(world::loadPlan(folder + "/plan.yaml"));
  for (const auto& world : sweep::readSuite(fair + "/suite.ini", plan.suite_folder).worlds)
    if (world.sha256 == claimed) return "world_not_held_out";
  std::vector<std::uint64_t> seeds;
  for (const auto& log : plan.logs) {
    if (log.seed <= student * 100 || log.seed > student * 100 + 99) return "other_student";
    if (std::find(seeds.begin(), seeds.end(), log.seed) == seeds.end()) seeds.push_back(log.seed);
  }
  if (seeds.size() < kFewestSeeds) return "too_few_seeds";
  return std::nullopt;
}

}  // namespace

Verdict checkSweep(const Lesson& lesson, std::uint64_t student, const std::string& folder,
                   core::Progress& /*progress*/) {
  const std::string fair = folder + "/fair";
  if (!fs::exists(fair + "/plan.json")) return hinted(lesson, Finding::kUnusable, "missing");
  const auto plan = sweep::readSweepPlan(fair + "/plan.json");
  if (const auto hint = unfairness(plan, fair, folder, student))
    return hinted(lesson, *hint == "other_student" ? Finding::kUnusable : Finding::kWrong, *hint,
                  std::to_string(plan.runs.size()) + " runs");
  const auto pairs = pairsOf(plan, fair);
  if (!pairs)
    return hinted(lesson, Finding::kWrong, "incomplete", std::to_string(plan.runs.size()) + " runs");

  const std::string path = folder + "/" + kAnswerFile;
  const std::string word = fs::exists(path) ? files::trimmed(files::readTextFile(path)) : "";
  if (word != "better" && word != "worse" && word != "no difference")
    return hinted(lesson, Finding::kUnusable, "not_a_verdict", core::oneLine(word, 60));
  const double p = stats::wilcoxonSignedRank(pairs->second, pairs->first, pairs->settings).p;
  const double share =
      stats::probabilityOfImprovement(pairs->second, pairs->first, stats::Better::kSmaller).value;
  const std::string truth = p >= kAlpha ? "no difference" : share > 0.5 ? "better" : "worse";
  const std::string found = word + " (" + std::to_string(pairs->first.size()) +
                            " pairs, p = " + files::formatNumber(std::round(p * 1e4) / 1e4) + ")";
  if (word == truth) return {Finding::kRight, "right", found, ""};
  if (truth == "no difference") return hinted(lesson, Finding::kWrong, "not_significant", found);
  return hinted(lesson, Finding::kWrong, word == "no difference" ? "overlooked" : "wrong_way", found);
}

}  // namespace slam::learn

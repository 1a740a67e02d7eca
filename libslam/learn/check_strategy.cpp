// Answers that are a program with a strategy of the student's in it.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/learn/check_answer.h"
#include "libslam/process/measured_process.h"
#include "libslam/resources/manifest.h"
#include "libslam/table/table.h"

namespace slam::learn {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kHidden = 50;  // added to the seed of the building that the student does not have
constexpr double kMostWay = 1.25;      // of that of nearest_frontier
constexpr double kFarthest = 1e-3;

/// The folder of a strategy that 'rasterslam new strategy' began, in `folder`; "" without one.
std::string strategyIn(const std::string& folder) {
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_directory() && fs::exists(entry.path() / "find_rasterslam.cmake"))
      found.push_back(entry.path().string());
  return found.empty() ? "" : *std::min_element(found.begin(), found.end());
}

/// One row of runs.csv.
struct Run {
  double coverage_percent = 0, path90_m = 0, path_m = 0, collisions = 0;
};

Run rowOf(const table::Table& table, const std::string& strategy) {
  const auto column = [&](const std::string& key) {
    for (std::size_t c = 0; c < table.columns.size(); ++c)
      if (table.columns[c].key == key) return c;
    throw core::InputError("runs.csv: column '" + key + "' is missing");
  };
  for (const auto& row : table.rows) {
    const auto* name = std::get_if<std::string>(&row[column("strategy")]);
    if (!name || *name != strategy) continue;
    const auto number = [&](const char* key) { return std::get<double>(row[column(key)]); };
    return {number("coverage_percent"), number("path90_m"), number("path_m"), number("collisions")};
  }
  throw core::InputError("runs.csv: strategy '" + strategy + "' is missing");
}

std::string rounded(double value) {
  return files::formatNumber(std::round(value * 10) / 10);
}

std::string lastLines(const std::string& printed) {
  const std::string text = files::trimmed(printed);
  return core::oneLine(text.size() > 200 ? text.substr(text.size() - 200) : text);
}

/// Whether the robot always took the last of the viewpoints: what the template does says so as its reason.
bool isTemplate(const std::string& decisions_path) {
  const std::string text = files::readTextFile(decisions_path);
  return text.find("the farthest") != std::string::npos;
}

}  // namespace

Verdict checkStrategy(const Lesson& lesson, std::uint64_t student, const std::string& folder,
                      core::Progress& progress) {
  const std::string mine = strategyIn(folder);
  if (mine.empty()) return hinted(lesson, Finding::kUnusable, "missing");
  const std::string build = fs::absolute(mine + "/build").string();
  std::string program;
  if (fs::is_directory(build))
    for (const auto& entry : fs::directory_iterator(build)) {
      const std::string name = entry.path().filename().string();
      if (fs::exists(build + "/" + name + "_test") && entry.is_regular_file()) program = name;
    }
  if (program.empty()) return hinted(lesson, Finding::kUnusable, "not_built");

  const files::ScratchFolder scratch;
  const std::uint64_t hidden = student * 1000 + kHidden;
  const Place place{lesson, hidden, scratch.path(), progress};
  place.makePlan("plan.yaml");
  const auto* duration = lesson.ini.find("strategy_check", "duration_s");
  const std::string line =
      resources::shellQuoted({build + "/" + program, scratch / "plan.yaml", scratch / "out",
                              std::to_string(student), duration ? duration->value : "150"});
  const auto outcome = process::runMeasured(line, scratch.path(), {300, 4000}, progress);
  if (outcome.exit_code != 0 || !fs::exists(scratch / "out/runs.csv"))
    return hinted(lesson, Finding::kCrashed, "crashed",
                  program + " ended with exit code " + std::to_string(outcome.exit_code) + ": " +
                      lastLines(outcome.printed));
  const auto table = table::fromCsv(files::readTextFile(scratch / "out/runs.csv"), "runs.csv");
  const auto own = rowOf(table, program), nearest = rowOf(table, "nearest_frontier");
  const std::string found = program + ": " + rounded(own.coverage_percent) + " % seen, 90 % after " +
                            rounded(own.path90_m) + " m (nearest_frontier " + rounded(nearest.path90_m) +
                            " m), " + rounded(own.collisions) + " collisions";
  if (own.collisions > 0) return hinted(lesson, Finding::kWrong, "collided", found);
  if (isTemplate(scratch / ("out/" + program + "/decisions.csv")))
    return hinted(lesson, Finding::kWrong, "unchanged", found);
  if (std::abs(own.path_m - nearest.path_m) < kFarthest)
    return hinted(lesson, Finding::kWrong, "same_as_nearest", found);
  if (!(own.coverage_percent >= 90)) return hinted(lesson, Finding::kWrong, "stuck", found);
  if (own.path90_m <= kMostWay * nearest.path90_m) return {Finding::kRight, "right", found, ""};
  return {Finding::kWrong, "wrong", found, lesson.options.wrong};
}

}  // namespace slam::learn

#include "libslam/teams/team.h"

#include <filesystem>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/resources/file_hash.h"
#include "libslam/teams/team_files.h"

namespace slam::teams {
namespace fs = std::filesystem;
namespace {

void refuse(const std::string& found, const std::string& expected) {
  throw core::InputError("--robots: found " + found + ", expected " + expected);
}

/// What several robots cannot have.
void checkRequest(const TeamRequest& request) {
  const auto& record = request.config.record;
  if (request.robots < 1 || request.robots > kMostRobots)
    refuse(std::to_string(request.robots), "1 to " + std::to_string(kMostRobots));
  if (!(request.radio_range_m >= 0))
    throw core::InputError("--radio-range: found " + files::formatNumber(request.radio_range_m) +
                           ", expected metres from 0 on");
  if (record.living.people > 0 || record.living.doors_share > 0)
    refuse("[living] people or doors that move", "one robot with them: a team has the world for itself");
  if (!record.carries.empty()) refuse("a robot that is carried", "one robot with --carry");
  if (request.config.exploration.return_to_start) refuse("--return", "one robot with it");
  if (!record.other_lidars.empty()) refuse("several lidars on a robot", "one robot with them");
  if (request.threads < 1) throw core::ContractError("exploreTeam: threads from 1");
}

std::vector<std::string> makeFolders(const TeamRequest& request, const std::string& folder) {
  std::vector<std::string> folders;
  for (std::size_t i = 0; i < static_cast<std::size_t>(request.robots); ++i) {
    folders.push_back(request.tables_only ? "" : folder + "/" + robotName(i));
    if (!request.tables_only) fs::create_directories(folders.back());
  }
  return folders;
}

void describe(const TeamRequest& request, const TeamReport& report, resources::Manifest& manifest) {
  manifest.seed = request.seed;
  manifest.inputs[request.plan_path] = resources::fileSha256(request.plan_path);
  for (const auto& line : request.config.record.parameters)
    manifest.config[line.section + "." + line.info.key] = line.value;
  if (!request.tables_only)
    for (std::size_t i = 0; i < report.robots.size(); ++i)
      manifest.files[robotName(i)] = "what this robot did, as a single exploration leaves it";
  manifest.files["map.yaml"] = "all maps as one, in the first robot's frame; also .png and .gridmap.gz";
  manifest.files["exploration.json"] = "the team's scores";
  manifest.files["team.csv"] = "after every scan: time, explored area of all, each robot's path";
  manifest.files["scores.txt"] = "a row per robot; also .md, .tex, .csv and .json";
  manifest.files["path.png"] = "the true paths of all robots on the plan";
  manifest.files["coverage.png"] = "explored share over time, path and scans, of all and of each";
  manifest.files["cost.csv"] = "CPU time of the decisions: differs from run to run";
  manifest.results["robots"] = std::to_string(request.robots);
  manifest.results["end"] = explore::endName(report.team.end);
  manifest.results["status"] = "complete";
  manifest.results["failed_runs"] = std::to_string(report.failed);
}

}  // namespace

TeamReport exploreTeam(const TeamRequest& request, resources::Manifest manifest, core::Progress& progress) {
  checkRequest(request);
  const auto method = explore::loadMethod(request.slam, request.methods_folder);
  const auto given_plan = world::loadPlan(request.plan_path);
  const auto plan = record::planOfVisit(given_plan, request.config.record.living, request.seed);
  const auto starts = teamStarts(plan, request);
  files::PendingFolder output(request.output, request.overwrite);
  const std::string folder = output.path();

  const auto folders = makeFolders(request, folder);
  TeamLoop loop(plan, request, method, starts, folders);
  progress.begin(std::to_string(request.robots) + " robots exploring " + plan.name);
  loop.run(progress);
  progress.end();

  TeamReport report;
  std::vector<explore::LoopResult> results;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    results.push_back(loop.robot(i).result());
    report.robots.push_back(results.back().exploration);
    report.failed += report.robots.back().end == explore::ExplorationEnd::kFailed;
    if (!folders[i].empty()) loop.robot(i).writeFiles(results.back(), manifest);
    report.robots.back().strategy = robotName(i);
    report.robots.back().seed = request.seed;
  }
  report.team = loop.scores();
  report.scores = teamTable(request, report, plan.name, method.name);
  writeTeam(loop, request, report, results, plan, folder);
  describe(request, report, manifest);
  resources::writeManifest(manifest, folder + "/manifest.json");
  output.commit();
  return report;
}

}  // namespace slam::teams

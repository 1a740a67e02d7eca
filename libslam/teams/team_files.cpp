#include "libslam/teams/team_files.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "libslam/explore/coverage_charts.h"
#include "libslam/explore/exploration_tables.h"
#include "libslam/files/files.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/pictures/picture.h"
#include "libslam/table/latex.h"
#include "libslam/table/number_text.h"

namespace slam::teams {
namespace {

nlohmann::ordered_json numberOrNull(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * 1e6) / 1e6;
}

nlohmann::ordered_json countOrNull(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::llround(value);
}

std::string scoresJson(const TeamRequest& request, const TeamReport& report, const std::string& plan_name,
                       const std::string& slam) {
  const auto& team = report.team;
  nlohmann::ordered_json json;
  json["plan"] = plan_name;
  json["robots"] = request.robots;
  json["strategy"] = explore::strategyNameOf(request.config);
  json["slam"] = slam;
  json["seed"] = request.seed;
  json["radio_range_m"] = numberOrNull(request.radio_range_m);  // null: without a limit
  json["end"] = explore::endName(team.end);
  const std::pair<const char*, double> figures[] = {{"coverage", team.figures.coverage},
                                                    {"explorable_m2", team.explorable_m2},
                                                    {"t90_s", team.figures.t90_s},
                                                    {"t99_s", team.figures.t99_s},
                                                    {"time_s", team.figures.time_s},
                                                    {"path90_sum_m", team.figures.path90_m},
                                                    {"path99_sum_m", team.figures.path99_m},
                                                    {"path_sum_m", team.path_sum_m},
                                                    {"path_longest_m", team.path_longest_m},
                                                    {"overlap", team.overlap},
                                                    {"map_wall_f1", team.evaluation.map.occupied_f1},
                                                    {"map_free_iou", team.evaluation.map.free_iou}};
  for (const auto& [key, value] : figures) json[key] = numberOrNull(value);
  json["wall_collisions"] = countOrNull(team.wall_collisions);
  json["robot_collisions"] = countOrNull(team.robot_collisions);
  json["gave_way"] = countOrNull(team.gave_way);
  json["each"] = nlohmann::ordered_json::array();
  for (const auto& e : report.robots)
    json["each"].push_back({{"end", explore::endName(e.end)},
                            {"coverage", numberOrNull(e.figures.coverage)},
                            {"path_m", numberOrNull(e.figures.path_m)},
                            {"collisions", countOrNull(e.collisions)},
                            {"ate_rmse_m", numberOrNull(e.evaluation.trajectory.position_m.rmse)}});
  return json.dump(2) + "\n";
}

std::string teamCsv(const TeamLoop& loop, double explorable_m2) {
  table::Table table;
  table.columns = {
      {"time_s", "time_s", 3}, {"explored_m2", "explored_m2", 3}, {"explored_share", "share", 6}};
  const auto& paths_m = loop.paths_m();
  for (std::size_t robot = 0; robot < loop.size(); ++robot)
    table.columns.push_back({robotName(robot) + "_path_m", robotName(robot) + "_path_m", 3});
  for (std::size_t i = 0; i < loop.curve().size(); ++i) {
    const auto& point = loop.curve()[i];
    std::vector<table::CellValue> row = {point.time_s, point.explored_m2, point.explored_m2 / explorable_m2};
    for (const double path_m : paths_m[i]) row.emplace_back(path_m);
    table.rows.push_back(std::move(row));
  }
  return table::toCsv(table);
}

void drawPictures(TeamLoop& loop, const TeamReport& report, const std::vector<explore::LoopResult>& results,
                  const world::Plan& plan, const std::string& title, const std::string& folder) {
  std::vector<pictures::DrawnPath> paths;
  std::vector<explore::ExplorationJob> curves(1);
  curves[0].result.exploration.strategy = "all";
  curves[0].result.exploration.explorable_m2 = report.team.explorable_m2;
  curves[0].result.curve = loop.curve();
  for (std::size_t i = 0; i < loop.size(); ++i) {
    paths.push_back({loop.robot(i).trueTrajectory(), robotName(i)});
    if (report.robots[i].end == explore::ExplorationEnd::kFailed) continue;
    curves.emplace_back();
    curves.back().result.exploration.strategy = robotName(i);
    curves.back().result.exploration.explorable_m2 = report.team.explorable_m2;
    curves.back().result.curve = results[i].curve;
  }
  pictures::drawMap(plan, paths, title, folder + "/path.png");
  explore::drawCoverage(curves, nullptr, title, folder + "/coverage.png");
}

std::string orDash(double value, int decimals) {
  return std::isfinite(value) ? table::fixed(value, decimals) : "-";
}

}  // namespace

std::string robotName(std::size_t robot) {
  return "robot" + std::to_string(robot + 1);
}

table::Table teamTable(const TeamRequest& request, const TeamReport& report, const std::string& plan_name,
                       const std::string& slam) {
  const auto& team = report.team;
  const std::string caption = std::to_string(request.robots) + " robots explore " + plan_name + " by " +
                              explore::strategyNameOf(request.config) + " with " +
                              (slam == explore::kTruthReference ? "the true pose (reference)" : slam);
  auto table = explore::scoresTable(explore::byStrategy(report.robots, 1), caption, false);
  table.notes.push_back("Together: 90 % after " + orDash(team.figures.t90_s, 1) + " s, 99 % after " +
                        orDash(team.figures.t99_s, 1) + " s; " +
                        table::fixed(100 * team.figures.coverage, 1) + " % after " +
                        orDash(team.figures.time_s, 1) + " s (" + explore::endName(team.end) + ").");
  table.notes.push_back("Paths: " + table::fixed(team.path_sum_m, 1) + " m in all, the longest " +
                        table::fixed(team.path_longest_m, 1) + " m; " + table::fixed(100 * team.overlap, 0) +
                        " % of what was explored was seen by more than one.");
  table.notes.push_back("Collisions: " + table::fixed(team.wall_collisions, 0) + " with walls, " +
                        table::fixed(team.robot_collisions, 0) +
                        " between robots; out of another one's way " + table::fixed(team.gave_way, 0) +
                        " times.");
  table.notes.emplace_back("A row's shares are of what that robot has seen itself.");
  return table;
}

void writeTeam(TeamLoop& loop, const TeamRequest& request, const TeamReport& report,
               const std::vector<explore::LoopResult>& results, const world::Plan& plan,
               const std::string& folder) {
  const auto write = [&](const char* name, const std::string& text) {
    files::writeFileAtomically(folder + "/" + name, text);
  };
  const std::string slam = report.robots.front().slam;
  auto statistics = explore::statisticsTable(explore::byStrategy(report.robots, 1), plan.name);
  statistics.caption = report.scores.caption;
  statistics.notes = report.scores.notes;
  write("scores.txt", table::toText(report.scores));
  write("scores.md", table::toMarkdown(report.scores));
  write("scores.tex", table::toLatex(report.scores, {"tab:scores", explore::bestFigures()}));
  write("scores.csv", table::toCsv(statistics));
  write("scores.json", table::toJson(statistics));
  write("runs.csv", table::toCsv(explore::runsTable(report.robots, plan.name)));
  write("cost.csv", table::toCsv(explore::costTable(report.robots)));
  write("team.csv", teamCsv(loop, report.team.explorable_m2));
  write("exploration.json", scoresJson(request, report, plan.name, slam));
  const auto map = loop.mergedMap();
  if (!map.occupancy.empty()) mapping::saveRaster(map, folder);
  drawPictures(loop, report, results, plan, report.scores.caption, folder);
}

}  // namespace slam::teams

#include "libslam/score/failure.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/logs/log_reader.h"
#include "libslam/metrics/nearest_points.h"
#include "libslam/table/number_text.h"
#include "libslam/table/table.h"
#include "libslam/truth/carry_file.h"
#include "libslam/truth/collision_file.h"
#include "libslam/truth/number_rows.h"

namespace slam::score {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* kJumpWord = "jump";
constexpr const char* kDriftWord = "drift";

struct Pair {
  double time_s;
  core::Pose2 T_world_robot, T_map_robot;
};

std::vector<Pair> paired(const core::Trajectory& truth, const core::Trajectory& estimate) {
  std::vector<Pair> pairs;
  for (const auto& [time_s, pose] : estimate) {
    core::Pose2 true_pose;
    if (metrics::poseAt(truth, time_s, true_pose) && core::isFinite(pose))
      pairs.push_back({time_s, true_pose, pose});
  }
  return pairs;
}

/// Of the estimated motion between two poses.
core::Pose2 motionError(const Pair& from, const Pair& to) {
  return core::between(core::between(from.T_world_robot, to.T_world_robot),
                       core::between(from.T_map_robot, to.T_map_robot));
}

double lengthOf(const core::Pose2& error) {
  return core::hypot(error.x, error.y);
}

/// The pair in (from, to] at which the motion's error grows most, a radian counting as much as jump_m /
/// jump_rad metres.
std::size_t onsetIn(const std::vector<Pair>& pairs, std::size_t from, std::size_t to,
                    const FailureLimits& limits) {
  std::size_t onset = to;
  double most = -1;
  for (std::size_t i = from + 1; i <= to; ++i) {
    const auto error = motionError(pairs[i - 1], pairs[i]);
    const double size =
        lengthOf(error) + std::abs(core::wrapToPi(error.phi)) * limits.jump_m / limits.jump_rad;
    if (size > most) most = size, onset = i;
  }
  return onset;
}

std::string at(const core::Point2& place) {
  return "(" + table::fixed(place.x, 2) + ", " + table::fixed(place.y, 2) + ")";
}

/// Events of one kind around the divergence.
struct Events {
  double first_s, last_s;
  int count = 0;
};

std::string textOf(const std::string& name, const Events& events) {
  std::string text = name;
  if (events.count > 1) text += " " + std::to_string(events.count) + " times";
  text += ", " + table::fixed(events.first_s, 1);
  if (events.count > 1) text += " to " + table::fixed(events.last_s, 1);
  return text + " s";
}

const char* const kFalseLoopEvent = "false loop closure";
const char* const kSlipEvent = "odometry wrong";
const char* const kCollisionEvent = "collision";
const char* const kKidnappedEvent = "kidnapped";

/// Scans at which the odometry's motion over the last slip_s is wrong.
std::vector<double> slipTimes(const core::Trajectory& truth, const core::Trajectory& odometry,
                              const FailureLimits& limits) {
  const auto pairs = paired(truth, odometry);
  std::vector<double> times_s;
  std::size_t from = 0;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    while (pairs[i].time_s - pairs[from].time_s > limits.slip_s + 1e-9 && from + 1 < i) ++from;
    const auto error = motionError(pairs[from], pairs[i]);
    if (lengthOf(error) > limits.slip_m || std::abs(core::wrapToPi(error.phi)) > limits.slip_rad)
      times_s.push_back(pairs[i].time_s);
  }
  return times_s;
}

/// The gravest first; what each event of a journal or the recording stands for.
const std::vector<std::pair<std::string, std::string>>& suspects() {
  static const std::vector<std::pair<std::string, std::string>> list = {
      {kKidnappedEvent, "kidnapped"}, {kFalseLoopEvent, "false loop closure"},
      {kCollisionEvent, "collision"}, {kSlipEvent, "slip"},
      {"distrusted", "slip"},         {"lost", "lost"},
      {"restarted", "lost"},          {"poor", "lost"},
      {"degenerate", "degenerate"}};
  return list;
}

}  // namespace

std::optional<Divergence> firstDivergence(const core::Trajectory& truth, const core::Trajectory& estimate,
                                          const FailureLimits& limits) {
  const auto pairs = paired(truth, estimate);
  if (pairs.size() < 2) return std::nullopt;
  const double start_s = estimate.front().time_s;
  std::vector<double> errors_m;  // of the positions, start laid on start
  errors_m.reserve(pairs.size());
  for (const auto& pair : pairs) errors_m.push_back(lengthOf(motionError(pairs.front(), pair)));
  std::size_t from = 0;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    while (pairs[i].time_s - pairs[from].time_s > limits.window_s + 1e-9 && from + 1 < i) ++from;
    const auto error = motionError(pairs[from], pairs[i]);
    const double error_m = lengthOf(error), error_rad = std::abs(core::wrapToPi(error.phi));
    const bool is_jump = error_m > limits.jump_m || error_rad > limits.jump_rad;
    const double growth_m = errors_m[i] - errors_m[from];
    // A turn that goes wrong moves the position only later.
    const bool turned_wrong = error_rad > limits.jump_rad && growth_m > -limits.jump_m / 2;
    if (is_jump && (growth_m > std::min(error_m, limits.jump_m) / 2 || turned_wrong)) {
      const auto& onset = pairs[onsetIn(pairs, from, i, limits)];
      return Divergence{Divergence::kJump, onset.time_s - start_s, core::position(onset.T_world_robot),
                        error_m, error_rad};
    }
    if (errors_m[i] > limits.drift_m)
      return Divergence{Divergence::kDrift, pairs[i].time_s - start_s, core::position(pairs[i].T_world_robot),
                        errors_m[i], std::abs(core::wrapToPi(motionError(pairs.front(), pairs[i]).phi))};
  }
  return std::nullopt;
}

std::vector<WrongLoop> wrongLoops(const core::Trajectory& truth,
                                  const std::vector<core::JournalLine>& journal,
                                  const std::vector<double>& scan_stamps_s, const FailureLimits& limits) {
  std::vector<WrongLoop> loops;
  const auto truthOf = [&](int scan, core::Pose2& pose) {
    const auto index = static_cast<std::size_t>(scan);
    return scan >= 0 && index < scan_stamps_s.size() && metrics::poseAt(truth, scan_stamps_s[index], pose);
  };
  for (const auto& line : journal) {
    core::Pose2 here, there;
    if (line.event != core::JournalEvent::kAccepted || !truthOf(line.scan, here) ||
        !truthOf(line.other_scan, there))
      continue;
    const double apart_m = core::distance(here, there);
    const double apart_in_map_m = core::distance(line.place, line.other_place);
    if (apart_m - apart_in_map_m > limits.wrong_loop_m)
      loops.push_back(
          {line.scan, line.other_scan, line.time_s, core::position(here), apart_m, apart_in_map_m});
  }
  return loops;
}

std::optional<WorstRegion> worstRegion(const world::Plan& plan, const metrics::SeenMask& seen,
                                       const world::CellMap& map, const core::Pose2& T_world_map,
                                       const FailureLimits& limits) {
  if (!core::isFinite(T_world_map)) return std::nullopt;
  std::vector<core::Point2> true_walls, mapped_walls;
  const auto centreOf = [](const world::CellMap& raster, int column, int row) {
    return world::cellsToPoint(raster, {column + 0.5, row + 0.5});
  };
  for (int row = 0; row < plan.rows; ++row)
    for (int column = 0; column < plan.columns; ++column)
      if (seen.wall[static_cast<std::size_t>(row) * plan.columns + column])
        true_walls.push_back(centreOf(plan, column, row));
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column)
      if (map.at(column, row) == world::Cell::kOccupied)
        mapped_walls.push_back(T_world_map * centreOf(map, column, row));
  std::map<std::pair<int, int>, WorstRegion> regions;
  const auto add = [&](const std::vector<core::Point2>& walls, const metrics::NearestPoints& others,
                       double length_m, double WorstRegion::*member) {
    for (const auto& p : walls) {
      if (others.distance(p) <= kWallTolerance_m) continue;
      const std::pair square{static_cast<int>(std::floor(p.x / limits.region_m)),
                             static_cast<int>(std::floor(p.y / limits.region_m))};
      auto& region = regions[square];
      region.centre = {(square.first + 0.5) * limits.region_m, (square.second + 0.5) * limits.region_m};
      region.*member += length_m;
    }
  };
  add(true_walls, metrics::NearestPoints(mapped_walls), plan.resolution_m, &WorstRegion::missing_wall_m);
  add(mapped_walls, metrics::NearestPoints(true_walls), map.resolution_m, &WorstRegion::false_wall_m);
  std::optional<WorstRegion> worst;
  const auto wrong = [](const WorstRegion& r) { return r.missing_wall_m + r.false_wall_m; };
  for (const auto& [square, region] : regions)
    if (!worst || wrong(region) > wrong(*worst)) worst = region;
  return worst;
}

FailureReport explainFailure(const results::RunFolder& run, const Truth& truth,
                             const FailureEvidence& evidence, const FailureLimits& limits) {
  const auto& journal = evidence.journal;
  FailureReport report;
  std::vector<double> stamps_s;
  for (const auto& pose : run.estimate) stamps_s.push_back(pose.time_s);
  report.wrong_loops = wrongLoops(truth.trajectory, journal, stamps_s, limits);
  report.divergence = firstDivergence(truth.trajectory, run.estimate, limits);
  if (!report.divergence) return report;

  std::map<std::string, Events> events;
  const auto note = [&](const std::string& name, double time_s) {
    if (std::abs(time_s - report.divergence->time_s) > limits.around_s) return;
    const auto [it, is_new] = events.try_emplace(name, Events{time_s, time_s});
    it->second.first_s = std::min(it->second.first_s, time_s);
    it->second.last_s = std::max(it->second.last_s, time_s);
    ++it->second.count;
  };
  for (const auto& loop : report.wrong_loops) note(kFalseLoopEvent, loop.time_s);
  for (const auto& collision : evidence.collisions)
    note(kCollisionEvent, collision.time_s - run.estimate.front().time_s);
  for (const auto& carry : evidence.carries)
    note(kKidnappedEvent, carry.time_s - run.estimate.front().time_s);
  for (const double time_s : slipTimes(truth.trajectory, evidence.odometry, limits))
    note(kSlipEvent, time_s - run.estimate.front().time_s);
  for (const auto& line : journal)
    for (const auto& [event, suspect] : suspects())
      if (core::wordOf(line.event) == event) note(event, line.time_s);

  std::vector<std::pair<std::string, Events>> in_time(events.begin(), events.end());
  std::stable_sort(in_time.begin(), in_time.end(),
                   [](const auto& a, const auto& b) { return a.second.first_s < b.second.first_s; });
  for (const auto& [name, of] : in_time) report.around.push_back(textOf(name, of));
  report.suspect = "unknown";
  for (const auto& [event, suspect] : suspects())
    if (events.count(event)) {
      report.suspect = suspect;
      break;
    }
  if (truth.plan && truth.seen) {
    const auto& path = run.final_estimate ? *run.final_estimate : run.estimate;
    report.region = worstRegion(*truth.plan, *truth.seen, run.map,
                                metrics::trajectoryError(truth.trajectory, path).T_truth_estimate, limits);
  }
  return report;
}

FailureEvidence readEvidence(const results::RunFolder& run, const std::string& truth_path,
                             const std::string& log_path) {
  FailureEvidence evidence;
  const std::string journal_path = run.path + "/journal.csv";
  if (fs::exists(journal_path)) evidence.journal = results::readJournal(journal_path);
  evidence.collisions = truth::readCollisions(truth::collisionsPath(truth_path));
  evidence.carries = truth::readCarryFile(truth::carriesPath(truth_path));
  if (log_path.empty() || !fs::exists(log_path)) return evidence;
  logs::LogReader log(log_path);
  while (const auto entry = log.next())
    // A log whose stamps run back has no path of its odometry in time.
    if (evidence.odometry.empty() || entry->scan.time_s > evidence.odometry.back().time_s)
      evidence.odometry.push_back({entry->scan.time_s, entry->T_odom_robot});
  return evidence;
}

table::Table failureTable(const FailureReport& report, const std::string& method) {
  table::Table table;
  table.caption = "Where and why " + method + " failed";
  table.columns = {{"what", "what", 0}, {"value", "value", 0}};
  const auto add = [&](const std::string& what, const std::string& value) {
    table.rows.push_back({what, value});
  };
  if (report.divergence) {
    const auto& d = *report.divergence;
    add("first divergence", std::string(d.kind == Divergence::kJump ? kJumpWord : kDriftWord) + " at " +
                                table::fixed(d.time_s, 1) + " s, " + at(d.place));
    add("error there",
        table::fixed(d.error_m, 2) + " m, " + table::fixed(core::radToDeg(d.error_rad), 1) + " degrees");
    add("suspect", report.suspect);
  } else {
    add("first divergence", "none");
  }
  for (const auto& line : report.around) add("around it", line);
  for (const auto& loop : report.wrong_loops)
    add("false loop closure", "scan " + std::to_string(loop.scan) + " to " + std::to_string(loop.other_scan) +
                                  " at " + table::fixed(loop.time_s, 1) +
                                  " s: " + table::fixed(loop.apart_m, 2) + " m apart in truth, " +
                                  table::fixed(loop.apart_in_map_m, 2) + " m in the map");
  if (report.region)
    add("worst region of the map",
        at(report.region->centre) + ": " + table::fixed(report.region->missing_wall_m, 1) +
            " m of wall missing, " + table::fixed(report.region->false_wall_m, 1) + " m false");
  return table;
}

std::string failureJson(const FailureReport& report) {
  const auto& d = report.divergence.value();
  Json json = {{"divergence", d.kind == Divergence::kJump ? kJumpWord : kDriftWord},
               {"time_s", d.time_s},
               {"x_m", d.place.x},
               {"y_m", d.place.y},
               {"error_m", d.error_m},
               {"error_rad", d.error_rad},
               {"suspect", report.suspect},
               {"around", report.around},
               {"wrong_loops", Json::array()}};
  for (const auto& loop : report.wrong_loops)
    json["wrong_loops"].push_back({{"scan", loop.scan},
                                   {"other_scan", loop.other_scan},
                                   {"time_s", loop.time_s},
                                   {"x_m", loop.place.x},
                                   {"y_m", loop.place.y},
                                   {"apart_m", loop.apart_m},
                                   {"apart_in_map_m", loop.apart_in_map_m}});
  if (report.region)
    json["worst_region"] = {{"x_m", report.region->centre.x},
                            {"y_m", report.region->centre.y},
                            {"missing_wall_m", report.region->missing_wall_m},
                            {"false_wall_m", report.region->false_wall_m}};
  return json.dump(2) + "\n";
}

FailureReport readFailure(const std::string& path) {
  try {
    const auto json = Json::parse(files::readTextFile(path));
    FailureReport report;
    report.divergence =
        Divergence{json.at("divergence") == kJumpWord ? Divergence::kJump : Divergence::kDrift,
                   json.at("time_s"),
                   {json.at("x_m"), json.at("y_m")},
                   json.at("error_m"),
                   json.at("error_rad")};
    json.at("suspect").get_to(report.suspect);
    json.at("around").get_to(report.around);
    for (const auto& loop : json.at("wrong_loops"))
      report.wrong_loops.push_back({loop.at("scan"),
                                    loop.at("other_scan"),
                                    loop.at("time_s"),
                                    {loop.at("x_m"), loop.at("y_m")},
                                    loop.at("apart_m"),
                                    loop.at("apart_in_map_m")});
    if (const auto region = json.find("worst_region"); region != json.end())
      report.region = WorstRegion{
          {region->at("x_m"), region->at("y_m")}, region->at("missing_wall_m"), region->at("false_wall_m")};
    return report;
  } catch (const Json::exception& error) {
    throw core::InputError(path + ": does not say where a run failed: " + error.what());
  }
}

}  // namespace slam::score

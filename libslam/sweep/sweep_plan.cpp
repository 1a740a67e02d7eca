#include "libslam/sweep/sweep_plan.h"

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/resources/code_version.h"
#include "libslam/resources/file_hash.h"

namespace slam::sweep {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

/// "section.key" -> value, for all sections.
Json toJson(const files::IniFile& config) {
  auto json = Json::object();
  for (const auto& [section, entries] : config.sections())
    for (const auto& [key, entry] : entries) json[section + "." + key] = entry.value;
  return json;
}

std::string textOf(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string logSpec(const SuiteWorld& world, const files::IniFile& config, std::uint64_t seed,
                    const std::string& code) {
  Json ground = {{"name", world.name}, {"plan_sha256", world.sha256}};
  if (world.plan_path.empty()) {
    ground["kind"] = world.kind;
    ground["building"] = toJson(world.building);
    ground["seed"] = world.seed;
  }
  return textOf(
      {{"kind", "log"}, {"code", code}, {"world", ground}, {"config", toJson(config)}, {"seed", seed}});
}

std::string runSpec(const PlannedLog& log, const SuiteMethod& method, std::uint64_t seed,
                    const std::string& code) {
  Json spec = {{"kind", "run"},
               {"code", code},
               {"log", log.id},
               {"method", method.name},
               {"config", toJson(method.config)},
               {"seed", seed}};
  if (!method.programs.empty()) spec["programs_sha256"] = method.programs;
  return textOf(spec);
}

void addLog(Sweep& sweep, PlannedLog log, std::string spec, std::size_t ground) {
  sweep.plan.logs.push_back(std::move(log));
  sweep.log_specs.push_back(std::move(spec));
  sweep.ground.push_back(ground);
}

void addRuns(Sweep& sweep, std::uint64_t seed) {
  const std::size_t log = sweep.plan.logs.size() - 1;
  for (const auto& method : sweep.suite.methods) {
    auto spec = runSpec(sweep.plan.logs[log], method, seed, sweep.plan.code);
    sweep.plan.runs.push_back({cellId(spec), log, seed, method.name, method.parameters});
    sweep.run_specs.push_back(std::move(spec));
  }
}

/// Calls visit(log without id and seed, its configuration) for every combination of the axes in a world.
template <class Visit>
void forEachCombination(const Suite& suite, const SuiteWorld& world, const Visit& visit) {
  for (const auto& robot : suite.robots)
    for (const auto& lidar : suite.lidars)
      for (const auto& odometry : suite.odometry)
        for (const auto& strategy : suite.strategies)
          for (const auto& fault : suite.faults)
            visit(PlannedLog{"", world.name, robot.name, lidar.name, odometry.name, strategy.name, fault.name,
                             0, true},
                  layered(suite, robot, lidar, odometry, strategy, fault));
}

std::string placeOf(const PlannedLog& log) {
  std::string text = log.world;
  for (const auto& name : {log.robot, log.lidar, log.odometry, log.strategy, log.fault}) text += ", " + name;
  return text + ", seed " + std::to_string(log.seed);
}

/// Two cells with one id would be one folder.
void rejectEqualCells(const Sweep& sweep) {
  const auto& plan = sweep.plan;
  std::map<std::string, std::string> places;
  const auto add = [&](const std::string& id, const std::string& place) {
    const auto [it, is_new] = places.emplace(id, place);
    if (!is_new)
      throw core::InputError(sweep.suite.path + ": two cells are the same: " + it->second + "; and " + place);
  };
  for (const auto& log : plan.logs) add(log.id, placeOf(log));
  for (const auto& run : plan.runs)
    add(run.id, run.method + " " + run.parameters + " on " + placeOf(plan.logs[run.log]));
}

}  // namespace

std::string cellId(const std::string& spec) {
  return resources::sha256(spec).substr(0, 16);
}

Sweep planSweep(Suite suite) {
  Sweep sweep;
  sweep.suite = std::move(suite);
  const Suite& s = sweep.suite;
  sweep.plan.name = fs::path(s.path).stem().string();
  sweep.plan.code = resources::codeVersion();
  sweep.plan.suite_folder = s.folder;
  sweep.plan.baseline = s.options.baseline;
  sweep.plan.metric = s.options.metric;
  sweep.plan.failure_ate_m = s.options.failure_ate_m;
  for (std::size_t i = 0; i < s.worlds.size(); ++i)
    forEachCombination(s, s.worlds[i], [&](PlannedLog log, const files::IniFile& config) {
      for (const auto seed : s.seeds) {
        std::string spec = logSpec(s.worlds[i], config, seed, sweep.plan.code);
        log.id = cellId(spec);
        log.seed = seed;
        addLog(sweep, log, std::move(spec), i);
        addRuns(sweep, seed);
      }
    });
  for (std::size_t i = 0; i < s.logs.size(); ++i) {
    const std::string id = cellId(textOf({{"kind", "existing log"}, {"sha256", s.logs[i].sha256}}));
    addLog(sweep, {id, s.logs[i].name, "-", "-", "-", "-", "-", 0, false}, "", i);
    for (const auto seed : s.seeds) addRuns(sweep, seed);
  }
  rejectEqualCells(sweep);
  return sweep;
}

Sweep planSweep(const std::string& suite_path) {
  const auto path = fs::absolute(suite_path);
  const auto plan_path = path.parent_path() / "plan.json";
  if (path.filename() != "suite.ini" || !fs::exists(plan_path)) return planSweep(readSuite(suite_path));
  const auto original = readSweepPlan(plan_path.string());
  Sweep sweep = planSweep(readSuite(suite_path, original.suite_folder));
  sweep.plan.name = original.name;
  return sweep;
}

bool areSame(const SweepPlan& a, const SweepPlan& b) {
  SweepPlan moved = b;
  moved.suite_folder = a.suite_folder;
  return toJson(a, a.suite_folder) == toJson(moved, a.suite_folder);
}

std::string toJson(const SweepPlan& plan, const std::string& folder) {
  const auto absolute = [](const std::string& path) { return (fs::absolute(path) / "").lexically_normal(); };
  const auto suite_folder = absolute(plan.suite_folder).lexically_relative(absolute(folder));
  auto line = [](const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); };
  std::string text = "{\"suite\": " + line(plan.name) + ",\n \"code\": " + line(plan.code) +
                     ",\n \"suite_folder\": " + line(suite_folder.generic_string()) +
                     ",\n \"baseline\": " + line(plan.baseline) + ",\n \"metric\": " + line(plan.metric) +
                     ",\n \"failure_ate_m\": " + line(plan.failure_ate_m) + ",\n \"logs\": [";
  const char* comma = "\n  ";
  for (const auto& log : plan.logs) {
    text += comma + line({{"id", log.id},
                          {"world", log.world},
                          {"robot", log.robot},
                          {"lidar", log.lidar},
                          {"odometry", log.odometry},
                          {"strategy", log.strategy},
                          {"fault", log.fault},
                          {"seed", log.seed},
                          {"simulated", log.simulated}});
    comma = ",\n  ";
  }
  text += "],\n \"runs\": [";
  comma = "\n  ";
  for (const auto& run : plan.runs) {
    text += comma + line({{"id", run.id},
                          {"log", run.log},
                          {"seed", run.seed},
                          {"method", run.method},
                          {"parameters", run.parameters}});
    comma = ",\n  ";
  }
  return text + "]}\n";
}

SweepPlan readSweepPlan(const std::string& path) {
  const std::string text = files::readTextFile(path);
  SweepPlan plan;
  try {
    const auto json = Json::parse(text);
    json.at("suite").get_to(plan.name);
    json.at("code").get_to(plan.code);
    plan.suite_folder = (fs::absolute(path).parent_path() / json.at("suite_folder").get<std::string>())
                            .lexically_normal()
                            .string();
    json.at("baseline").get_to(plan.baseline);
    json.at("metric").get_to(plan.metric);
    json.at("failure_ate_m").get_to(plan.failure_ate_m);
    for (const auto& row : json.at("logs"))
      plan.logs.push_back({row.at("id"), row.at("world"), row.at("robot"), row.at("lidar"),
                           row.at("odometry"), row.at("strategy"), row.at("fault"), row.at("seed"),
                           row.at("simulated")});
    for (const auto& row : json.at("runs")) {
      plan.runs.push_back(
          {row.at("id"), row.at("log"), row.at("seed"), row.at("method"), row.at("parameters")});
      if (plan.runs.back().log >= plan.logs.size())
        throw core::InputError(path + ": run " + plan.runs.back().id + " names a log that is not there");
    }
  } catch (const Json::exception& error) {
    throw core::InputError(path + ": not the plan of a sweep: " + error.what());
  }
  return plan;
}

table::Table planTable(const SweepPlan& plan) {
  table::Table table;
  table.caption = "Sweep " + plan.name + ": " + std::to_string(plan.logs.size()) + " logs, " +
                  std::to_string(plan.runs.size()) + " runs, code " + plan.code;
  for (const char* key : {"run", "log", "world", "robot", "lidar", "odometry", "strategy", "fault", "seed",
                          "method", "parameters"})
    table.columns.push_back({key, key, 0});
  for (const auto& run : plan.runs) {
    const auto& log = plan.logs[run.log];
    table.rows.push_back({run.id, log.id, log.world, log.robot, log.lidar, log.odometry, log.strategy,
                          log.fault, std::to_string(run.seed), run.method, run.parameters});
  }
  return table;
}

}  // namespace slam::sweep

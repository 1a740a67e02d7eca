#include "libslam/study/stress.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libslam/buildings/generator.h"
#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/files/word_list.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/resources.h"
#include "libslam/stats/bootstrap.h"
#include "libslam/stats/proportion.h"
#include "libslam/study/stress_charts.h"
#include "libslam/study/value_range.h"
#include "libslam/summary/sweep_groups.h"

namespace slam::study {
namespace fs = std::filesystem;
namespace {

using core::kNaN;
constexpr int kSteps = 6;
constexpr int kResamples = 2000;
constexpr const char* kVary = "--vary";
const std::string kWorldPrefix = "world.";

std::string valueOf(const files::IniFile& ini, const std::string& key) {
  const auto* entry = ini.find("suite", key);
  return entry ? entry->value : "";
}

files::IniFile suiteOfWorld(const std::string& world) {
  files::IniFile ini;
  ini.set("suite", "worlds", world, world);
  ini.set("suite", "methods", "graph, icp_exact", "built-in");
  ini.set("suite", "seeds", "1..5", "built-in");
  ini.set("suite", "failure_ate_m", "1", "built-in");
  ini.set("simulation", "duration_s", "120", "built-in");
  return ini;
}

/// Whether a parameter of the simulation takes whole numbers. Errors: InputError when it takes no numbers, or
/// is none.
bool takesWholeNumbers(const std::string& key) {
  std::vector<std::string> known;
  for (const auto& parameter : record::readRecordConfig(files::IniFile()).parameters) {
    const std::string name = parameter.section + "." + parameter.info.key;
    if (std::holds_alternative<int>(parameter.info.default_value)) {
      if (name == key) return true;
    } else if (std::holds_alternative<double>(parameter.info.default_value)) {
      if (name == key) return false;
    } else {
      continue;
    }
    known.push_back(name);
  }
  throw core::InputError(
      std::string(kVary) + ": found '" + key +
      "', expected a number of the simulation ('simulate --print-config' lists them) or world.KEY" +
      core::didYouMean(key, known));
}

void requireBuildingKey(const std::string& key) {
  std::vector<std::string> known;
  for (const auto& row : buildings::BuildingOptions::table().rows()) known.push_back(row.info.key);
  if (std::find(known.begin(), known.end(), key) == known.end())
    throw core::InputError(std::string(kVary) + ": found 'world." + key + "', expected a key of [building]" +
                           core::didYouMean(key, known));
}

/// Section [world ...] of an entry of the list of worlds, for generateWorld().
std::map<std::string, files::IniFile::Entry> generatedWorld(const files::IniFile& ini,
                                                            const std::string& entry) {
  const auto section = ini.sections().find("world " + entry);
  std::map<std::string, files::IniFile::Entry> keys;
  if (section != ini.sections().end()) {
    keys = section->second;
  } else if (entry.find(':') != std::string::npos) {
    const auto parts = files::splitAt(entry, ':');
    keys["kind"] = {parts.front(), entry};
    for (std::size_t i = 1; i < parts.size(); ++i) {
      const auto equals = parts[i].find('=');
      if (equals == std::string::npos)
        throw core::InputError("found '" + entry + "', expected KIND:key=value:key=value");
      keys[files::trimmed(parts[i].substr(0, equals))] = {files::trimmed(parts[i].substr(equals + 1)), entry};
    }
  }
  std::vector<std::string> kinds;
  for (const auto& kind : buildings::buildingKinds()) kinds.push_back(kind.name);
  const auto kind = keys.find("kind");
  if (kind == keys.end() || std::find(kinds.begin(), kinds.end(), kind->second.value) == kinds.end())
    throw core::InputError(std::string(kVary) + ": world '" + entry +
                           "' is not generated, expected KIND:key=value of 'rasterslam world make'");
  return keys;
}

void varyWorlds(files::IniFile& ini, const std::string& key, StressSuite& stress) {
  files::IniFile varied;
  std::string list;
  const auto worlds = files::splitAt(valueOf(ini, "worlds"), ',');
  for (const auto& [section, entries] : ini.sections())
    if (section.compare(0, 6, "world ") != 0)
      for (const auto& [name, entry] : entries) varied.set(section, name, entry.value, entry.origin);
  for (const auto& world : worlds) {
    auto keys = generatedWorld(ini, world);
    for (std::size_t i = 0; i < stress.values.size(); ++i) {
      std::string name = world + " " + key + "=" + files::formatNumber(stress.values[i]);
      std::replace(name.begin(), name.end(), ':', ' ');
      keys[key] = {files::formatNumber(stress.values[i]), kVary};
      for (const auto& [own, entry] : keys) varied.set("world " + name, own, entry.value, entry.origin);
      stress.names[i].insert(name);
      list += (list.empty() ? "" : ", ") + name;
    }
  }
  varied.set("suite", "worlds", list, kVary);
  ini = std::move(varied);
}

void varySimulation(files::IniFile& ini, StressSuite& stress) {
  const auto faults = valueOf(ini, "faults");
  if (!faults.empty() && faults != "built-in")
    throw core::InputError(ini.find("suite", "faults")->origin + ": found faults '" + faults +
                           "', expected none beside --vary, whose values take their place");
  std::string list;
  for (std::size_t i = 0; i < stress.values.size(); ++i) {
    const std::string value = files::formatNumber(stress.values[i]);
    const std::string name = stress.key + "=" + value;
    ini.set("fault " + name, stress.key, value, kVary);
    stress.names[i].insert(name);
    list += (list.empty() ? "" : ", ") + name;
  }
  ini.set("suite", "faults", list, kVary);
}

/// One value and method.
struct Point {
  std::size_t runs = 0, failed = 0;
  double failure_rate = kNaN;
  stats::Interval failure_interval;
  stats::Estimate error{kNaN, std::nullopt};
  bool isBroken(const StressLimits& limits) const {
    if (runs == 0) return false;
    if (failure_interval.low > limits.failure_rate) return true;
    return limits.error > 0 && error.interval && error.interval->low > limits.error;
  }
};

Point pointOf(const sweep::SweepPlan& plan, const summary::SweepResults& results,
              const std::vector<std::size_t>& runs) {
  Point point;
  std::vector<double> errors;
  std::vector<std::size_t> with_error;
  for (const auto run : runs) {
    if (!results[run]) continue;
    ++point.runs;
    point.failed += summary::isFailed(plan, *results[run]) ? 1 : 0;
    if (const double error = summary::rankedValue(plan, results[run]); !std::isnan(error))
      errors.push_back(error), with_error.push_back(run);
  }
  point.failure_interval = stats::clopperPearson(point.failed, point.runs);
  if (point.runs > 0)
    point.failure_rate = static_cast<double>(point.failed) / static_cast<double>(point.runs);
  if (!errors.empty())
    point.error =
        stats::bootstrapMedian(errors, {0.95, 1, kResamples, summary::settingsOf(plan, with_error)});
  return point;
}

std::string listOf(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + files::formatNumber(value);
  return text;
}

/// At which values runs failed, too few to prove that the method is broken there; "" where none did.
std::string unprovenText(const std::vector<double>& values, const std::vector<Point>& points,
                         const StressLimits& limits) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (points[i].failed > 0 && !points[i].isBroken(limits))
      text += (text.empty() ? "" : ", ") + std::to_string(points[i].failed) + " of " +
              std::to_string(points[i].runs) + " at " + files::formatNumber(values[i]);
  return text;
}

/// Of one method. REQUIRES values ascending, points of the same length.
std::string textOf(const std::vector<double>& values, const std::vector<Point>& points,
                   const StressLimits& limits) {
  std::vector<bool> is_broken;
  is_broken.reserve(points.size());
  for (const auto& point : points) is_broken.push_back(point.isBroken(limits));
  const std::size_t count = values.size();
  std::size_t below = 0, above = 0;  // values broken without a gap from either end
  while (below < count && is_broken[below]) ++below;
  while (above < count && is_broken[count - 1 - above]) ++above;
  if (below == count) return "broken everywhere";
  const auto number = [&](std::size_t i) { return files::formatNumber(values[i]); };
  std::string text;
  if (below > 0) text = "breaks at " + number(below - 1) + " and below (holds at " + number(below) + ")";
  if (above > 0)
    text += (text.empty() ? "" : "; ") + std::string("breaks at ") + number(count - above) +
            " and above (holds at " + number(count - above - 1) + ")";
  std::vector<double> between;
  for (std::size_t i = below; i + above < count; ++i)
    if (is_broken[i]) between.push_back(values[i]);
  if (!between.empty()) text += (text.empty() ? "" : "; ") + std::string("broken at ") + listOf(between);
  const std::string unproven = unprovenText(values, points, limits);
  if (text.empty()) text = unproven.empty() ? "holds everywhere" : "not proven to break";
  return unproven.empty() ? text : text + "; failed, too few to prove it: " + unproven;
}

/// By value and method.
using RunsByValue = std::vector<std::vector<std::vector<std::size_t>>>;

RunsByValue runsByValue(const StressSuite& suite, const sweep::SweepPlan& plan,
                        const std::vector<std::string>& methods) {
  RunsByValue runs(suite.values.size(), std::vector<std::vector<std::size_t>>(methods.size()));
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    const auto& log = plan.logs[plan.runs[i].log];
    const auto& name = suite.is_of_world ? log.world : log.fault;
    const auto method =
        std::find(methods.begin(), methods.end(), summary::fullName(plan.runs[i])) - methods.begin();
    for (std::size_t v = 0; v < suite.values.size(); ++v)
      if (suite.names[v].count(name)) runs[v][static_cast<std::size_t>(method)].push_back(i);
  }
  return runs;
}

StressResult emptyResult(const std::string& varied, const std::string& metric) {
  StressResult result;
  result.main.columns = {{"value", varied, 6},    {"method", "method", 0}, {"runs", "runs", 0},
                         {"failed", "failed", 0}, {metric, metric, 0},     {"broken", "broken", 0}};
  result.all.columns = {{"key", "key", 0},
                        {"value", varied, 6},
                        {"method", "method", 0},
                        {"runs", "runs", 0},
                        {"failed", "failed", 0}};
  for (const char* key : {"failure_rate", "failure_rate_low", "failure_rate_high"})
    result.all.columns.push_back({key, key, 3});
  for (const char* part : {"", "_low", "_high"})
    result.all.columns.push_back({metric + part, metric + part, 4});
  result.all.columns.push_back({"broken", "broken", 0});
  return result;
}

/// One value's row in both tables, and what it says of where the method breaks.
void addPoint(const std::string& varied, double value, const Point& point, const StressLimits& limits,
              BreakingPoint& breaks, StressResult& result) {
  const bool is_broken = point.isBroken(limits);
  const std::string word = point.runs == 0 ? "-" : (is_broken ? "yes" : "no");
  if (is_broken) breaks.broken.push_back(value);
  if (point.runs == 0) breaks.unknown.push_back(value);
  result.main.rows.push_back({files::formatNumber(value), breaks.method, static_cast<double>(point.runs),
                              summary::withInterval({point.failure_rate, point.failure_interval}, 2),
                              summary::withInterval(point.error, 3), word});
  const double low = point.error.interval ? point.error.interval->low : kNaN;
  const double high = point.error.interval ? point.error.interval->high : kNaN;
  result.all.rows.push_back({varied, value, breaks.method, static_cast<double>(point.runs),
                             static_cast<double>(point.failed), point.failure_rate,
                             point.failure_interval.low, point.failure_interval.high, point.error.value, low,
                             high, word});
}

/// What is called broken, and what failed.
std::string ruleText(const sweep::SweepPlan& plan, const StressLimits& limits) {
  std::string rule =
      "Broken: the 95 % interval of the failure rate lies above " + files::formatNumber(limits.failure_rate);
  if (limits.error > 0)
    rule += ", or that of the median " + plan.metric + " above " + files::formatNumber(limits.error);
  rule += "; what the seeds do not prove is not called broken. Failed: not ok";
  if (plan.failure_ate_m > 0)
    rule += ", or more than " + files::formatNumber(plan.failure_ate_m) + " m off in the final path";
  return rule + ".";
}

}  // namespace

StressSuite stressSuite(const StressRequest& request) {
  const auto equals = request.vary.find('=');
  if (equals == std::string::npos || equals == 0)
    throw core::InputError(std::string(kVary) + ": found '" + request.vary +
                           "', expected KEY=VALUES, such as lidar.fov_deg=30..360:6");
  StressSuite stress;
  stress.key = files::trimmed(request.vary.substr(0, equals));
  stress.is_of_world = stress.key.compare(0, kWorldPrefix.size(), kWorldPrefix) == 0;
  const std::string building_key = stress.is_of_world ? stress.key.substr(kWorldPrefix.size()) : "";
  if (stress.is_of_world) requireBuildingKey(building_key);
  const bool whole = !stress.is_of_world && takesWholeNumbers(stress.key);
  const auto range = readValueRange(request.vary.substr(equals + 1), kVary);
  stress.values = spacedValues(range, kSteps, whole, kVary);
  stress.names.resize(stress.values.size());

  const bool is_suite = sweep::isSuiteFile(request.ground);
  auto ini = is_suite ? resources::readConfigFile(request.ground) : suiteOfWorld(request.ground);
  if (!request.methods.empty()) {
    ini.set("suite", "methods", request.methods, "--methods");
    ini.set("suite", "baseline", "", "--methods");
  }
  if (!request.seeds.empty()) ini.set("suite", "seeds", request.seeds, "--seeds");
  if (!valueOf(ini, "logs").empty())
    throw core::InputError(
        ini.find("suite", "logs")->origin +
        ": names logs that exist already, expected only worlds to simulate in with --vary");
  ini.overrideWith(request.settings);
  if (stress.is_of_world)
    varyWorlds(ini, building_key, stress);
  else
    varySimulation(ini, stress);
  const std::string folder =
      is_suite ? fs::absolute(request.ground).parent_path().string() : fs::current_path().string();
  stress.suite = sweep::readSuite(ini, request.ground, folder);
  return stress;
}

StressResult stress(const StressSuite& suite, const sweep::SweepPlan& plan,
                    const summary::SweepResults& results, const StressLimits& limits) {
  if (limits.error > 0 && summary::betterOf(plan.metric) == stats::Better::kLarger)
    throw core::InputError("an error limit needs a metric of which less is better, found " + plan.metric);
  const auto methods = summary::methodNames(plan);
  const RunsByValue runs = runsByValue(suite, plan, methods);
  StressResult result = emptyResult(suite.key, plan.metric);
  std::vector<std::vector<Point>> points(methods.size());
  for (const auto& method : methods) result.breaks.push_back({method, {}, {}, ""});
  for (std::size_t v = 0; v < suite.values.size(); ++v)
    for (std::size_t m = 0; m < methods.size(); ++m) {
      points[m].push_back(pointOf(plan, results, runs[v][m]));
      addPoint(suite.key, suite.values[v], points[m].back(), limits, result.breaks[m], result);
    }
  result.charts = stressCharts(result.all, "stress.csv");

  std::vector<std::string> notes;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    auto& breaks = result.breaks[m];
    breaks.text = textOf(suite.values, points[m], limits);
    if (!breaks.unknown.empty()) breaks.text += "; nothing known at " + listOf(breaks.unknown);
    notes.push_back(breaks.method + ": " + breaks.text + ".");
  }
  notes.push_back(ruleText(plan, limits));
  const bool is_single = std::any_of(runs.begin(), runs.end(), [](const auto& of_value) {
    return std::any_of(of_value.begin(), of_value.end(), [](const auto& list) { return list.size() == 1; });
  });
  if (is_single)
    notes.emplace_back(
        "One run with one seed per row: differences may be chance, and nothing can be proven.");
  for (auto* table : {&result.main, &result.all}) {
    table->caption = "Stress on " + plan.name + ": " + suite.key + " against median " + plan.metric +
                     " and failed runs, with 95 % intervals";
    table->notes = notes;
  }
  return result;
}

}  // namespace slam::study

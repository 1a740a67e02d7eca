#include "libslam/sweep/suite.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <set>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/core/ini_text.h"
#include "libslam/core/ini_yaml.h"
#include "libslam/core/resources.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/relations_io.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/record/generated_world.h"
#include "libslam/record/truth_files.h"
#include "libslam/run/external_method.h"

namespace slam::sweep {
namespace fs = std::filesystem;
namespace {

constexpr const char* kBuiltIn = "built-in";
constexpr std::size_t kMostSeeds = 100000;
const std::vector<std::string> kRecordSections = {"robot",       "sensor",     "lidar",    "camera",
                                                  "camera_scan", "odometry",   "strategy", "obstacles",
                                                  "living",      "simulation", "events"};

std::vector<std::string> splitAt(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);) parts.push_back(core::trimmed(part));
  return parts;
}

bool looksLikePath(const std::string& word) {
  return word.find_first_of("/.") != std::string::npos;
}

/// What reads one suite: the file, and which of its sections were named by a list.
class SuiteReader {
 public:
  SuiteReader(const std::string& path, const std::string& folder) {
    suite_.path = path;
    suite_.text = core::readTextFile(path);
    suite_.folder = folder.empty() ? fs::absolute(path).parent_path().string() : folder;
    if (core::isYamlFile(path)) {
      ini_ = core::parseYaml(suite_.text, path);
      suite_.text = core::toText(ini_);
    } else {
      ini_ = core::IniFile::parse(suite_.text, path);
    }
  }
  SuiteReader(core::IniFile ini, const std::string& path, const std::string& folder) : ini_(std::move(ini)) {
    suite_.path = path;
    suite_.text = core::toText(ini_);
    suite_.folder = folder;
  }

  Suite read() {
    rejectUnknownKinds();
    core::readParameters(ini_, SuiteOptions::table(), suite_.options);
    core::readParameters(ini_, CellLimits::table(), suite_.limits);
    for (const auto& section : kRecordSections)
      if (const auto it = ini_.sections().find(section); it != ini_.sections().end())
        for (const auto& [key, entry] : it->second) suite_.base.set(section, key, entry.value, entry.origin);
    const auto& options = suite_.options;
    suite_.robots = variants("robots", options.robots, "robot");
    suite_.lidars = variants("lidars", options.lidars, "lidar");
    suite_.odometry = variants("odometry", options.odometry, "odometry");
    suite_.strategies = variants("strategies", options.strategies, "strategy");
    suite_.faults = variants("faults", options.faults, "fault");
    for (const auto& word : words("worlds", options.worlds)) suite_.worlds.push_back(world(word));
    for (const auto& word : words("logs", options.logs)) suite_.logs.push_back(log(word));
    if (suite_.worlds.empty() && suite_.logs.empty())
      throw core::InputError(suite_.path + ": section [suite]: no worlds and no logs, expected at least one");
    for (const auto& word : words("methods", options.methods)) addMethods(word);
    if (suite_.methods.empty())
      throw core::InputError(suite_.path + ": section [suite], key 'methods': names none, expected one");
    readSeeds();
    rejectUnusedSections();
    checkNames();
    checkBaseline();
    checkCombinations();
    return std::move(suite_);
  }

 private:
  std::string where(const std::string& key) const {
    const auto* entry = ini_.find("suite", key);
    return (entry ? entry->origin : suite_.path) + ": section [suite], key '" + key + "'";
  }

  core::InputError unknown(const std::string& key, const std::string& word, const std::string& expected,
                           std::vector<std::string> names, const std::string& kind) const {
    const std::string prefix = kind + " ";
    for (const auto& [section, entries] : ini_.sections())
      if (section.compare(0, prefix.size(), prefix) == 0) names.push_back(section.substr(prefix.size()));
    return core::InputError(where(key) + ": found '" + word + "', expected " + expected + " or a section [" +
                            kind + " " + word + "]" + core::didYouMean(word, names));
  }

  std::string resolved(const std::string& path) const {
    return fs::path(path).is_absolute() ? path : (fs::path(suite_.folder) / path).lexically_normal().string();
  }

  std::vector<std::string> words(const std::string& key, const std::string& list) const {
    auto parts = splitAt(list, ',');
    for (const auto& part : parts)
      if (part.empty())
        throw core::InputError(where(key) + ": found '" + list +
                               "', expected names separated by single commas");
    return parts;
  }

  using Entries = std::map<std::string, core::IniFile::Entry>;

  /// The section that gives a value of an axis, or nullptr.
  const Entries* sectionOf(const std::string& kind, const std::string& name) {
    const auto it = ini_.sections().find(kind + " " + name);
    if (it == ini_.sections().end()) return nullptr;
    used_.insert(it->first);
    return &it->second;
  }

  /// Keys `section.key` on top of `config`, but for those in `own`.
  static void layOver(core::IniFile& config, const Entries& entries, const std::set<std::string>& own) {
    for (const auto& [key, entry] : entries) {
      if (own.count(key)) continue;
      const auto dot = key.find('.');
      if (dot == std::string::npos || dot == 0 || dot + 1 == key.size())
        throw core::InputError(entry.origin + ": found key '" + key + "', expected section.key = value" +
                               core::didYouMean(key, {own.begin(), own.end()}));
      config.set(key.substr(0, dot), key.substr(dot + 1), entry.value, entry.origin);
    }
  }

  std::vector<SuiteVariant> variants(const std::string& key, const std::string& list,
                                     const std::string& kind) {
    std::vector<SuiteVariant> result;
    for (const auto& word : words(key, list)) result.push_back(variant(key, kind, word));
    if (result.empty()) result.push_back({kBuiltIn, {}});
    return result;
  }

  SuiteVariant variant(const std::string& key, const std::string& kind, const std::string& word) {
    if (const Entries* entries = sectionOf(kind, word)) {
      SuiteVariant result{word, {}};
      if (const auto base = entries->find("base"); base != entries->end())
        result.overlay = preset(key, kind, base->second.value).overlay;
      layOver(result.overlay, *entries, {"base"});
      return result;
    }
    return preset(key, kind, word);
  }

  /// A value that comes with the program, or from a file.
  SuiteVariant preset(const std::string& key, const std::string& kind, const std::string& word) const {
    if (word == kBuiltIn) return {word, {}};
    if (core::isConfigFile(word))
      return {fs::path(word).stem().string(), core::IniFile::load(resolved(word))};
    std::vector<std::string> names;
    if (kind == "lidar") names = core::namesInFolder(core::configsFolder() + "/lidars", ".ini");
    if (kind == "strategy") names = navigate::strategyNames();
    if (std::find(names.begin(), names.end(), word) == names.end()) {
      names.emplace_back(kBuiltIn);
      throw unknown(key, word, std::string("built-in, a known ") + kind + ", an .ini or .yaml file", names,
                    kind);
    }
    if (kind == "lidar")
      return {word, core::IniFile::load(core::configsFolder() + "/lidars/" + word + ".ini")};
    SuiteVariant result{word, {}};
    result.overlay.set("strategy", "name", word, where(key));
    return result;
  }

  std::uint64_t seed(const std::string& text, const std::string& place) const {
    std::uint64_t value = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || parsed.ec != std::errc() || parsed.ptr != text.data() + text.size())
      throw core::InputError(place + ": found '" + text + "', expected a whole number from 0 on");
    return value;
  }

  SuiteWorld generated(const std::string& name, const std::string& kind, const Entries& keys) const {
    SuiteWorld result;
    result.name = name;
    result.kind = kind;
    for (const auto& [key, entry] : keys) {
      if (key == "kind") continue;
      if (key == "seed")
        result.seed = seed(entry.value, entry.origin + ": world '" + name + "', seed");
      else
        result.building.set("building", key, entry.value, entry.origin);
    }
    return result;
  }

  SuiteWorld unchecked(const std::string& word) {
    if (const Entries* entries = sectionOf("world", word)) {
      const auto plan = entries->find("plan"), kind = entries->find("kind");
      if (plan != entries->end() && entries->size() == 1)
        return {word, resolved(plan->second.value), "", {}, 1, ""};
      if (kind == entries->end())
        throw core::InputError(where("worlds") + ": section [world " + word +
                               "], expected either plan alone or a kind of building");
      return generated(word, kind->second.value, *entries);
    }
    if (word.find(':') == std::string::npos || fs::exists(resolved(word))) {
      const bool is_path = looksLikePath(word);
      return {
          fs::path(word).stem().string(), is_path ? resolved(word) : core::resolvePlan(word), "", {}, 1, ""};
    }
    const auto parts = splitAt(word, ':');
    Entries keys;
    for (size_t i = 1; i < parts.size(); ++i) {
      const auto equals = parts[i].find('=');
      if (equals == std::string::npos)
        throw core::InputError("found '" + word + "', expected KIND:key=value:key=value");
      const auto* entry = ini_.find("suite", "worlds");
      keys[core::trimmed(parts[i].substr(0, equals))] = {core::trimmed(parts[i].substr(equals + 1)),
                                                         entry ? entry->origin : suite_.path};
    }
    return generated(word, parts[0], keys);
  }

  SuiteWorld world(const std::string& word) {
    SuiteWorld result;
    try {
      result = unchecked(word);
      result.sha256 = planSha256(loadWorld(result));
    } catch (const core::InputError& error) {
      // Errors that already begin with a line of the suite stay as they are.
      const std::string what = error.what();
      if (what.compare(0, suite_.path.size() + 1, suite_.path + ":") == 0) throw;
      throw core::InputError(where("worlds") + ": " + what);
    }
    return result;
  }

  SuiteLog log(const std::string& word) {
    SuiteLog result;
    std::string truth, plan, relations;
    if (const Entries* entries = sectionOf("log", word)) {
      const std::map<std::string, std::string*> targets = {
          {"path", &result.path}, {"truth", &truth}, {"plan", &plan}, {"relations", &relations}};
      std::vector<std::string> known;
      known.reserve(targets.size());
      for (const auto& [key, target] : targets) known.push_back(key);
      core::detail::rejectUnknownKeys(ini_, "log " + word, known);
      for (const auto& [key, entry] : *entries) *targets.at(key) = entry.value;
      if (result.path.empty())
        throw core::InputError(where("logs") + ": section [log " + word + "], key 'path' is missing");
      result.name = word;
    } else if (looksLikePath(word)) {
      result.name = fs::path(word).stem().string();
      result.path = word;
    } else {
      throw unknown("logs", word, "a file", {}, "log");
    }
    result.path = resolved(result.path);
    logs::requireUsable(logs::inspectLog(result.path));
    result.truth_path = truth.empty() ? record::findTruth(result.path) : resolved(truth);
    result.relations_path = relations.empty() ? "" : resolved(relations);
    if (!result.truth_path.empty()) logs::readTrajectory(result.truth_path);
    if (!result.relations_path.empty()) logs::readRelations(result.relations_path);
    if (!plan.empty())
      result.plan_path = looksLikePath(plan) ? resolved(plan) : core::resolvePlan(plan);
    else if (fs::path(result.truth_path).extension() == ".tum")
      result.plan_path = record::findPlan(result.path);
    std::string hashes = core::fileSha256(result.path);
    for (const auto& path : {result.truth_path, result.relations_path})
      hashes += path.empty() ? "-" : core::fileSha256(path);
    hashes += result.plan_path.empty() ? "-" : planSha256(world::loadPlan(result.plan_path));
    result.sha256 = core::sha256(hashes);
    return result;
  }

  void addMethods(const std::string& word) {
    SuiteMethod method;
    const std::string folder = core::configsFolder() + "/methods";
    const auto load = [&](const std::string& name) {
      const bool is_path = looksLikePath(name);
      if (!is_path) {
        const auto names = mapping::methodNames(folder);
        if (std::find(names.begin(), names.end(), name) == names.end())
          throw unknown("methods", name, "a name of 'rasterslam list methods', an .ini file", names,
                        "method");
      }
      return mapping::loadMethodConfig(folder, is_path ? resolved(name) : name);
    };
    if (const Entries* entries = sectionOf("method", word)) {
      const auto base = entries->find("base");
      if (base == entries->end())
        throw core::InputError(where("methods") + ": section [method " + word +
                               "], key 'base' is missing: the method to start from");
      method.config = load(base->second.value);
      method.name = word;
      layOver(method.config, *entries, {"base"});
    } else {
      method.name = core::isConfigFile(word) ? fs::path(word).stem().string() : word;
      method.config = load(word);
    }
    std::vector<SuiteMethod> grid = {method};
    if (const Entries* entries = sectionOf("parameters", method.name))
      for (const auto& [key, entry] : *entries) grid = crossed(grid, key, entry);
    for (auto& choice : grid) {
      run::methodParameters(choice.config);  // a bad key must not show after an hour
      if (run::isExternal(choice.config)) {
        choice.config = run::withFixedFolder(choice.config);
        choice.programs = run::programFiles(choice.config);
      }
      suite_.methods.push_back(std::move(choice));
    }
  }

  static std::vector<SuiteMethod> crossed(const std::vector<SuiteMethod>& grid, const std::string& key,
                                          const core::IniFile::Entry& entry) {
    std::vector<SuiteMethod> result;
    for (const auto& method : grid)
      for (const auto& value : splitAt(entry.value, ',')) {
        SuiteMethod choice = method;
        layOver(choice.config, {{key, {value, entry.origin}}}, {});
        choice.parameters += (choice.parameters.empty() ? "" : " ") + key + "=" + value;
        result.push_back(std::move(choice));
      }
    if (result.empty())
      throw core::InputError(entry.origin + ": key '" + key + "' has no value, expected a list");
    return result;
  }

  void readSeeds() {
    auto& seeds = suite_.seeds;
    for (const auto& word : words("seeds", suite_.options.seeds)) {
      const auto dots = word.find("..");
      const auto first = seed(word.substr(0, dots), where("seeds"));
      const auto last = dots == std::string::npos ? first : seed(word.substr(dots + 2), where("seeds"));
      if (last < first || last - first >= kMostSeeds)
        throw core::InputError(where("seeds") + ": found '" + word +
                               "', expected first..last, last not below first and at most " +
                               std::to_string(kMostSeeds) + " of them");
      for (std::uint64_t i = 0; i <= last - first; ++i) seeds.push_back(first + i);
    }
    const std::set<std::uint64_t> different(seeds.begin(), seeds.end());
    if (seeds.empty() || different.size() != seeds.size())
      throw core::InputError(where("seeds") + ": found '" + suite_.options.seeds + "', expected " +
                             (seeds.empty() ? "at least one seed" : "each seed once"));
  }

  void rejectUnknownKinds() const {
    std::vector<std::string> known = kRecordSections;
    known.insert(known.end(), {"suite", "limits", "tune", "tune.parameters"});
    static const std::set<std::string> kKinds = {"world",    "log",   "robot",  "lidar",     "odometry",
                                                 "strategy", "fault", "method", "parameters"};
    for (const auto& [section, entries] : ini_.sections())
      if (const auto blank = section.find(' ');
          blank != std::string::npos && kKinds.count(section.substr(0, blank)))
        known.push_back(section);
    core::rejectUnknownSections(ini_, known);
  }

  void rejectUnusedSections() const {
    for (const auto& [section, entries] : ini_.sections())
      if (section.find(' ') != std::string::npos && !used_.count(section))
        throw core::InputError((entries.empty() ? suite_.path : entries.begin()->second.origin) +
                               ": section [" + section + "] is named by no list of [suite]");
  }

  void checkNames() const {
    const auto check = [&](const std::string& key, const auto& axis, const auto& nameOf) {
      std::set<std::string> names;
      for (const auto& value : axis)
        if (!names.insert(nameOf(value)).second)
          throw core::InputError(where(key) + ": '" + nameOf(value) + "' is named twice");
    };
    const auto name = [](const auto& value) { return value.name; };
    check("robots", suite_.robots, name);
    check("lidars", suite_.lidars, name);
    check("odometry", suite_.odometry, name);
    check("strategies", suite_.strategies, name);
    check("faults", suite_.faults, name);
    check("methods", suite_.methods, fullName);
    std::set<std::string> grounds;
    for (const auto& world : suite_.worlds) grounds.insert(world.name);
    check("worlds", suite_.worlds, name);
    check("logs", suite_.logs, name);
    for (const auto& log : suite_.logs)
      if (grounds.count(log.name))
        throw core::InputError(where("logs") + ": '" + log.name + "' is the name of a world too");
  }

  void checkBaseline() {
    auto& baseline = suite_.options.baseline;
    std::vector<std::string> names;
    for (const auto& method : suite_.methods) names.push_back(fullName(method));
    if (baseline.empty()) baseline = names.front();
    if (std::find(names.begin(), names.end(), baseline) == names.end())
      throw core::InputError(where("baseline") + ": found '" + baseline + "', expected one of the methods" +
                             core::didYouMean(baseline, names));
  }

  void checkCombinations() const {
    if (suite_.worlds.empty()) return;
    for (const auto& robot : suite_.robots)
      for (const auto& lidar : suite_.lidars)
        for (const auto& odometry : suite_.odometry)
          for (const auto& strategy : suite_.strategies)
            for (const auto& fault : suite_.faults) {
              const auto config =
                  record::readRecordConfig(layered(suite_, robot, lidar, odometry, strategy, fault));
              navigate::makeStrategy(config.strategy, core::RandomStream(1, "strategy"));
              if (navigate::strategyNeedsMap(config.strategy.name))
                throw core::InputError(where("strategies") + ": '" + config.strategy.name +
                                       "' needs a map, and a recording builds none");
            }
  }

  Suite suite_;
  core::IniFile ini_;
  std::set<std::string> used_;
};

}  // namespace

const core::ParameterTable<SuiteOptions>& SuiteOptions::table() {
  using O = SuiteOptions;
  static const core::ParameterTable<O> rows(
      "suite",
      {{"worlds", &O::worlds, "", {}, "buildings to simulate in"},
       {"logs", &O::logs, "", {}, "logs that exist already"},
       {"robots", &O::robots, kBuiltIn, {}, "the robot's body"},
       {"lidars", &O::lidars, kBuiltIn, {}, "the robot's lidar"},
       {"odometry", &O::odometry, kBuiltIn, {}, "how good its wheels are"},
       {"strategies", &O::strategies, kBuiltIn, {}, "where it goes"},
       {"faults", &O::faults, kBuiltIn, {}, "what goes wrong"},
       {"methods", &O::methods, "", {}, "the SLAM methods that map every log"},
       {"seeds", &O::seeds, "1", {}, "seeds of the simulation and of the methods: 1..10, 12"},
       {"baseline", &O::baseline, "", {}, "the method that the others are compared with; empty: the first"},
       {"metric",
        &O::metric,
        "ate_final_m",
        {"ate_final_m", "ate_rmse_m", "ate_max_m", "heading_rmse_deg", "rpe_1m_m", "rpe_1m_deg", "wall_f1",
         "free_iou", "wall_p95_m", "relation_m", "relation_deg"},
        "the figure that ranks the methods"},
       {"failure_ate_m", &O::failure_ate_m, 0, 0, 1e6,
        "a run whose final path is farther off than this (ate_final_m) counts as failed; 0: never"},
       {"keep",
        &O::keep,
        "paths",
        {"paths", "all"},
        "of a run: paths, journal and map picture, or all that 'rasterslam run' writes"}});
  return rows;
}

SuiteOptions::SuiteOptions() {
  table().setDefaults(*this);
}

const core::ParameterTable<CellLimits>& CellLimits::table() {
  using O = CellLimits;
  static const core::ParameterTable<O> rows(
      "limits", {{"time_limit_s", &O::time_limit_s, 3600, 1, 10000000, "computing time (CPU) of one cell"},
                 {"wall_limit_s", &O::wall_limit_s, 14400, 0.001, 1e7, "time by the clock, for what hangs"},
                 {"memory_limit_mb", &O::memory_limit_mb, 4096, 1, 1e7,
                  "memory over what the program takes before it begins"}});
  return rows;
}

CellLimits::CellLimits() {
  table().setDefaults(*this);
}

std::string fullName(const SuiteMethod& method) {
  return method.parameters.empty() ? method.name : method.name + " " + method.parameters;
}

bool isSuiteFile(const std::string& path) {
  if (!core::isYamlFile(path)) return core::isConfigFile(path);
  std::istringstream lines(core::readTextFile(path));
  for (std::string line; std::getline(lines, line);)
    if (line.compare(0, 6, "suite:") == 0) return true;
  return false;  // a ROS map's
}

Suite readSuite(const std::string& path, const std::string& folder) {
  return SuiteReader(path, folder).read();
}

Suite readSuite(const core::IniFile& ini, const std::string& path, const std::string& folder) {
  return SuiteReader(ini, path, folder).read();
}

core::IniFile layered(const Suite& suite, const SuiteVariant& robot, const SuiteVariant& lidar,
                      const SuiteVariant& odometry, const SuiteVariant& strategy, const SuiteVariant& fault) {
  core::IniFile config = suite.base;
  for (const auto* variant : {&robot, &lidar, &odometry, &strategy, &fault})
    config.overrideWith(variant->overlay);
  return config;
}

world::Plan loadWorld(const SuiteWorld& world) {
  if (!world.plan_path.empty()) return world::loadPlan(world.plan_path);
  world::Plan plan = record::generateWorld(world.kind, world.building, world.seed).plan;
  plan.name = world.name;
  return plan;
}

std::string planSha256(const world::Plan& plan) {
  std::ostringstream text;
  text << plan.columns << ' ' << plan.rows << ' ' << core::formatNumber(plan.resolution_m) << ' '
       << core::formatNumber(plan.T_world_plan.x) << ' ' << core::formatNumber(plan.T_world_plan.y) << ' '
       << core::formatNumber(plan.T_world_plan.phi) << '\n';
  for (const auto& door : plan.doors)
    text << door.x0 << ' ' << door.y0 << ' ' << door.x1 << ' ' << door.y1 << '\n';
  text.write(reinterpret_cast<const char*>(plan.cells.data()),
             static_cast<std::streamsize>(plan.cells.size()));
  text.write(reinterpret_cast<const char*>(plan.materials.data()),
             static_cast<std::streamsize>(plan.materials.size()));
  return core::sha256(text.str());
}

}  // namespace slam::sweep

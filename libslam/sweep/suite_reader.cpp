#include "libslam/sweep/suite_reader.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "libslam/files/files.h"
#include "libslam/files/ini_text.h"
#include "libslam/files/word_list.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/run/external_method.h"

namespace slam::sweep {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMostSeeds = 100000;
const std::vector<std::string> kRecordSections = {"robot",       "sensor",     "lidar",    "camera",
                                                  "camera_scan", "odometry",   "strategy", "obstacles",
                                                  "living",      "simulation", "events"};

}  // namespace

SuiteReader::SuiteReader(const std::string& path, const std::string& folder) {
  suite_.path = path;
  suite_.text = files::readTextFile(path);
  suite_.folder = folder.empty() ? fs::absolute(path).parent_path().string() : folder;
  if (resources::isYamlFile(path)) {
    ini_ = resources::parseYaml(suite_.text, path);
    suite_.text = files::toText(ini_);
  } else {
    ini_ = files::IniFile::parse(suite_.text, path);
  }
}

SuiteReader::SuiteReader(files::IniFile ini, const std::string& path, const std::string& folder)
    : ini_(std::move(ini)) {
  suite_.path = path;
  suite_.text = files::toText(ini_);
  suite_.folder = folder;
}

Suite SuiteReader::read() {
  rejectUnknownKinds();
  files::readParameters(ini_, SuiteOptions::table(), suite_.options);
  files::readParameters(ini_, CellLimits::table(), suite_.limits);
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

std::string SuiteReader::where(const std::string& key) const {
  const auto* entry = ini_.find("suite", key);
  return (entry ? entry->origin : suite_.path) + ": section [suite], key '" + key + "'";
}

core::InputError SuiteReader::unknown(const std::string& key, const std::string& word,
                                      const std::string& expected, std::vector<std::string> names,
                                      const std::string& kind) const {
  const std::string prefix = kind + " ";
  for (const auto& [section, entries] : ini_.sections())
    if (section.compare(0, prefix.size(), prefix) == 0) names.push_back(section.substr(prefix.size()));
  return core::InputError(where(key) + ": found '" + word + "', expected " + expected + " or a section [" +
                          kind + " " + word + "]" + core::didYouMean(word, names));
}

std::string SuiteReader::resolved(const std::string& path) const {
  return fs::path(path).is_absolute() ? path : (fs::path(suite_.folder) / path).lexically_normal().string();
}

std::vector<std::string> SuiteReader::words(const std::string& key, const std::string& list) const {
  auto parts = files::splitAt(list, ',');
  for (const auto& part : parts)
    if (part.empty())
      throw core::InputError(where(key) + ": found '" + list +
                             "', expected names separated by single commas");
  return parts;
}

std::vector<SuiteMethod> SuiteReader::crossed(const std::vector<SuiteMethod>& grid, const std::string& key,
                                              const files::IniFile::Entry& entry) {
  std::vector<SuiteMethod> result;
  for (const auto& method : grid)
    for (const auto& value : files::splitAt(entry.value, ',')) {
      SuiteMethod choice = method;
      layOver(choice.config, {{key, {value, entry.origin}}}, {});
      choice.parameters += (choice.parameters.empty() ? "" : " ") + key + "=" + value;
      result.push_back(std::move(choice));
    }
  if (result.empty())
    throw core::InputError(entry.origin + ": key '" + key + "' has no value, expected a list");
  return result;
}

void SuiteReader::readSeeds() {
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

void SuiteReader::rejectUnknownKinds() const {
  std::vector<std::string> known = kRecordSections;
  known.insert(known.end(), {"suite", "limits", "tune", "tune.parameters"});
  static const std::set<std::string> kKinds = {"world",    "log",   "robot",  "lidar",     "odometry",
                                               "strategy", "fault", "method", "parameters"};
  for (const auto& [section, entries] : ini_.sections())
    if (const auto blank = section.find(' ');
        blank != std::string::npos && kKinds.count(section.substr(0, blank)))
      known.push_back(section);
  files::rejectUnknownSections(ini_, known);
}

void SuiteReader::rejectUnusedSections() const {
  for (const auto& [section, entries] : ini_.sections())
    if (section.find(' ') != std::string::npos && !used_.count(section))
      throw core::InputError((entries.empty() ? suite_.path : entries.begin()->second.origin) +
                             ": section [" + section + "] is named by no list of [suite]");
}

void SuiteReader::checkNames() const {
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

void SuiteReader::checkBaseline() {
  auto& baseline = suite_.options.baseline;
  std::vector<std::string> names;
  for (const auto& method : suite_.methods) names.push_back(fullName(method));
  if (baseline.empty()) baseline = names.front();
  if (std::find(names.begin(), names.end(), baseline) == names.end())
    throw core::InputError(where("baseline") + ": found '" + baseline + "', expected one of the methods" +
                           core::didYouMean(baseline, names));
}

void SuiteReader::checkCombinations() const {
  if (suite_.worlds.empty()) return;
  for (const auto& robot : suite_.robots)
    for (const auto& lidar : suite_.lidars)
      for (const auto& odometry : suite_.odometry)
        for (const auto& strategy : suite_.strategies)
          for (const auto& fault : suite_.faults) {
            const auto config =
                record::readRecordConfig(layered(suite_, robot, lidar, odometry, strategy, fault));
            strategies::makeStrategy(config.strategy, core::RandomStream(1, "strategy"));
            if (strategies::strategyNeedsMap(config.strategy.name))
              throw core::InputError(where("strategies") + ": '" + config.strategy.name +
                                     "' needs a map, and a recording builds none");
          }
}

}  // namespace slam::sweep

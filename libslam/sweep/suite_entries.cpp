#include "libslam/files/word_list.h"
#include "libslam/sweep/suite_reader.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <utility>

#include "libslam/logs/log_reader.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/method_config.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/resources.h"
#include "libslam/run/external_method.h"
#include "libslam/truth/truth_files.h"

namespace slam::sweep {
namespace fs = std::filesystem;
namespace {

bool looksLikePath(const std::string& word) {
  return word.find_first_of("/.") != std::string::npos;
}

}  // namespace

/// The section that gives a value of an axis, or nullptr.
const SuiteReader::Entries* SuiteReader::sectionOf(const std::string& kind, const std::string& name) {
  const auto it = ini_.sections().find(kind + " " + name);
  if (it == ini_.sections().end()) return nullptr;
  used_.insert(it->first);
  return &it->second;
}

/// Keys `section.key` on top of `config`, but for those in `own`.
void SuiteReader::layOver(files::IniFile& config, const Entries& entries, const std::set<std::string>& own) {
  for (const auto& [key, entry] : entries) {
    if (own.count(key)) continue;
    const auto dot = key.find('.');
    if (dot == std::string::npos || dot == 0 || dot + 1 == key.size())
      throw core::InputError(entry.origin + ": found key '" + key + "', expected section.key = value" +
                             core::didYouMean(key, {own.begin(), own.end()}));
    config.set(key.substr(0, dot), key.substr(dot + 1), entry.value, entry.origin);
  }
}

std::vector<SuiteVariant> SuiteReader::variants(const std::string& key, const std::string& list,
                                                const std::string& kind) {
  std::vector<SuiteVariant> result;
  for (const auto& word : words(key, list)) result.push_back(variant(key, kind, word));
  if (result.empty()) result.push_back({kBuiltIn, {}});
  return result;
}

SuiteVariant SuiteReader::variant(const std::string& key, const std::string& kind, const std::string& word) {
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
SuiteVariant SuiteReader::preset(const std::string& key, const std::string& kind,
                                 const std::string& word) const {
  if (word == kBuiltIn) return {word, {}};
  if (resources::isConfigFile(word))
    return {fs::path(word).stem().string(), resources::readConfigFile(resolved(word))};
  std::vector<std::string> names;
  if (kind == "lidar") names = resources::namesInFolder(resources::configsFolder() + "/lidars", ".ini");
  if (kind == "strategy") names = strategies::strategyNames();
  if (std::find(names.begin(), names.end(), word) == names.end()) {
    names.emplace_back(kBuiltIn);
    throw unknown(key, word, std::string("built-in, a known ") + kind + ", an .ini or .yaml file", names,
                  kind);
  }
  if (kind == "lidar")
    return {word, resources::readConfigFile(resources::configsFolder() + "/lidars/" + word + ".ini")};
  SuiteVariant result{word, {}};
  result.overlay.set("strategy", "name", word, where(key));
  return result;
}

std::uint64_t SuiteReader::seed(const std::string& text, const std::string& place) const {
  std::uint64_t value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || parsed.ec != std::errc() || parsed.ptr != text.data() + text.size())
    throw core::InputError(place + ": found '" + text + "', expected a whole number from 0 on");
  return value;
}

SuiteWorld SuiteReader::generated(const std::string& name, const std::string& kind,
                                  const Entries& keys) const {
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

SuiteWorld SuiteReader::unchecked(const std::string& word) {
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
    return {fs::path(word).stem().string(),
            is_path ? resolved(word) : resources::resolvePlan(word),
            "",
            {},
            1,
            ""};
  }
  const auto parts = files::splitAt(word, ':');
  Entries keys;
  for (size_t i = 1; i < parts.size(); ++i) {
    const auto equals = parts[i].find('=');
    if (equals == std::string::npos)
      throw core::InputError("found '" + word + "', expected KIND:key=value:key=value");
    const auto* entry = ini_.find("suite", "worlds");
    keys[files::trimmed(parts[i].substr(0, equals))] = {files::trimmed(parts[i].substr(equals + 1)),
                                                        entry ? entry->origin : suite_.path};
  }
  return generated(word, parts[0], keys);
}

SuiteWorld SuiteReader::world(const std::string& word) {
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

SuiteLog SuiteReader::log(const std::string& word) {
  SuiteLog result;
  std::string truth, plan, relations;
  if (const Entries* entries = sectionOf("log", word)) {
    const std::map<std::string, std::string*> targets = {
        {"path", &result.path}, {"truth", &truth}, {"plan", &plan}, {"relations", &relations}};
    std::vector<std::string> known;
    known.reserve(targets.size());
    for (const auto& [key, target] : targets) known.push_back(key);
    files::detail::rejectUnknownKeys(ini_, "log " + word, known);
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
  result.truth_path = truth.empty() ? truth::findTruth(result.path) : resolved(truth);
  result.relations_path = relations.empty() ? "" : resolved(relations);
  if (!result.truth_path.empty()) logs::readTrajectory(result.truth_path);
  if (!result.relations_path.empty()) logs::readRelations(result.relations_path);
  if (!plan.empty())
    result.plan_path = looksLikePath(plan) ? resolved(plan) : resources::resolvePlan(plan);
  else if (fs::path(result.truth_path).extension() == ".tum")
    result.plan_path = truth::findPlan(result.path);
  std::string hashes = resources::fileSha256(result.path);
  for (const auto& path : {result.truth_path, result.relations_path})
    hashes += path.empty() ? "-" : resources::fileSha256(path);
  hashes += result.plan_path.empty() ? "-" : planSha256(world::loadPlan(result.plan_path));
  result.sha256 = resources::sha256(hashes);
  return result;
}

void SuiteReader::addMethods(const std::string& word) {
  SuiteMethod method;
  const std::string folder = resources::configsFolder() + "/methods";
  const auto load = [&](const std::string& name) {
    const bool is_path = looksLikePath(name);
    if (!is_path) {
      const auto names = mapping::methodNames(folder);
      if (std::find(names.begin(), names.end(), name) == names.end())
        throw unknown("methods", name, "a name of 'rasterslam list methods', an .ini file", names, "method");
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
    method.name = resources::isConfigFile(word) ? fs::path(word).stem().string() : word;
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

}  // namespace slam::sweep

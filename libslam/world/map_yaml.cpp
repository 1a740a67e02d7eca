#include "libslam/world/map_yaml.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/core/ini.h"
#include "libslam/core/parameters.h"

namespace slam::world {
namespace {

const std::vector<std::string>& knownKeys() {
  static const std::vector<std::string> keys = {"image",  "resolution",      "origin",      "mode",
                                                "negate", "occupied_thresh", "free_thresh", "materials"};
  return keys;
}

struct Entry {
  std::vector<std::string> values;  ///< one for a scalar
  bool is_list = false;
  std::string where;  ///< "map.yaml:3"
};
using Entries = std::map<std::string, Entry>;

/// Cuts at a # that begins the line or follows white space, outside quotes.
std::string withoutComment(const std::string& line) {
  char quote = 0;
  for (size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    const bool after_blank = i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t';
    if (quote) {
      const bool is_doubled = c == '\'' && quote == c && i + 1 < line.size() && line[i + 1] == c;
      if ((c == '\\' && quote == '"') || is_doubled)
        ++i;
      else if (c == quote)
        quote = 0;
    } else if ((c == '"' || c == '\'') && after_blank) {
      quote = c;
    } else if (c == '#' && after_blank) {
      return line.substr(0, i);
    }
  }
  return line;
}

core::InputError malformed(const std::string& where, const std::string& found, const std::string& expected) {
  return core::InputError(where + ": found '" + found + "', expected " + expected);
}

core::InputError unknownKey(const std::string& where, const std::string& key) {
  return core::InputError(where + ": unknown key '" + key + "'" + core::didYouMean(key, knownKeys()));
}

core::InputError givenTwice(const std::string& where, const std::string& key, const std::string& first) {
  return core::InputError(where + ": key '" + key + "' is given twice, first at " + first);
}

std::string unquoted(const std::string& text, const std::string& where) {
  if (text.empty() || (text.front() != '"' && text.front() != '\'')) return text;
  const char quote = text.front();
  std::string result;
  for (size_t i = 1; i < text.size(); ++i) {
    const bool has_next = i + 1 < text.size();
    const bool escapes = quote == '"' && text[i] == '\\' && has_next;
    const bool is_doubled = quote == '\'' && text[i] == quote && has_next && text[i + 1] == quote;
    if (escapes || is_doubled)
      result += text[++i];
    else if (text[i] != quote)
      result += text[i];
    else if (!has_next)
      return result;
    else
      break;
  }
  throw malformed(where, text, "a text with its closing quote at the end");
}

std::vector<std::string> listItems(const std::string& text, const std::string& where) {
  if (text.back() != ']') throw malformed(where, text, "a list [a, b, c] on one line");
  std::vector<std::string> items;
  std::istringstream fields(text.substr(1, text.size() - 2));
  for (std::string item; std::getline(fields, item, ',');) items.push_back(core::trimmed(item));
  return items;
}

/// The colon that ends the key: followed by white space or the end of the line.
size_t findColon(const std::string& line) {
  auto colon = line.find(':');
  while (colon != std::string::npos && colon + 1 < line.size() && line[colon + 1] != ' ' &&
         line[colon + 1] != '\t')
    colon = line.find(':', colon + 1);
  return colon;
}

Entries parse(const std::string& text, const std::string& path) {
  Entries entries;
  Entry* open_list = nullptr;  // a key without a value takes the items below it
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::string where = path + ":" + std::to_string(number);
    const std::string bare = withoutComment(line);
    const std::string content = core::trimmed(bare);
    if (content.empty() || content == "---" || content == "...") continue;
    if (open_list && content.rfind("- ", 0) == 0) {
      open_list->values.push_back(core::trimmed(content.substr(2)));
      open_list->is_list = true;
      continue;
    }
    open_list = nullptr;
    const auto colon = findColon(content);
    if (colon == std::string::npos || colon == 0 || bare.front() == ' ' || bare.front() == '\t')
      throw malformed(where, content, "key: value");
    const std::string key = unquoted(core::trimmed(content.substr(0, colon)), where);
    const std::string value = core::trimmed(content.substr(colon + 1));
    if (std::find(knownKeys().begin(), knownKeys().end(), key) == knownKeys().end())
      throw unknownKey(where, key);
    if (const auto it = entries.find(key); it != entries.end())
      throw givenTwice(where, key, it->second.where);
    Entry& entry = entries[key];
    entry.where = where;
    entry.is_list = !value.empty() && value.front() == '[';
    if (entry.is_list)
      entry.values = listItems(value, where);
    else if (!value.empty())
      entry.values = {unquoted(value, where)};
    else
      open_list = &entry;
  }
  return entries;
}

core::InputError wrongValue(const std::string& where, const std::string& key, const std::string& found,
                            const std::string& expected) {
  return core::InputError(where + ": key '" + key + "': found '" + found + "', expected " + expected);
}

/// The checked values of one map yaml.
class Values {
 public:
  Values(const Entries& entries, const std::string& path) : entries_(entries), path_(path) {}

  const Entry* find(const std::string& key) const {
    const auto it = entries_.find(key);
    return it == entries_.end() ? nullptr : &it->second;
  }
  const Entry& require(const std::string& key) const {
    if (const Entry* entry = find(key)) return *entry;
    throw core::InputError(path_ + ": key '" + key + "' is missing");
  }
  std::string text(const std::string& key) const {
    const Entry& entry = require(key);
    if (entry.is_list || entry.values.empty() || entry.values[0].empty())
      throw wrongValue(entry.where, key, joined(entry), "one value");
    return entry.values[0];
  }
  double number(const std::string& key, double low, double high, const std::string& expected) const {
    double value = 0;
    const std::string found = text(key);
    if (!core::parseNumber(found, value) || !(value >= low && value <= high))
      throw wrongValue(require(key).where, key, found, expected);
    return value;
  }
  bool flag(const std::string& key) const {
    const std::string found = text(key);
    if (found == "0" || found == "false" || found == "False") return false;
    if (found == "1" || found == "true" || found == "True") return true;
    throw wrongValue(require(key).where, key, found, "0 or 1");
  }
  core::Pose2 pose(const std::string& key) const {
    const Entry& entry = require(key);
    double v[3];
    bool good = entry.is_list && entry.values.size() == 3;
    for (size_t i = 0; good && i < 3; ++i) good = core::parseNumber(entry.values[i], v[i]);
    if (!good) throw wrongValue(entry.where, key, joined(entry), "[x, y, yaw]: three finite numbers");
    return {v[0], v[1], v[2]};
  }

 private:
  static std::string joined(const Entry& entry) {
    std::string text;
    for (const auto& value : entry.values) text += (text.empty() ? "" : ", ") + value;
    return entry.is_list ? "[" + text + "]" : text;
  }

  const Entries& entries_;
  const std::string& path_;
};

bool isPlainScalar(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '.' || c == '/' || c == '-' || c >= 0x80;
  });
}

std::string quotedWhereNeeded(const std::string& text) {
  if (isPlainScalar(text) && text.front() != '-') return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

void requireSensible(const PlanOptions& options, const std::string& where) {
  const auto reject = [&](const char* key, double value, const char* expected) {
    throw wrongValue(where, key, core::formatNumber(value), expected);
  };
  if (!(options.resolution_m > 0) || !std::isfinite(options.resolution_m))
    reject("resolution", options.resolution_m, "metres per pixel, a number above 0");
  const auto isShare = [](double value) { return value >= 0 && value <= 1; };
  if (!isShare(options.occupied_threshold))
    reject("occupied_thresh", options.occupied_threshold, "a number from 0 to 1");
  if (!isShare(options.free_threshold)) reject("free_thresh", options.free_threshold, "a number from 0 to 1");
  if (options.free_threshold >= options.occupied_threshold)
    throw wrongValue(where, "free_thresh", core::formatNumber(options.free_threshold),
                     "a number below occupied_thresh " + core::formatNumber(options.occupied_threshold));
  if (!core::isFinite(options.T_world_plan))
    throw core::InputError(where + ": key 'origin': not finite, expected [x, y, yaw]");
}

MapYaml readMapYaml(const std::string& path) {
  const Entries entries = parse(core::readTextFile(path), path);
  const Values values(entries, path);
  MapYaml map;
  const auto besideYaml = [&](const std::string& name) {
    return (std::filesystem::path(path).parent_path() / name).string();
  };
  map.image_path = besideYaml(values.text("image"));
  if (values.find("materials")) map.materials_path = besideYaml(values.text("materials"));
  map.options.resolution_m = values.number("resolution", 1e-6, 1e6, "metres per pixel, a number above 0");
  map.options.T_world_plan = values.pose("origin");
  if (values.find("negate")) map.options.negate = values.flag("negate");
  const char* kShare = "a number from 0 to 1";
  if (values.find("occupied_thresh"))
    map.options.occupied_threshold = values.number("occupied_thresh", 0, 1, kShare);
  if (values.find("free_thresh")) map.options.free_threshold = values.number("free_thresh", 0, 1, kShare);
  if (values.find("mode")) {
    const std::string mode = values.text("mode");
    if (mode != "trinary" && mode != "scale" && mode != "raw")
      throw wrongValue(values.require("mode").where, "mode", mode, "trinary, scale or raw");
    map.is_raw = mode == "raw";
  }
  const Entry* threshold = values.find("free_thresh");
  requireSensible(map.options, threshold ? threshold->where : path);
  return map;
}

std::string formatMapYaml(const std::string& image_name, const PlanOptions& options,
                          const std::string& materials_name) {
  const auto& origin = options.T_world_plan;
  std::string text = "image: " + quotedWhereNeeded(image_name) + "\n";
  text += "mode: trinary\n";
  text += "resolution: " + core::formatNumber(options.resolution_m) + "\n";
  text += "origin: [" + core::formatNumber(origin.x) + ", " + core::formatNumber(origin.y) + ", " +
          core::formatNumber(origin.phi) + "]\n";
  text += std::string("negate: ") + (options.negate ? "1" : "0") + "\n";
  text += "occupied_thresh: " + core::formatNumber(options.occupied_threshold) + "\n";
  text += "free_thresh: " + core::formatNumber(options.free_threshold) + "\n";
  if (!materials_name.empty()) text += "materials: " + quotedWhereNeeded(materials_name) + "\n";
  return text;
}

}  // namespace slam::world

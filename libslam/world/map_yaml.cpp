#include "libslam/world/map_yaml.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"
#include "libslam/files/ros_map.h"
#include "libslam/resources/yaml_document.h"

namespace slam::world {
namespace {

const std::vector<std::string>& knownKeys() {
  static const std::vector<std::string> keys = {"image",       "resolution", "origin",
                                                "mode",        "negate",     "occupied_thresh",
                                                "free_thresh", "materials",  "doors"};
  return keys;
}

/// As one would write it on one line, for messages. Lists in lists in lists, which aliases can make endless,
/// are left out.
std::string textOf(const YAML::Node& node, int depth = 0) {
  constexpr int kDeepest = 2;
  if (node.IsScalar()) return core::oneLine(node.Scalar());
  if (node.IsMap()) return "{...}";
  if (!node.IsSequence()) return "";
  if (depth == kDeepest) return "[...]";
  std::string items;
  for (const auto& item : node) items += (items.empty() ? "" : ", ") + textOf(item, depth + 1);
  return "[" + items + "]";
}

/// The finite numbers of a list of so many; nothing when it is none.
std::vector<double> numbersOf(const YAML::Node& node, size_t count) {
  std::vector<double> numbers;
  if (!node.IsSequence() || node.size() != count) return numbers;
  for (const auto& item : node) {
    double value = 0;
    if (!item.IsScalar() || !files::parseNumber(item.Scalar(), value)) return {};
    numbers.push_back(value);
  }
  return numbers;
}

struct Entry {
  YAML::Node value;
  std::string where;  ///< "map.yaml:3"
};
using Entries = std::map<std::string, Entry>;

Entries parse(const std::string& text, const std::string& path) {
  Entries entries;
  const YAML::Node root = resources::yamlDocument(text, path);
  if (!root.IsNull() && !root.IsMap())
    throw core::InputError(resources::yamlPlace(path, root.Mark()) + ": found '" + textOf(root) +
                           "', expected key: value");
  for (const auto& item : root) {
    const std::string where = resources::yamlPlace(path, item.first.Mark());
    const std::string key = textOf(item.first);
    if (std::find(knownKeys().begin(), knownKeys().end(), key) == knownKeys().end())
      throw core::InputError(where + ": unknown key '" + key + "'" + core::didYouMean(key, knownKeys()));
    const auto [first, is_new] = entries.emplace(key, Entry{item.second, where});
    if (!is_new)
      throw core::InputError(where + ": key '" + key + "' is given twice, first at " + first->second.where);
  }
  return entries;
}

core::InputError wrongValue(const std::string& where, const std::string& key, const std::string& found,
                            const std::string& expected) {
  return core::InputError(where + ": key '" + key + "': found '" + core::oneLine(found) + "', expected " +
                          expected);
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
    if (!entry.value.IsScalar() || entry.value.Scalar().empty())
      throw wrongValue(entry.where, key, textOf(entry.value), "one value");
    return entry.value.Scalar();
  }
  double number(const std::string& key, double low, double high, const std::string& expected) const {
    double value = 0;
    const std::string found = text(key);
    if (!files::parseNumber(found, value) || !(value >= low && value <= high))
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
    const auto v = numbersOf(entry.value, 3);
    if (v.empty())
      throw wrongValue(entry.where, key, textOf(entry.value), "[x, y, yaw]: three finite numbers");
    return {v[0], v[1], v[2]};
  }
  std::vector<Door> doors(const std::string& key) const {
    const Entry& entry = require(key);
    if (!entry.value.IsSequence() && !entry.value.IsNull())
      throw wrongValue(entry.where, key, textOf(entry.value), "a list of [x0, y0, x1, y1]");
    std::vector<Door> doors;
    for (const auto& item : entry.value) {
      const auto v = numbersOf(item, 4);
      const bool good =
          !v.empty() && v[0] < v[2] && v[1] < v[3] && std::all_of(v.begin(), v.end(), [](double corner) {
            return corner == std::floor(corner) && std::abs(corner) <= 1e6;
          });
      if (!good)
        throw wrongValue(entry.where, key, textOf(item),
                         "[x0, y0, x1, y1]: whole numbers, x0 < x1 and y0 < y1");
      doors.push_back(
          {static_cast<int>(v[0]), static_cast<int>(v[1]), static_cast<int>(v[2]), static_cast<int>(v[3])});
    }
    return doors;
  }

 private:
  const Entries& entries_;
  const std::string& path_;
};

}  // namespace

void requireSensible(const PlanOptions& options, const std::string& where) {
  const auto reject = [&](const char* key, double value, const char* expected) {
    throw wrongValue(where, key, files::formatNumber(value), expected);
  };
  if (!(options.resolution_m > 0) || !std::isfinite(options.resolution_m))
    reject("resolution", options.resolution_m, "metres per pixel, a number above 0");
  const auto isShare = [](double value) { return value >= 0 && value <= 1; };
  if (!isShare(options.occupied_threshold))
    reject("occupied_thresh", options.occupied_threshold, "a number from 0 to 1");
  if (!isShare(options.free_threshold)) reject("free_thresh", options.free_threshold, "a number from 0 to 1");
  if (options.free_threshold >= options.occupied_threshold)
    throw wrongValue(where, "free_thresh", files::formatNumber(options.free_threshold),
                     "a number below occupied_thresh " + files::formatNumber(options.occupied_threshold));
  if (!core::isFinite(options.T_frame_raster))
    throw core::InputError(where + ": key 'origin': not finite, expected [x, y, yaw]");
}

MapYaml readMapYaml(const std::string& path) {
  const Entries entries = parse(files::readTextFile(path), path);
  const Values values(entries, path);
  MapYaml map;
  const auto besideYaml = [&](const std::string& name) {
    return (std::filesystem::path(path).parent_path() / name).string();
  };
  map.image_path = besideYaml(values.text("image"));
  if (values.find("materials")) map.materials_path = besideYaml(values.text("materials"));
  map.options.resolution_m = values.number("resolution", 1e-6, 1e6, "metres per pixel, a number above 0");
  map.options.T_frame_raster = values.pose("origin");
  if (values.find("negate")) map.options.negate = values.flag("negate");
  constexpr const char* kShare = "a number from 0 to 1";
  if (values.find("occupied_thresh"))
    map.options.occupied_threshold = values.number("occupied_thresh", 0, 1, kShare);
  if (values.find("free_thresh")) map.options.free_threshold = values.number("free_thresh", 0, 1, kShare);
  if (values.find("mode")) {
    const std::string mode = values.text("mode");
    if (mode != "trinary" && mode != "scale" && mode != "raw")
      throw wrongValue(values.require("mode").where, "mode", mode, "trinary, scale or raw");
    map.is_raw = mode == "raw";
  }
  if (const Entry* doors = values.find("doors")) {
    map.doors = values.doors("doors");
    map.doors_where = doors->where;
  }
  const Entry* threshold = values.find("free_thresh");
  requireSensible(map.options, threshold ? threshold->where : path);
  return map;
}

std::string formatMapYaml(const std::string& image_name, const PlanOptions& options,
                          const std::string& materials_name, const std::vector<Door>& doors) {
  std::string text = files::rosMapYaml({image_name, options.resolution_m, options.T_frame_raster,
                                        options.negate, options.occupied_threshold, options.free_threshold});
  if (!materials_name.empty()) text += "materials: " + files::yamlScalar(materials_name) + "\n";
  if (!doors.empty()) text += "doors:\n";
  for (const auto& door : doors)
    text += "  - [" + std::to_string(door.x0) + ", " + std::to_string(door.y0) + ", " +
            std::to_string(door.x1) + ", " + std::to_string(door.y1) + "]\n";
  return text;
}

}  // namespace slam::world

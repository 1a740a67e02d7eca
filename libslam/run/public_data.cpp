#include "libslam/run/public_data.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/run/resources.h"

namespace slam::run {
namespace {

using Json = nlohmann::json;

constexpr std::array<const char*, 4> kKinds = {"log", "plan", "collection", "pose graph"};

/// The keys of one entry, each asked for once; what is left over is unknown.
class Entry {
 public:
  Entry(Json json, std::string where) : json_(std::move(json)), where_(std::move(where)) {
    if (!json_.is_object()) throw core::InputError(where_ + ": expected an object");
  }

  std::string text(const std::string& key) {
    const Json value = take(key);
    if (!value.is_string()) fail(key, "a text");
    return value.get<std::string>();
  }
  double numberOrNull(const std::string& key) {
    const Json value = take(key);
    if (value.is_null()) return std::numeric_limits<double>::quiet_NaN();
    if (!value.is_number() || !(value.get<double>() > 0)) fail(key, "a number above 0 or null");
    return value.get<double>();
  }
  std::vector<std::string> texts(const std::string& key, bool may_be_missing = false) {
    if (may_be_missing && !json_.contains(key)) return {};
    const Json value = take(key);
    if (!value.is_array() ||
        !std::all_of(value.begin(), value.end(), [](const Json& line) { return line.is_string(); }))
      fail(key, "a list of texts");
    return value.get<std::vector<std::string>>();
  }
  void expectNothingElse() const {
    if (!json_.empty()) throw core::InputError(where_ + ": unknown key '" + json_.begin().key() + "'");
  }

 private:
  Json take(const std::string& key) {
    if (!json_.contains(key)) throw core::InputError(where_ + ": key '" + key + "' is missing");
    Json value = json_[key];
    json_.erase(key);
    return value;
  }
  [[noreturn]] void fail(const std::string& key, const std::string& expected) const {
    throw core::InputError(where_ + ": key '" + key + "': expected " + expected);
  }

  Json json_;
  std::string where_;
};

PublicData readEntry(const Json& json, const std::string& where) {
  Entry entry(json, where);
  PublicData data;
  data.name = entry.text("name");
  data.kind = entry.text("kind");
  data.what = entry.text("what");
  data.by = entry.text("by");
  data.page = entry.text("page");
  data.licence = entry.text("licence");
  data.licence_source = entry.text("licence_source");
  data.format = entry.text("format");
  data.size_mb = entry.numberOrNull("size_mb");
  data.truth = entry.text("truth");
  data.odd = entry.texts("odd");
  data.fetch = entry.texts("fetch");
  data.convert = entry.texts("convert");
  data.installed = entry.texts("installed", true);
  entry.expectNothingElse();
  if (std::find(kKinds.begin(), kKinds.end(), data.kind) == kKinds.end())
    throw core::InputError(where + ": key 'kind': found '" + data.kind +
                           "', expected log, plan, collection or pose graph");
  std::copy_if(data.installed.begin(), data.installed.end(), std::back_inserter(data.here),
               [](const std::string& path) { return std::filesystem::exists(path); });
  return data;
}

}  // namespace

PublicDataTable readPublicData(const std::string& path) {
  const auto json = Json::parse(core::readTextFile(path), nullptr, false);
  if (!json.is_object() || !json.contains("note") || !json["note"].is_string() || !json.contains("data") ||
      !json["data"].is_array())
    throw core::InputError(path + ": expected an object with a text 'note' and a list 'data'");
  PublicDataTable table;
  table.note = json["note"].get<std::string>();
  for (size_t i = 0; i < json["data"].size(); ++i) {
    auto data = readEntry(json["data"][i], path + ": entry " + std::to_string(i + 1));
    for (const auto& other : table.data)
      if (other.name == data.name) throw core::InputError(path + ": name '" + data.name + "' is used twice");
    table.data.push_back(std::move(data));
  }
  return table;
}

std::string publicDataFile() {
  return std::filesystem::path(worldsFolder()).parent_path().string() + "/public_data.json";
}

}  // namespace slam::run

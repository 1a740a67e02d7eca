#include "libslam/logs/public_data.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/resources/json_entry.h"

namespace slam::logs {
namespace {

using Json = nlohmann::json;

constexpr std::array<const char*, 4> kKinds = {"log", "plan", "collection", "pose graph"};

PublicData readEntry(const Json& json, const std::string& where) {
  resources::JsonEntry entry(json, where);
  PublicData data;
  data.name = entry.text("name");
  data.kind = entry.text("kind");
  data.what = entry.text("what");
  data.by = entry.text("by");
  data.page = entry.text("page");
  data.licence = entry.text("licence");
  data.licence_source = entry.text("licence_source");
  data.format = entry.text("format");
  data.size_mb = entry.positiveNumberOrNull("size_mb");
  data.truth = entry.text("truth");
  data.odd = entry.texts("odd");
  data.fetch = entry.texts("fetch");
  data.convert = entry.texts("convert");
  if (entry.has("installed")) data.installed = entry.texts("installed");
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
  const auto json = Json::parse(files::readTextFile(path), nullptr, false);
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

}  // namespace slam::logs

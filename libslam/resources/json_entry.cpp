#include "libslam/resources/json_entry.h"

#include <algorithm>
#include <limits>

#include "libslam/core/error.h"
#include "libslam/files/files.h"

namespace slam::resources {

nlohmann::json readJsonFile(const std::string& path) {
  constexpr int kDeepest = 64;
  const auto limitDepth = [&](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
    if (depth > kDeepest) throw core::InputError(path + ": values are nested more than 64 deep");
    return true;
  };
  return nlohmann::json::parse(files::readTextFile(path), limitDepth, false);
}

JsonEntry::JsonEntry(nlohmann::json json, std::string where)
    : json_(std::move(json)), where_(std::move(where)) {
  if (!json_.is_object()) throw core::InputError(where_ + ": expected an object");
}

std::string JsonEntry::text(const std::string& key) {
  const auto value = take(key);
  if (!value.is_string()) fail(key, value, "a text");
  return value.get<std::string>();
}

double JsonEntry::number(const std::string& key) {
  const auto value = take(key);
  if (!value.is_number()) fail(key, value, "a number");
  return value.get<double>();
}

double JsonEntry::positiveNumberOrNull(const std::string& key) {
  const auto value = take(key);
  if (value.is_null()) return std::numeric_limits<double>::quiet_NaN();
  if (!value.is_number() || !(value.get<double>() > 0)) fail(key, value, "a number above 0 or null");
  return value.get<double>();
}

std::vector<std::string> JsonEntry::texts(const std::string& key) {
  const auto value = take(key);
  if (!value.is_array() ||
      !std::all_of(value.begin(), value.end(), [](const auto& line) { return line.is_string(); }))
    fail(key, value, "a list of texts");
  return value.get<std::vector<std::string>>();
}

nlohmann::json JsonEntry::take(const std::string& key) {
  if (!has(key)) throw core::InputError(where_ + ": key '" + key + "' is missing");
  auto value = json_[key];
  json_.erase(key);
  return value;
}

void JsonEntry::fail(const std::string& key, const nlohmann::json& found, const std::string& expected) const {
  constexpr size_t kShown = 60;
  std::string text = found.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  if (text.size() > kShown) text = text.substr(0, kShown) + "...";
  throw core::InputError(where_ + ": key '" + key + "': found " + text + ", expected " + expected);
}

void JsonEntry::expectNothingElse() const {
  if (!json_.empty()) throw core::InputError(where_ + ": unknown key '" + json_.begin().key() + "'");
}

}  // namespace slam::resources

#include "libslam/resources/manifest.h"

#include <nlohmann/json.hpp>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/resources/json_entry.h"

namespace slam::resources {

std::string versionText() {
  return RASTERSLAM_VERSION;
}

std::string shellQuoted(const std::vector<std::string>& command_line) {
  const std::string kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=,:+@%";
  std::string line;
  for (const auto& word : command_line) {
    if (!line.empty()) line += ' ';
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) {
      line += word;
      continue;
    }
    line += '\'';
    for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

void writeManifest(const Manifest& manifest, const std::string& path) {
  const nlohmann::ordered_json json = {
      {"program", "rasterslam"},
      {"version", versionText()},
      {"build", RASTERSLAM_BUILD},
      {"reproduce", shellQuoted(manifest.command_line)},
      {"command_line", manifest.command_line},
      {"seed", manifest.seed},
      {"config", manifest.config},
      {"inputs_sha256", manifest.inputs},
      {"files", manifest.files},
      {"times_s", manifest.times_s},
      {"results", manifest.results},
  };
  files::writeFileAtomically(path, json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

Manifest readManifest(const std::string& path) {
  Manifest manifest;
  try {
    const auto json = readJsonFile(path);
    json.at("version").get_to(manifest.version);
    json.at("command_line").get_to(manifest.command_line);
    json.at("seed").get_to(manifest.seed);
    json.at("config").get_to(manifest.config);
    json.at("inputs_sha256").get_to(manifest.inputs);
    json.at("files").get_to(manifest.files);
    json.at("times_s").get_to(manifest.times_s);
    json.at("results").get_to(manifest.results);
  } catch (const nlohmann::json::exception& error) {
    throw core::InputError(path + ": not a manifest of rasterslam: " + error.what());
  }
  return manifest;
}

}  // namespace slam::resources

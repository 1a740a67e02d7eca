#include "libslam/score/compared_methods.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/method_config.h"
#include "libslam/process/worker.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/manifest.h"
#include "libslam/results/stopped_run.h"
#include "libslam/run/build_map.h"
#include "libslam/run/external_method.h"
#include "libslam/threads/thread_team.h"

namespace slam::score {
namespace fs = std::filesystem;
namespace {

/// The request's settings that the method has a section for.
std::vector<std::string> settingsOf(const files::IniFile& config, const CompareRequest& request) {
  const auto* type = config.find("method", "type");
  const auto sections = mapping::methodSections(type == nullptr ? "" : type->value);
  std::vector<std::string> own;
  for (const auto& setting : request.method_settings)
    if (std::count(sections.begin(), sections.end(), setting.substr(0, setting.find('.'))) > 0)
      own.push_back(setting);
  return own;
}

void requireUsed(const CompareRequest& request, const std::vector<ComparedMethod>& methods) {
  for (const auto& setting : request.method_settings)
    if (std::none_of(methods.begin(), methods.end(), [&](const ComparedMethod& method) {
          return std::count(method.settings.begin(), method.settings.end(), setting) > 0;
        }))
      throw core::InputError("--set: found '" + setting +
                             "', expected a section of a method that is compared");
}

/// The note of a method that failed on the way: what it had mapped is there to look at, and no row of
/// figures, for they would stand beside those of the whole log.
std::string keptText(const std::string& where_and_why) {
  return where_and_why + "; what it had mapped is kept";
}

/// Runs one method in a process of its own. Throws MethodError for whatever goes wrong with the method alone.
void runInProcess(const ComparedMethod& method, const std::string& log_path, const CompareRequest& request,
                  core::Progress& progress) {
  std::vector<std::string> command = {
      request.program, "run",         method.argument, log_path, "-o",
      method.folder,   "--overwrite", "--json",        "--seed", std::to_string(request.seed)};
  if (request.quiet) command.emplace_back("--quiet");
  if (!request.relations_path.empty()) command.insert(command.end(), {"--relations", request.relations_path});
  for (const auto& setting : method.settings) command.insert(command.end(), {"--set", setting});
  const auto result = process::runWorker(command, progress);
  if (result.exit_code == 0) return;
  if (result.exit_code == static_cast<int>(core::ExitCode::kInterrupted)) throw core::Interrupted();
  std::string why = result.killed ? "killed by signal " + std::to_string(result.exit_code - 128)
                                  : "exit code " + std::to_string(result.exit_code);
  const auto json = nlohmann::json::parse(result.out, nullptr, false);
  if (json.is_object() && json.contains("failed")) throw core::MethodError(keptText(json["failed"]));
  // Lost at the end: all is written, and the row says so.
  if (json.is_object() && json.contains("lost")) return;
  if (json.is_object() && json.contains("error")) why = json["error"].get<std::string>();
  if (result.exit_code == static_cast<int>(core::ExitCode::kBadInput)) throw core::InputError(why);
  // A full disk is not the method's fault.
  if (json.is_object() && json.contains("machine")) throw core::IoError(why);
  throw core::MethodError(why);
}

void runMethod(ComparedMethod& method, const std::string& log_path, const CompareRequest& request,
               const resources::Manifest& manifest, core::Progress& progress) {
  try {
    if (!request.program.empty()) return runInProcess(method, log_path, request, progress);
    run::BuildOptions options;
    options.measure_memory = false;  // other methods run in this process
    if (!request.relations_path.empty()) options.relations = logs::readRelations(request.relations_path);
    const auto run = run::buildMap(log_path, method.config, method.name, request.seed, method.folder, true,
                                   manifest, progress, options);
    if (run.stopped) throw core::MethodError(keptText(results::stopText(*run.stopped)));
  } catch (const core::MethodError& error) {
    method.failure = error.what();
  }
}

}  // namespace

std::vector<ComparedMethod> loadMethods(const CompareRequest& request) {
  std::vector<ComparedMethod> methods;
  for (const auto& name_or_path : request.methods) {
    ComparedMethod method;
    method.name =
        resources::isConfigFile(name_or_path) ? fs::path(name_or_path).stem().string() : name_or_path;
    method.argument = name_or_path;
    method.config = mapping::loadMethodConfig(request.methods_folder, name_or_path);
    method.settings = settingsOf(method.config, request);
    for (const auto& setting : method.settings) method.config.setFromArgument(setting, "--set");
    method.folder = request.output + "/" + method.name;
    for (const auto& other : methods)
      if (other.name == method.name) throw core::InputError("method '" + method.name + "' is named twice");
    run::methodParameters(method.config);  // a bad key must not show after an hour
    methods.push_back(std::move(method));
  }
  if (methods.empty()) throw core::InputError("no method named, expected at least one");
  requireUsed(request, methods);
  return methods;
}

bool isSameRun(const ComparedMethod& method, const std::string& log_path, std::uint64_t seed) {
  if (!fs::exists(method.folder + "/manifest.json")) return false;
  try {
    const auto manifest = resources::readManifest(method.folder + "/manifest.json");
    if (manifest.results.count("status") > 0) return false;  // it ended before its log did
    for (const auto& line : run::methodParameters(method.config)) {
      const auto it = manifest.config.find(line.section + "." + line.info.key);
      if (it == manifest.config.end() || it->second != line.value) return false;
    }
    if (run::isExternal(method.config))
      for (const auto& [path, hash] : run::programFiles(method.config))
        if (const auto it = manifest.inputs.find(path); it == manifest.inputs.end() || it->second != hash)
          return false;
    const auto input = manifest.inputs.find(log_path);
    return manifest.seed == seed && manifest.version == resources::versionText() &&
           input != manifest.inputs.end() && input->second == resources::fileSha256(log_path);
  } catch (const core::InputError&) {
    return false;
  }
}

void runMethods(std::vector<ComparedMethod>& methods, const std::string& log_path,
                const CompareRequest& request, const resources::Manifest& manifest,
                core::Progress& progress) {
  std::atomic<bool> ended{false};
  threads::ThreadTeam(request.threads).forEach(methods.size(), [&](size_t i) {
    if (ended || methods[i].reused) return;
    try {
      runMethod(methods[i], log_path, request, manifest, progress);
    } catch (...) {
      ended = true;
      throw;
    }
  });
}

}  // namespace slam::score

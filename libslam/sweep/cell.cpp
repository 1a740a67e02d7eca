#include "libslam/sweep/cell.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <new>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/files/files.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/process/process_memory.h"
#include "libslam/record/record.h"
#include "libslam/resources/code_version.h"
#include "libslam/resources/file_hash.h"
#include "libslam/run/build_map.h"
#include "libslam/run/log_feed.h"
#include "libslam/score/evaluate.h"
#include "libslam/score/failure.h"
#include "libslam/score/metric_infos.h"
#include "libslam/score/relation_tables.h"
#include "libslam/sweep/sweep_plan.h"

namespace slam::sweep {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
using core::kNaN;

bool memory_ran_out = false;

/// Takes note, because a library may turn what follows into an error of its own.
void onNoMemory() {
  memory_ran_out = true;
  throw std::bad_alloc();
}

void setLimit(int resource, rlim_t value) {
  rlimit limit{};
  getrlimit(static_cast<__rlimit_resource>(resource), &limit);
  limit.rlim_cur = std::min(value, limit.rlim_max);
  setrlimit(static_cast<__rlimit_resource>(resource), &limit);
}

/// While it lives, this process may not take more memory than it has by so much.
class MemoryLimit {
 public:
  explicit MemoryLimit(double megabytes) : previous_(std::set_new_handler(onNoMemory)) {
    memory_ran_out = false;
    const double used_mb = process::processMemoryMb("VmData");
    if (std::isfinite(used_mb)) setLimit(RLIMIT_DATA, static_cast<rlim_t>((used_mb + megabytes) * 1048576));
  }
  ~MemoryLimit() {
    setLimit(RLIMIT_DATA, RLIM_INFINITY);
    std::set_new_handler(previous_);
  }
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  std::new_handler previous_;
};

files::IniFile toIni(const Json& config, const std::string& origin) {
  files::IniFile ini;
  for (const auto& [key, value] : config.items()) {
    const auto dot = key.find('.');
    ini.set(key.substr(0, dot), key.substr(dot + 1), value.get<std::string>(), origin);
  }
  return ini;
}

resources::Manifest manifestOf(const CellInputs& inputs) {
  resources::Manifest manifest;
  manifest.command_line = {"sh", "-c", inputs.reproduce};
  return manifest;
}

std::string onlyWithout(std::string text, const std::string& path, const std::string& instead) {
  if (path.empty()) return text;
  for (auto at = text.find(path); at != std::string::npos; at = text.find(path, at + instead.size()))
    text.replace(at, path.size(), instead);
  return text;
}

void addFile(CellResult& result, const std::string& folder, const std::string& name) {
  const std::string path = folder + "/" + name;
  result.files[name] = {fs::file_size(path), resources::fileSha256(path)};
}

bool isGenerated(const Json& spec) {
  return spec.at("world").contains("kind");
}

world::Plan plannedWorld(const Json& spec, const CellInputs& inputs) {
  const Json& ground = spec.at("world");
  SuiteWorld world;
  world.name = ground.at("name");
  world.plan_path = inputs.plan;
  if (isGenerated(spec)) {
    world.kind = ground.at("kind");
    world.building = toIni(ground.at("building"), "cell.json");
    world.seed = ground.at("seed");
  }
  auto plan = loadWorld(world);
  if (planSha256(plan) != ground.at("plan_sha256"))
    throw core::InputError((inputs.plan.empty() ? world.name : inputs.plan) +
                           ": is no longer the plan that the sweep was planned with");
  return plan;
}

void recordLog(const std::string& folder, const Json& spec, const world::Plan& plan, const CellInputs& inputs,
               CellResult& result, core::Progress& progress) {
  const bool is_generated = isGenerated(spec);
  auto manifest = manifestOf(inputs);
  std::string plan_path = inputs.plan;
  if (is_generated) {
    plan_path = folder + "/plan.yaml";
    world::savePlan(plan, plan_path);
    for (const char* name : {"plan.yaml", "plan.png", "plan.materials.png"})
      if (fs::exists(folder + "/" + name)) addFile(result, folder, name);
  }
  manifest.inputs[is_generated ? "plan.yaml" : plan_path] = resources::fileSha256(plan_path);
  const auto config = record::readRecordConfig(toIni(spec.at("config"), "cell.json"));
  const auto recording =
      record::record(plan, config, spec.at("seed"), folder + "/run.rawlog", std::move(manifest), progress);
  for (const auto& path : recording.files) {
    const std::string name = fs::path(path).filename().string();
    if (name != "run.manifest.json") addFile(result, folder, name);
  }
  if (fs::exists(folder + "/run.plan.png")) addFile(result, folder, "run.plan.png");
  result.figures = {{"scans", static_cast<double>(recording.scans)},
                    {"duration_s", recording.duration_s},
                    {"true_path_length_m", recording.path_length_m},
                    {"collisions", static_cast<double>(recording.collisions.size())}};
}

/// Leaves of a run's folder what a sweep keeps.
void prune(const std::string& folder) {
  static const std::set<std::string> kKept = {
      "trajectory.tum",  "trajectory_final.tum", "map.yaml", "map.png", "journal.csv",
      "covariances.csv", "covariances_final.csv"};
  auto manifest = resources::readManifest(folder + "/manifest.json");
  for (auto it = manifest.files.begin(); it != manifest.files.end();) {
    if (kKept.count(it->first)) {
      ++it;
      continue;
    }
    fs::remove(folder + "/" + it->first);
    it = manifest.files.erase(it);
  }
  resources::writeManifest(manifest, folder + "/manifest.json");
}

void addFigures(const score::Evaluation& evaluation, CellResult& result) {
  const auto& costs = score::costKeys();
  for (const auto& info : score::metricInfos()) {
    // Agreement is between runs: no figure of one cell.
    if (info.key == "agreement_m" || std::count(costs.begin(), costs.end(), info.key)) continue;
    result.figures.emplace_back(info.key, info.of(evaluation));
  }
}

/// Of the run in the cell what the suite keeps, as files of the result.
void keepRun(const std::string& folder, const CellInputs& inputs, CellResult& result) {
  const std::string run_folder = folder + "/run";
  if (inputs.keep == "paths") prune(run_folder);
  for (const auto& [name, meaning] : resources::readManifest(run_folder + "/manifest.json").files)
    if (name != "timing.csv" && name != "printed.txt") addFile(result, folder, "run/" + name);
}

/// The same wherever the cell lies.
std::string messageWithout(const std::string& folder, const CellInputs& inputs, const std::string& message) {
  return onlyWithout(onlyWithout(message, folder, "."), inputs.log, fs::path(inputs.log).filename().string());
}

void setFailure(CellResult& result, const std::string& status, const std::string& message, double limit = 0) {
  result.status = status;
  result.message = message;
  result.limit = limit;
}

void runMethod(const std::string& folder, const Json& spec, const CellInputs& inputs, CellResult& result,
               CellCost& cost, core::Progress& progress) {
  const std::string run_folder = folder + "/run";
  const auto built = run::buildMap(inputs.log, toIni(spec.at("config"), "cell.json"), spec.at("method"),
                                   spec.at("seed"), run_folder, false, manifestOf(inputs), progress);
  if (built.stopped) {
    // Figures of a part of the log would stand beside those of whole ones: there are none.
    setFailure(result, "failed", messageWithout(folder, inputs, results::stopText(*built.stopped)));
    keepRun(folder, inputs, result);
    return;
  }
  const auto run = results::loadRun(run_folder);
  std::optional<score::Truth> truth;
  if (!inputs.truth.empty()) truth = score::loadTruth(inputs.truth, inputs.truth_plan, run);
  addFigures(score::evaluate(run, truth), result);
  if (const auto skewed = run::skewedScans(run.manifest.results); skewed > 0)
    result.figures.emplace_back("skewed_scans", static_cast<double>(skewed));
  if (truth && score::firstDivergence(truth->trajectory, run.estimate)) {
    const auto failure =
        score::explainFailure(run, *truth, score::readEvidence(run, inputs.truth, inputs.log));
    files::writeFileAtomically(folder + "/failure.json", score::failureJson(failure));
    addFile(result, folder, "failure.json");
  }
  if (!inputs.relations.empty()) {
    const auto scores = score::scoreByRelations(run, logs::readRelations(inputs.relations));
    result.figures.emplace_back("relation_m", scores.front().error.translation_m.mean);
    result.figures.emplace_back("relation_deg", core::radToDeg(scores.front().error.rotation_rad.mean));
  }
  cost.mean_ms_per_scan = run.cost.mean_ms_per_scan;
  cost.p99_ms_per_scan = run.cost.p99_ms_per_scan;
  cost.peak_memory_mb = run.cost.peak_memory_mb;
  keepRun(folder, inputs, result);
}

void clear(const std::string& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const auto name = entry.path().filename();
    if (name != "cell.json" && name != "stderr.txt") fs::remove_all(entry.path());
  }
}

Json numberOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

double numberOf(const Json& json) {
  return json.is_null() ? kNaN : json.get<double>();
}

void writeJson(const Json& json, const std::string& path) {
  files::writeFileAtomically(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

CellState damaged(const std::string& reason) {
  return {CellState::kDamaged, reason, {}};
}

}  // namespace

CellCost::CellCost()
    : cpu_s(kNaN), wall_s(kNaN), mean_ms_per_scan(kNaN), p99_ms_per_scan(kNaN), peak_memory_mb(kNaN) {}

void workOnCell(const std::string& folder, const CellInputs& inputs, core::Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  setLimit(RLIMIT_CPU, static_cast<rlim_t>(inputs.limits.time_limit_s));
  const std::string text = files::readTextFile(folder + "/cell.json");
  CellResult result;
  result.id = cellId(text);
  CellCost cost;
  Json spec;
  std::optional<world::Plan> plan;
  try {
    spec = Json::parse(text);
    if (spec.at("code") != resources::codeVersion())
      throw core::InputError(folder + "/cell.json: planned by " + spec.at("code").get<std::string>() +
                             ", this program is " + resources::codeVersion());
    if (spec.at("kind") == "log") plan = plannedWorld(spec, inputs);
  } catch (const Json::exception& error) {
    throw core::InputError(folder + "/cell.json: not a cell of a sweep: " + error.what());
  }
  try {
    const MemoryLimit limit(inputs.limits.memory_limit_mb);
    if (plan)
      recordLog(folder, spec, *plan, inputs, result, progress);
    else
      runMethod(folder, spec, inputs, result, cost, progress);
  } catch (const core::Interrupted&) {
    throw;
  } catch (const core::IoError&) {
    throw;
  } catch (const std::system_error&) {
    throw;
  } catch (const std::exception& error) {
    const bool out_of_memory = memory_ran_out || dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
    const std::string message = messageWithout(folder, inputs, error.what());
    result = {};
    result.id = cellId(text);
    if (out_of_memory)
      setFailure(result, "out of memory",
                 "more than " + files::formatNumber(inputs.limits.memory_limit_mb) + " MB",
                 inputs.limits.memory_limit_mb);
    else
      setFailure(result, "failed", message);
    clear(folder);
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) * 1e-6;
  };
  cost.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  cost.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  writeCellResult(folder, result, cost);
}

void writeCellResult(const std::string& folder, const CellResult& result, const CellCost& cost) {
  auto figures = Json::object(), files = Json::object();
  for (const auto& [key, value] : result.figures) figures[key] = numberOrNull(value);
  for (const auto& [name, file] : result.files)
    files[name] = {{"bytes", file.bytes}, {"sha256", file.sha256}};
  writeJson({{"cpu_s", numberOrNull(cost.cpu_s)},
             {"wall_s", numberOrNull(cost.wall_s)},
             {"mean_ms_per_scan", numberOrNull(cost.mean_ms_per_scan)},
             {"p99_ms_per_scan", numberOrNull(cost.p99_ms_per_scan)},
             {"peak_memory_mb", numberOrNull(cost.peak_memory_mb)}},
            folder + "/cost.json");
  writeJson({{"id", result.id},
             {"status", result.status},
             {"message", result.message},
             {"limit", result.limit},
             {"figures", figures},
             {"files", files}},
            folder + "/result.json");
}

void writeLostCell(const std::string& folder, const CellResult& result, const CellCost& cost) {
  clear(folder);
  writeCellResult(folder, result, cost);
}

CellState readCell(const std::string& folder, const std::string& id, bool check_bytes) {
  CellState state;
  if (!fs::exists(folder)) return state;
  const std::string path = folder + "/result.json";
  if (!fs::exists(path) || !fs::exists(folder + "/cell.json"))
    return damaged(folder + ": holds no result, as a copy that was cut short");
  if (cellId(files::readTextFile(folder + "/cell.json")) != id)
    return damaged(folder + "/cell.json: is not the cell that the folder is named after");
  CellResult& result = state.result;
  try {
    const auto json = Json::parse(files::readTextFile(path));
    json.at("id").get_to(result.id);
    json.at("status").get_to(result.status);
    json.at("message").get_to(result.message);
    json.at("limit").get_to(result.limit);
    for (const auto& [key, value] : json.at("figures").items())
      result.figures.emplace_back(key, numberOf(value));
    for (const auto& [name, file] : json.at("files").items())
      result.files[name] = {file.at("bytes"), file.at("sha256")};
  } catch (const Json::exception&) {
    return damaged(path + ": is cut short or no result of a cell");
  }
  if (result.id != id) return damaged(path + ": is the result of cell " + result.id);
  for (const auto& [name, file] : result.files) {
    std::error_code error;
    const auto bytes = fs::file_size(folder + "/" + name, error);
    if (error || bytes != file.bytes)
      return damaged(folder + "/" + name + ": " +
                     (error ? "is missing" : "has " + std::to_string(bytes) + " bytes") + ", expected " +
                     std::to_string(file.bytes) + " bytes");
    if (check_bytes && resources::fileSha256(folder + "/" + name) != file.sha256)
      return damaged(folder + "/" + name + ": is not the file that the result was made with");
  }
  state.kind = CellState::kComplete;
  return state;
}

CellCost readCellCost(const std::string& folder) {
  CellCost cost;
  try {
    const auto json = Json::parse(files::readTextFile(folder + "/cost.json"));
    cost.cpu_s = numberOf(json.at("cpu_s"));
    cost.wall_s = numberOf(json.at("wall_s"));
    cost.mean_ms_per_scan = numberOf(json.at("mean_ms_per_scan"));
    cost.p99_ms_per_scan = numberOf(json.at("p99_ms_per_scan"));
    cost.peak_memory_mb = numberOf(json.at("peak_memory_mb"));
  } catch (const Json::exception&) {
    throw core::InputError(folder + "/cost.json: is cut short or no cost of a cell");
  }
  return cost;
}

}  // namespace slam::sweep

#include "libslam/run/build_map.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <limits>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/logs/kept_scans.h"
#include "libslam/logs/read_ahead.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/metrics/map_score.h"
#include "libslam/process/memory_meter.h"
#include "libslam/resources/file_hash.h"
#include "libslam/results/manifest_entries.h"
#include "libslam/results/map_cells.h"
#include "libslam/results/scene_file.h"
#include "libslam/results/self_score.h"
#include "libslam/run/external_method.h"
#include "libslam/run/log_feed.h"
#include "libslam/run/timing.h"
#include "libslam/run/told_commands.h"
#include "libslam/threads/cpu_time.h"
#include "libslam/threads/thread_team.h"

namespace slam::run {
namespace {

/// Another program's path: what our own drawing of its map then follows.
ExternalRun runExternal(const files::IniFile& config, const std::string& name, const std::string& log_path,
                        std::uint64_t seed, const std::string& work_folder, core::Progress& progress) {
  auto run = runExternalMethod(readExternalMethod(config), log_path, seed, work_folder, progress);
  if (run.violations.empty()) return run;
  const std::string more = run.violations.size() == 1 ? ""
                                                      : " (and " + std::to_string(run.violations.size() - 1) +
                                                            " more: rasterslam plugin check)";
  throw core::MethodError("method " + name + ": " + run.violations.front() + more);
}

/// Scans of a log may carry stamps that run back; a trajectory, and what goes with it, does not.
template <class Stamped>
std::vector<Stamped> inStampOrder(std::vector<Stamped> stamped) {
  std::stable_sort(stamped.begin(), stamped.end(),
                   [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
  return stamped;
}

/// covariances[i] is of the pose at stamps_s[i].
std::vector<results::StampedCovariance> stamped(const std::vector<Eigen::Matrix3d>& covariances,
                                                const std::vector<double>& stamps_s) {
  std::vector<results::StampedCovariance> result;
  result.reserve(covariances.size());
  for (size_t i = 0; i < covariances.size(); ++i) result.push_back({stamps_s[i], covariances[i]});
  return result;
}

/// A method that leaves every covariance at zero gives none.
bool areGiven(const std::vector<results::StampedCovariance>& covariances) {
  return std::any_of(covariances.begin(), covariances.end(),
                     [](const results::StampedCovariance& stamped) { return !stamped.covariance.isZero(); });
}

/// What is kept of the scans while they come, in the order of the log.
struct Taken {
  explicit Taken(const std::string& folder) : scans(folder) {}

  std::vector<double> milliseconds, stamps_s;
  lidar::Scan last_scan;
  double time_s = 0;      ///< of the scan at work, since the first
  logs::KeptScans scans;  ///< for the self-score
};

/// Does a part of the work that a method may fail in, or an interrupt end: run.stopped says so then. The
/// first reason stays. What comes before the first scan is taken in leaves nothing to keep.
void stoppable(MapRun& run, const Taken& taken, bool keep_partial, const std::function<void()>& work) {
  const auto stop = [&](results::Stop::Reason reason, const std::string& why) {
    if (!run.stopped) run.stopped = {reason, static_cast<int>(run.estimate.size()), taken.time_s, why};
  };
  try {
    work();
  } catch (const core::MethodError& error) {
    if (run.estimate.empty()) throw;
    stop(results::Stop::Reason::kFailed, error.what());
  } catch (const core::Interrupted&) {
    if (!keep_partial || run.estimate.empty()) throw;
    stop(results::Stop::Reason::kInterrupted, "");
  }
}

/// All scans of the log through the method.
void takeIn(logs::ReadAhead& log, mapping::MapBuilder& method, const std::optional<ExternalRun>& external,
            MapRun& run, Taken& taken, resources::Manifest& manifest, core::Progress& progress,
            record::StepObserver* observer) {
  OdometryGaps gaps;
  while (const auto entry = log.next()) {
    const double stamp_s = entry->scan.time_s;
    const double time_s = run.estimate.empty() ? 0 : stamp_s - taken.stamps_s.front();
    taken.time_s = time_s;
    if (run.estimate.empty()) results::describeLidar(entry->scan, manifest.results);
    core::Pose2 T_previous_robot = entry->T_previous_robot;
    if (external) T_previous_robot = external->increment(run.estimate.size());
    core::Pose2 T_map_robot;
    std::optional<Eigen::Matrix3d> covariance;
    double after_s = 0;
    const double before_s = threads::cpuSeconds();
    tellSensors(method, *entry);
    results::insideMethod([&] {
      T_map_robot =
          mapping::processScan(method, entry->scan, T_previous_robot, entry->has_odometry || external);
      after_s = threads::cpuSeconds();
      covariance = mapping::poseCovariance(method);
    });
    if (!core::isFinite(T_map_robot))
      throw core::MethodError(method.name + " diverged: its pose is not finite");
    gaps.add(*entry);
    run.steps_without_odometry = gaps.count();
    if (run.estimate.empty()) run.lidars = log.lidars(), run.remarks = log.remarks();
    taken.milliseconds.push_back((after_s - before_s) * 1000);
    taken.stamps_s.push_back(stamp_s);
    taken.last_scan = entry->scan;
    taken.scans.add(*entry);
    run.estimate.push_back({stamp_s, T_map_robot});
    if (covariance) run.covariances.push_back({stamp_s, *covariance});
    progress.update(log.fractionRead(), time_s);
    if (observer) observer->onStep({time_s, entry->scan, T_previous_robot, T_map_robot, &method});
  }
}

void writePaths(const MapRun& run, const std::string& folder) {
  logs::writeTum(run.estimate, folder + "/trajectory.tum");
  if (run.final_estimate) logs::writeTum(*run.final_estimate, folder + "/trajectory_final.tum");
  if (!run.covariances.empty()) results::writeCovariances(run.covariances, folder + "/covariances.csv");
  if (!run.final_covariances.empty())
    results::writeCovariances(run.final_covariances, folder + "/covariances_final.csv");
  if (!run.relative_covariances.empty())
    results::writeRelativeCovariances(run.relative_covariances, folder + "/covariances_relative.csv");
  // Methods that correct their path keep a journal, be there nothing to tell.
  if (run.final_estimate || !run.journal.empty())
    files::writeFileAtomically(folder + "/journal.csv", results::journalCsv(run.journal));
}

/// Another program's path, and what then draws its map; nothing for a method of ours.
std::optional<ExternalRun> externalRun(const std::string& name, const std::string& log_path,
                                       std::uint64_t seed, const std::string& work_folder,
                                       const Continuation& continuation, files::IniFile& config,
                                       core::Progress& progress) {
  if (!isExternal(config)) return std::nullopt;
  if (!continuation.folder.empty())
    throw core::InputError("method " + name + " is an external program, which cannot go on in a map");
  auto run = runExternal(config, name, log_path, seed, work_folder, progress);
  config = readExternalMethod(config).drawing;
  return run;
}

/// What the method has to say in the end; paths in the log's order.
struct Ending {
  double finish_s = 0;  ///< CPU time of its last work
  double beside_s = 0;  ///< of its other threads, while scans were taken in
  std::optional<core::Trajectory> final_path;
  core::Trajectory path;                        ///< the final one, else the one given online
  std::optional<gridmap::OccupancyRaster> map;  ///< until it is written
  std::optional<double> map_entropy_bits;       ///< where there is a map
  std::optional<results::SelfScore> self;
  std::vector<Eigen::Matrix3d> covariances;  ///< of the final path
  std::vector<results::RelativeCovariance> relative;
};

/// A method at its last work.
class Finisher {
 public:
  Finisher(mapping::MapBuilder& method, MapRun& run, const Taken& taken, const BuildOptions& options)
      : method_(method), run_(run), taken_(taken), options_(options) {}

  void finish(core::Progress& progress) {
    const double begin_s = threads::cpuSeconds(), thread_begin_s = mapping::threadSeconds(method_);
    if (!run_.stopped) ask([&] { mapping::finishMap(method_, progress); });
    ending_.finish_s = threads::cpuSeconds() - begin_s + mapping::threadSeconds(method_) - thread_begin_s;
    ending_.beside_s = thread_begin_s;
  }

  /// Scans and poses pair up in the log's order, which is the robot's; a trajectory's order is that of the
  /// stamps, which run back in some logs.
  Ending results() {
    ask([&] { ending_.final_path = mapping::finalPath(method_, run_.estimate); });
    ending_.path = ending_.final_path.value_or(run_.estimate);
    if (!run_.stopped) ask([&] { ending_.covariances = mapping::finalCovariances(method_); });
    if (!run_.stopped && ending_.final_path) ask([&] { askRelativeCovariances(); });
    ask([&] { ending_.map = mapping::currentMap(method_); });
    return std::move(ending_);
  }

 private:
  void askRelativeCovariances() {
    using Kind = results::RelativeCovariance::Kind;
    const auto& path = ending_.path;
    std::vector<std::pair<int, int>> pairs;
    std::vector<Kind> kinds;
    const auto add = [&](Kind kind, const std::vector<std::pair<int, int>>& some) {
      pairs.insert(pairs.end(), some.begin(), some.end());
      kinds.resize(pairs.size(), kind);
    };
    add(Kind::kMetre, results::pairsApart(path, 1));
    add(Kind::kTenMetres, results::pairsApart(path, 10));
    add(Kind::kLoop, results::loopEnds(mapping::journalOf(method_), path.size()));
    add(Kind::kRelation, results::pairsOf(options_.relations, path));
    const auto told = mapping::relativeCovariances(method_, pairs);
    for (size_t i = 0; i < told.size(); ++i)
      ending_.relative.push_back({kinds[i], path[static_cast<size_t>(pairs[i].first)].time_s,
                                  path[static_cast<size_t>(pairs[i].second)].time_s, told[i]});
  }

  void ask(const std::function<void()>& work) {
    stoppable(run_, taken_, options_.keep_partial, [&] { results::insideMethod(work); });
  }

  mapping::MapBuilder& method_;
  MapRun& run_;
  const Taken& taken_;
  const BuildOptions& options_;
  Ending ending_;
};

/// Writes the map, and holds the scans against the path and the map; both at once where there are two
/// threads. The map as probabilities is the largest that there is by now, and goes when it is written.
void scoreAndDraw(const mapping::MapBuilder& method, Taken& taken, const std::string& log_path,
                  const std::string& lidars, const BuildOptions& options, const std::string& folder,
                  MapRun& run, Ending& ending, core::Progress& progress) {
  if (!ending.map) return;
  ending.map_entropy_bits = metrics::mapEntropy(ending.map->occupancy);
  const auto map = results::toCellMap(*ending.map);
  const auto score = [&] {
    if (run.stopped) return;
    stoppable(run, taken, options.keep_partial, [&] {
      ending.self = taken.scans.rewind() ? results::selfScore(taken.scans, ending.path, map, progress)
                                         : results::selfScore(log_path, ending.path, map, progress, lidars,
                                                              options.threads > 1);
    });
  };
  const auto draw = [&] {
    mapping::saveMaps(method, *ending.map, folder);
    results::writeScene(method, *ending.map, ending.path, taken.last_scan, folder + "/map.3Dscene");
    ending.map.reset();
    process::returnFreedMemory();
  };
  threads::ThreadTeam(std::clamp(options.threads, 1, 2)).forEach(2, [&](size_t job) {
    job == 0 ? draw() : score();
  });
}

/// Everything of the run in its final form: in the order of stamps, with its journal and its cost.
void complete(const mapping::MapBuilder& method, Ending& ending, const Taken& taken,
              const std::optional<ExternalRun>& external, double peak_memory_mb, MapRun& run) {
  run.journal = results::placedJournal(mapping::journalOf(method), taken.stamps_s, ending.path);
  if (run.stopped) run.journal.push_back(results::stopLine(*run.stopped, ending.path.back().pose));
  run.estimate = inStampOrder(std::move(run.estimate));
  run.covariances = areGiven(run.covariances) ? inStampOrder(std::move(run.covariances))
                                              : std::vector<results::StampedCovariance>();
  if (ending.final_path) run.final_estimate = inStampOrder(*ending.final_path);
  run.relative_covariances = ending.relative;
  run.final_covariances = inStampOrder(stamped(ending.covariances, taken.stamps_s));
  ending.covariances = {};  // of a long log it is much
  const double log_seconds = run.estimate.back().time_s - run.estimate.front().time_s;
  run.cost = costOf(taken.milliseconds, ending.finish_s + ending.beside_s, log_seconds);
  run.cost.peak_memory_mb = peak_memory_mb;
  if (external) {
    run.cost = external->cost;
    run.filled_poses = external->filled_poses;
  }
  if (run.final_estimate || !run.journal.empty())
    run.lost_share = results::lostShare(run.journal, log_seconds);
}

void writeFiles(mapping::MapBuilder& method, const MapRun& run, const Ending& ending, const Taken& taken,
                const std::optional<ExternalRun>& external, const Continuation& continuation,
                const std::string& folder) {
  writePaths(run, folder);
  if (!ending.map_entropy_bits)
    mapping::saveKeyFrames(method, folder);
  else if (continuation.localise_only)
    keepMap(continuation.folder, folder);
  if (external)
    files::writeFileAtomically(folder + "/printed.txt", external->printed);
  else
    files::writeFileAtomically(folder + "/timing.csv", timingText(taken.milliseconds, taken.stamps_s));
}

void describeInputs(const std::string& log_path, const files::IniFile& method_config,
                    resources::Manifest& manifest) {
  if (isExternal(method_config))
    for (const auto& [path, hash] : programFiles(method_config)) manifest.inputs[path] = hash;
  manifest.inputs[log_path] = resources::fileSha256(log_path);
  manifest.results["log"] = log_path;
  for (const auto& line : methodParameters(method_config))
    manifest.config[line.section + "." + line.info.key] = line.value;
}

void describeResults(const mapping::MapBuilder& method, const Ending& ending, bool is_external, MapRun& run,
                     resources::Manifest& manifest) {
  auto& results = manifest.results;
  results["scans"] = std::to_string(run.estimate.size());
  results["steps_without_odometry"] = std::to_string(run.steps_without_odometry);
  describeSensors(method, run.lidars, results);
  run.skew_note = skewNote(results["method"], results);
  if (!run.commands_from.empty()) results["commands_from"] = run.commands_from;
  // Of the log's order, which the files' order of stamps may lose.
  results["path_length_m"] = files::formatNumber(run.path_length_m);
  results::describePose("end", run.end, results);
  results::describePose("end_final", ending.path.back().pose, results);
  if (run.stopped) results::describeStop(*run.stopped, results);
  if (const auto lost = results::lostInTheEnd(run.journal)) results["lost"] = results::lostText(*lost);
  if (run.lost_share) results["lost_share"] = files::formatNumber(*run.lost_share);
  if (is_external) results["filled_poses"] = std::to_string(run.filled_poses);
  if (ending.map_entropy_bits)
    results["map_mean_entropy_bits"] = files::formatNumber(*ending.map_entropy_bits);
  if (ending.self) results::describeSelfScore(*ending.self, results);
  results["peak_memory_mb"] = files::formatNumber(run.cost.peak_memory_mb);
  manifest.times_s["finish_s"] = ending.finish_s;
  manifest.times_s["mean_ms_per_scan"] = run.cost.mean_ms_per_scan;
  if (!is_external) manifest.times_s["p99_ms_per_scan"] = run.cost.p99_ms_per_scan;
  manifest.times_s["real_time_factor"] = run.cost.real_time_factor;
}

}  // namespace

MapRun buildMap(const std::string& log_path, const files::IniFile& method_config,
                const std::string& method_name, std::uint64_t seed, const std::string& folder, bool overwrite,
                resources::Manifest manifest, core::Progress& progress, const BuildOptions& options) {
  const Continuation& continuation = options.continuation;
  files::PendingFolder output(folder, overwrite);
  files::IniFile builder_config = method_config;
  const auto external = externalRun(method_name, log_path, seed, output.path() + "/work", continuation,
                                    builder_config, progress);
  process::MemoryMeter memory;
  auto method = mapping::makeMapBuilder(builder_config, method_name, seed);
  // The earlier run's map, before anything is measured.
  if (!continuation.folder.empty()) beginInMap(method, continuation, log_path, output.path(), manifest);
  mapping::useThreads(method, options.threads);
  std::optional<logs::ReadAhead> log;
  // An external program reads the log by itself; its poses are those of the main lidar's scans.
  memory.leaveOut([&] { log.emplace(log_path, external ? "" : method.lidars, options.threads > 1); });
  MapRun run;
  run.commands_from = tellCommands(method, log_path);
  Taken taken(output.path());
  progress.begin("mapping with " + method_name);
  stoppable(run, taken, options.keep_partial,
            [&] { takeIn(*log, method, external, run, taken, manifest, progress, options.observer); });
  progress.end();
  if (run.estimate.empty()) throw core::InputError(log_path + ": holds 0 laser scans, expected at least 1");

  Finisher finisher(method, run, taken, options);
  progress.begin("finishing " + method_name);
  finisher.finish(progress);
  progress.end();
  run.path_length_m = core::pathLength(run.estimate);
  run.end = run.estimate.back().pose;
  // Before anything else takes memory, and before the reader's is free.
  const double peak_memory_mb =
      options.measure_memory ? memory.peakMb() : std::numeric_limits<double>::quiet_NaN();
  log.reset();
  process::returnFreedMemory();
  if (options.observer) options.observer->onFinished(method);
  Ending ending = finisher.results();
  scoreAndDraw(method, taken, log_path, external ? "" : method.lidars, options, output.path(), run, ending,
               progress);
  complete(method, ending, taken, external, peak_memory_mb, run);

  writeFiles(method, run, ending, taken, external, continuation, output.path());
  manifest.seed = seed;
  manifest.results["method"] = method_name;
  describeInputs(log_path, method_config, manifest);
  describeResults(method, ending, external.has_value(), run, manifest);
  for (const auto& [file, note] : results::fileNotes())
    if (std::filesystem::exists(output.path() + "/" + file)) manifest.files[file] = note;
  resources::writeManifest(manifest, output.path() + "/manifest.json");
  output.commit();
  return run;
}

}  // namespace slam::run

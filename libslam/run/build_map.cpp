#include "libslam/run/build_map.h"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/core/parameters.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/metrics/map_score.h"
#include "libslam/process/cpu_time.h"
#include "libslam/process/process_memory.h"
#include "libslam/run/external_method.h"
#include "libslam/run/known_map.h"
#include "libslam/run/log_feed.h"
#include "libslam/run/map_plan.h"
#include "libslam/run/scene_file.h"
#include "libslam/run/self_score.h"
#include "libslam/run/told_commands.h"

namespace slam::run {
namespace {

/// Peak memory of this process from construction on, over its size then. Linux lets a process forget its own
/// peak. Pages of files that have come meanwhile (mostly code that ran for the first time) are not counted:
/// how many those are depends on what the process did before.
class MemoryMeter {
 public:
  MemoryMeter() {
    std::ofstream("/proc/self/clear_refs") << "5";
    before_mb_ = process::processMemoryMb("VmRSS");
    files_before_mb_ = process::processMemoryMb("RssFile");
  }
  double peakMb() const {
    return std::max(0.0, process::processMemoryMb("VmHWM") - before_mb_ -
                             (process::processMemoryMb("RssFile") - files_before_mb_));
  }

 private:
  double before_mb_, files_before_mb_;
};

Cost summarize(std::vector<double> milliseconds, double finish_s, double log_seconds) {
  Cost cost;
  if (milliseconds.empty()) return cost;
  double total_ms = 1000 * finish_s;
  for (const double ms : milliseconds) total_ms += ms;
  std::sort(milliseconds.begin(), milliseconds.end());
  const auto rank = static_cast<size_t>(std::ceil(0.99 * static_cast<double>(milliseconds.size())));
  cost.mean_ms_per_scan = total_ms / static_cast<double>(milliseconds.size());
  cost.p99_ms_per_scan = milliseconds[rank - 1];
  cost.real_time_factor = log_seconds / (total_ms / 1000);
  return cost;
}

const std::map<std::string, std::string>& fileNotes() {
  static const std::map<std::string, std::string> notes = {
      {"trajectory.tum", "estimated pose of every scan, TUM form: rasterslam eval, evo"},
      {"trajectory_final.tum", "the final path, after all corrections: rasterslam eval --relations, evo"},
      {"covariances_final.csv", "the same of the poses of trajectory_final.tum"},
      {"covariances.csv",
       "how sure the method says that it is of each of these poses: x, y (m), phi (rad), map frame"},
      {"map.yaml", "ROS map: map_server, ros-map-yaml2mrpt; its picture is map.png"},
      {"map.png", "the map as a picture"},
      {"map.gridmap.gz", "MRPT occupancy grid: pf-localization, GridmapNavSimul"},
      {"map.simplemap", "MRPT key frames: robot-map-gui, observations2map, pf-localization"},
      {"graph.g2o", "the pose graph: rasterslam graph, g2o, MRPT's graph-slam"},
      {"map.3Dscene",
       "map, path, last scan, and particles or graph with loops, in 3D: rasterslam view --mrpt"},
      {"journal.csv", "what the method says of its work: matches, loops, corrections, by scan"},
      {"timing.csv", "CPU milliseconds of every scan"},
      {"printed.txt", "what the external program printed"},
  };
  return notes;
}

std::string timingText(const std::vector<double>& milliseconds, const std::vector<double>& stamps_s) {
  std::ostringstream timing;
  timing << "scan,time_s,cpu_ms\n";
  for (size_t i = 0; i < milliseconds.size(); ++i)
    timing << i << ',' << core::formatNumber(stamps_s[i] - stamps_s.front()) << ','
           << core::formatNumber(milliseconds[i]) << '\n';
  return timing.str();
}

/// Another program's path: what our own drawing of its map then follows.
ExternalRun runExternal(const core::IniFile& config, const std::string& name, const std::string& log_path,
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
std::vector<StampedCovariance> stamped(const std::vector<Eigen::Matrix3d>& covariances,
                                       const std::vector<double>& stamps_s) {
  std::vector<StampedCovariance> result;
  for (size_t i = 0; i < covariances.size(); ++i) result.push_back({stamps_s[i], covariances[i]});
  return result;
}

/// A method that leaves every covariance at zero gives none.
bool areGiven(const std::vector<StampedCovariance>& covariances) {
  return std::any_of(covariances.begin(), covariances.end(),
                     [](const StampedCovariance& stamped) { return !stamped.covariance.isZero(0); });
}

void describePose(const std::string& name, const core::Pose2& pose,
                  std::map<std::string, std::string>& results) {
  results[name + ".x_m"] = core::formatNumber(pose.x);
  results[name + ".y_m"] = core::formatNumber(pose.y);
  results[name + ".yaw_rad"] = core::formatNumber(pose.phi);
}

double lidarReach(const std::string& log_path) {
  const auto first = logs::LogReader(log_path).next();
  if (!first) throw core::InputError(log_path + ": holds 0 laser scans, expected at least 1");
  return first->scan.max_range_m;
}

/// The map as key frames: the file itself, that of a folder, or views drawn in a grid, which go into the
/// output.
std::string keyFramesOf(const Continuation& continuation, const std::string& log_path,
                        const std::string& output) {
  const std::string& map = continuation.folder;
  if (isGridMap(map)) {
    const std::string views = output + "/map.simplemap";
    mapping::writeKeyFrames(viewsOf(loadGridMap(map), lidarReach(log_path), map), views);
    return views;
  }
  if (std::filesystem::path(map).extension() == ".simplemap") return map;
  if (std::filesystem::is_regular_file(map))
    throw core::InputError(map +
                           ": found a file of another kind, expected the folder of a run, a ROS map's .yaml, "
                           ".gridmap.gz or .simplemap");
  return map + "/map.simplemap";
}

/// The earlier run's map, before anything is measured.
void beginInMap(mapping::MapBuilder& method, const Continuation& continuation, const std::string& log_path,
                const std::string& output, core::Manifest& manifest) {
  const std::string key_frames = keyFramesOf(continuation, log_path, output);
  const std::string& map = isGridMap(continuation.folder) ? continuation.folder : key_frames;
  std::optional<core::Pose2> T_map_robot = continuation.T_map_robot;
  const bool anywhere = continuation.localise_only && mapping::methodType(method.type).finds_itself;
  const bool is_run = map == continuation.folder + "/map.simplemap";
  if (!T_map_robot && !anywhere && is_run) T_map_robot = endOfRun(continuation.folder);
  mapping::continueMap(method, key_frames, T_map_robot, continuation.localise_only);
  manifest.inputs[map] = core::fileSha256(map);
  manifest.results[continuation.localise_only ? "localised_in" : "continues"] = continuation.folder;
  if (T_map_robot) describePose("start", *T_map_robot, manifest.results);
}

/// The map of before, byte for byte where it has these files: localising has not changed it.
void keepMap(const std::string& map, const std::string& to) {
  const auto copy = [&](const std::string& file, const std::string& name) {
    if (std::filesystem::exists(file)) core::writeFileAtomically(to + "/" + name, core::readTextFile(file));
  };
  const std::filesystem::path path(map);
  if (isGridMap(map)) {
    world::savePlan(loadGridMap(map), to + "/map.yaml");
    if (path.extension() == ".gz") copy(map, "map.gridmap.gz");
    return;
  }
  const std::string from = path.extension() == ".simplemap" ? path.parent_path().string() : map;
  for (const char* file : {"map.yaml", "map.png", "map.gridmap.gz", "graph.g2o"})
    copy(from + "/" + file, file);
  copy(path.extension() == ".simplemap" ? map : from + "/map.simplemap", "map.simplemap");
}

void describeSelfScore(const SelfScore& score, std::map<std::string, std::string>& results) {
  results["self.mean_map_entropy"] = core::formatNumber(score.sharpness.mean_map_entropy);
  results["self.wall_thickness_m"] = core::formatNumber(score.sharpness.wall_thickness_m);
  results["self.on_wall_share"] = core::formatNumber(score.agreement.on_wall_share);
  results["self.through_wall_share"] = core::formatNumber(score.agreement.through_wall_share);
}

/// What is kept of the scans while they come, in the order of the log.
struct Taken {
  std::vector<double> milliseconds, stamps_s;
  robot::Scan last_scan;
  double time_s = 0;  ///< of the scan at work, since the first
};

/// Does a part of the work that a method may fail in, or an interrupt end: run.stopped says so then. The
/// first reason stays. What comes before the first scan is taken in leaves nothing to keep.
void stoppable(MapRun& run, const Taken& taken, bool keep_partial, const std::function<void()>& work) {
  const auto stop = [&](Stop::Reason reason, const std::string& why) {
    if (!run.stopped) run.stopped = {reason, static_cast<int>(run.estimate.size()), taken.time_s, why};
  };
  try {
    work();
  } catch (const core::MethodError& error) {
    if (run.estimate.empty()) throw;
    stop(Stop::Reason::kFailed, error.what());
  } catch (const core::Interrupted&) {
    if (!keep_partial || run.estimate.empty()) throw;
    stop(Stop::Reason::kInterrupted, "");
  }
}

/// All scans of the log through the method.
void takeIn(const std::string& log_path, mapping::MapBuilder& method,
            const std::optional<ExternalRun>& external, MapRun& run, Taken& taken, core::Manifest& manifest,
            core::Progress& progress, record::StepObserver* observer) {
  // An external program reads the log by itself; its poses are those of the main lidar's scans.
  logs::LogReader log(log_path, external ? "" : method.lidars);
  OdometryGaps gaps;
  while (const auto entry = log.next()) {
    const double stamp_s = entry->scan.time_s;
    const double time_s = run.estimate.empty() ? 0 : stamp_s - taken.stamps_s.front();
    taken.time_s = time_s;
    if (run.estimate.empty()) describeLidar(entry->scan, manifest.results);
    core::Pose2 T_previous_robot = entry->T_previous_robot;
    if (external) T_previous_robot = external->increment(run.estimate.size());
    core::Pose2 T_map_robot;
    std::optional<Eigen::Matrix3d> covariance;
    double after_s = 0;
    const double before_s = process::threadCpuSeconds();
    tellSensors(method, *entry);
    insideMethod([&] {
      T_map_robot =
          mapping::processScan(method, entry->scan, T_previous_robot, entry->has_odometry || external);
      after_s = process::threadCpuSeconds();
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
    run.estimate.push_back({stamp_s, T_map_robot});
    if (covariance) run.covariances.push_back({stamp_s, *covariance});
    progress.update(log.fractionRead(), time_s);
    if (observer) observer->onStep({time_s, entry->scan, T_previous_robot, T_map_robot, &method});
  }
}

void writePaths(const MapRun& run, const std::string& folder) {
  logs::writeTum(run.estimate, folder + "/trajectory.tum");
  if (run.final_estimate) logs::writeTum(*run.final_estimate, folder + "/trajectory_final.tum");
  if (!run.covariances.empty()) writeCovariances(run.covariances, folder + "/covariances.csv");
  if (!run.final_covariances.empty())
    writeCovariances(run.final_covariances, folder + "/covariances_final.csv");
  // Methods that correct their path keep a journal, be there nothing to tell.
  if (run.final_estimate || !run.journal.empty())
    core::writeFileAtomically(folder + "/journal.csv", journalCsv(run.journal));
}

void describeStop(const Stop& stop, std::map<std::string, std::string>& results) {
  results["status"] = "incomplete";
  results[core::wordOf(eventOf(stop))] = stopText(stop);
}

}  // namespace

void describeLidar(const robot::Scan& scan, std::map<std::string, std::string>& results) {
  results["lidar.beams"] = std::to_string(scan.ranges_m.size());
  results["lidar.first_angle_rad"] = core::formatNumber(scan.first_angle_rad);
  results["lidar.step_rad"] = core::formatNumber(scan.step_rad);
  results["lidar.max_range_m"] = core::formatNumber(scan.max_range_m);
  results["lidar.mount_x_m"] = core::formatNumber(scan.T_robot_lidar.x);
  results["lidar.mount_y_m"] = core::formatNumber(scan.T_robot_lidar.y);
  results["lidar.mount_yaw_rad"] = core::formatNumber(scan.T_robot_lidar.phi);
}

core::Pose2 endOfRun(const std::string& folder) {
  const std::string path = folder + "/manifest.json";
  const auto manifest = core::readManifest(path);
  const auto number = [&](const std::string& key) {
    double value = 0;
    const auto it = manifest.results.find("end_final." + key);
    if (it == manifest.results.end() || !core::parseNumber(it->second, value))
      throw core::InputError(path + ": key 'results.end_final." + key +
                             "' is missing, expected the folder of a 'rasterslam run'");
    return value;
  };
  return {number("x_m"), number("y_m"), number("yaw_rad")};
}

MapRun buildMap(const std::string& log_path, const core::IniFile& method_config,
                const std::string& method_name, std::uint64_t seed, const std::string& folder, bool overwrite,
                core::Manifest manifest, core::Progress& progress, bool measure_memory,
                const Continuation& continuation, record::StepObserver* observer, bool keep_partial) {
  core::PendingFolder output(folder, overwrite);
  std::optional<ExternalRun> external;
  core::IniFile builder_config = method_config;
  if (isExternal(method_config)) {
    if (!continuation.folder.empty())
      throw core::InputError("method " + method_name +
                             " is an external program, which cannot go on in a map");
    builder_config = readExternalMethod(method_config).drawing;
    external = runExternal(method_config, method_name, log_path, seed, output.path() + "/work", progress);
  }
  const MemoryMeter memory;
  auto method = mapping::makeMapBuilder(builder_config, method_name, seed);
  if (!continuation.folder.empty()) beginInMap(method, continuation, log_path, output.path(), manifest);
  MapRun run;
  run.commands_from = tellCommands(method, log_path);
  Taken taken;
  progress.begin("mapping with " + method_name);
  stoppable(run, taken, keep_partial,
            [&] { takeIn(log_path, method, external, run, taken, manifest, progress, observer); });
  progress.end();
  if (run.estimate.empty()) throw core::InputError(log_path + ": holds 0 laser scans, expected at least 1");

  const double finish_begin_s = process::threadCpuSeconds();
  const auto ask = [&](const std::function<void()>& work) {
    stoppable(run, taken, keep_partial, [&] { insideMethod(work); });
  };
  if (!run.stopped) ask([&] { mapping::finishMap(method); });
  const double finish_s = process::threadCpuSeconds() - finish_begin_s;
  run.path_length_m = core::pathLength(run.estimate);
  run.end = run.estimate.back().pose;
  // Before anything else takes memory.
  const double peak_memory_mb = measure_memory ? memory.peakMb() : std::numeric_limits<double>::quiet_NaN();
  if (observer) observer->onFinished(method);
  // Scans and poses pair up in the log's order, which is the robot's; a trajectory's order is that of the
  // stamps, which run back in some logs.
  std::optional<core::Trajectory> final_path;
  ask([&] { final_path = mapping::finalPath(method, run.estimate); });
  const auto in_log_order = final_path.value_or(run.estimate);
  const core::Pose2 end_final = in_log_order.back().pose;
  std::optional<gridmap::OccupancyRaster> map;
  std::optional<SelfScore> self;
  ask([&] { map = mapping::currentMap(method); });
  if (!run.stopped)
    stoppable(run, taken, keep_partial, [&] {
      self = selfScore(log_path, in_log_order, toPlan(*map), progress, external ? "" : method.lidars);
    });
  std::vector<Eigen::Matrix3d> final_covariances;
  if (!run.stopped) ask([&] { final_covariances = mapping::finalCovariances(method); });
  run.journal = placedJournal(mapping::journalOf(method), taken.stamps_s, in_log_order);
  if (run.stopped) run.journal.push_back(stopLine(*run.stopped, end_final));
  run.estimate = inStampOrder(std::move(run.estimate));
  run.covariances =
      areGiven(run.covariances) ? inStampOrder(std::move(run.covariances)) : std::vector<StampedCovariance>();
  if (final_path) run.final_estimate = inStampOrder(std::move(*final_path));
  run.final_covariances = inStampOrder(stamped(final_covariances, taken.stamps_s));
  run.cost =
      summarize(taken.milliseconds, finish_s, run.estimate.back().time_s - run.estimate.front().time_s);
  run.cost.peak_memory_mb = peak_memory_mb;
  if (external) {
    run.cost = external->cost;
    run.filled_poses = external->filled_poses;
  }

  writePaths(run, output.path());
  if (map) {
    mapping::saveMaps(method, output.path());
    writeScene(method, in_log_order, taken.last_scan, output.path() + "/map.3Dscene");
    if (continuation.localise_only) keepMap(continuation.folder, output.path());
  } else {
    mapping::saveKeyFrames(method, output.path());
  }
  if (external)
    core::writeFileAtomically(output.path() + "/printed.txt", external->printed);
  else
    core::writeFileAtomically(output.path() + "/timing.csv", timingText(taken.milliseconds, taken.stamps_s));

  manifest.seed = seed;
  if (external)
    for (const auto& [path, hash] : programFiles(method_config)) manifest.inputs[path] = hash;
  manifest.inputs[log_path] = core::fileSha256(log_path);
  for (const auto& line : methodParameters(method_config))
    manifest.config[line.section + "." + line.info.key] = line.value;
  for (const auto& [file, note] : fileNotes())
    if (std::filesystem::exists(output.path() + "/" + file)) manifest.files[file] = note;
  manifest.results["method"] = method_name;
  manifest.results["log"] = log_path;
  manifest.results["scans"] = std::to_string(run.estimate.size());
  manifest.results["steps_without_odometry"] = std::to_string(run.steps_without_odometry);
  describeSensors(method, run.lidars, manifest.results);
  run.skew_note = skewNote(method_name, manifest.results);
  if (!run.commands_from.empty()) manifest.results["commands_from"] = run.commands_from;
  // Of the log's order, which the files' order of stamps may lose.
  manifest.results["path_length_m"] = core::formatNumber(run.path_length_m);
  describePose("end", run.end, manifest.results);
  describePose("end_final", end_final, manifest.results);
  if (run.stopped) describeStop(*run.stopped, manifest.results);
  if (const auto lost = lostInTheEnd(run.journal)) manifest.results["lost"] = lostText(*lost);
  if (run.final_estimate || !run.journal.empty()) {
    run.lost_share = lostShare(run.journal, run.estimate.back().time_s - run.estimate.front().time_s);
    manifest.results["lost_share"] = core::formatNumber(*run.lost_share);
  }
  if (external) manifest.results["filled_poses"] = std::to_string(run.filled_poses);
  if (map)
    manifest.results["map_mean_entropy_bits"] = core::formatNumber(metrics::mapEntropy(map->occupancy));
  if (self) describeSelfScore(*self, manifest.results);
  manifest.times_s["finish_s"] = finish_s;
  manifest.times_s["mean_ms_per_scan"] = run.cost.mean_ms_per_scan;
  if (!external) manifest.times_s["p99_ms_per_scan"] = run.cost.p99_ms_per_scan;
  manifest.times_s["real_time_factor"] = run.cost.real_time_factor;
  manifest.results["peak_memory_mb"] = core::formatNumber(run.cost.peak_memory_mb);
  core::writeManifest(manifest, output.path() + "/manifest.json");
  output.commit();
  return run;
}

}  // namespace slam::run

// Scan-difference odometry side by side: drift, failures and time of each method on simulated and real logs.
//   rasterslam_odometry_bench [--data FOLDER] [--scans N] [--log NAME] [--method NAME] [--csv F] [--json F]
// FOLDER holds logs/ and sim/ (CARMEN logs with relations or truth); what is absent is skipped and said.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <sstream>

#include "benchmarks/odometry/bench_log.h"
#include "benchmarks/odometry/drift.h"
#include "benchmarks/odometry/mrpt_icp.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/navigate/driver.h"
#include "libslam/record/record.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/resources.h"
#include "libslam/sim/simulator.h"
#include "libslam/strategies/strategy.h"
#include "libslam/table/table.h"

namespace {

using namespace odometry_bench;
using namespace slam;

struct Arguments {
  std::string data = "../shared/data", csv, json, log, method;
  size_t scans = 3000;
  std::vector<std::string> icp;  // settings to try instead of the tuned ones: name=value
};

/// A 361-beam scanner over 180 degrees: 5 scans per second, 1 cm noise, half a per cent of the readings lost.
files::IniFile scannerAhead() {
  files::IniFile ini;
  for (const auto& [key, value] : {std::pair<const char*, const char*>{"fov_deg", "180"},
                                   {"beams", "361"},
                                   {"max_range_m", "30"},
                                   {"sigma_m", "0.01"},
                                   {"drop_out", "0.005"},
                                   {"rate_hz", "5"}})
    ini.set("lidar", key, value, "benchmark");
  return ini;
}

/// A robot that explores a committed world by quadrants.
BenchLog simulate(const std::string& log_name, const std::string& world_name, const files::IniFile& lidar,
                  size_t most_scans) {
  const world::Plan plan = world::loadPlan(resources::resolvePlan(world_name));
  const record::RecordConfig config = record::readRecordConfig(lidar);
  constexpr std::uint64_t kSeed = 1;
  const auto start = world::findStartPose(plan, 0.5);
  if (!start) throw core::InputError(world_name + ": no free place for the robot");
  sim::Simulator simulator(plan, config.robot, config.lidar, config.odometry, *start, kSeed);
  navigate::Driver driver(strategies::makeStrategy(config.strategy, core::RandomStream(kSeed, "strategy")),
                          config.strategy, config.robot, 1 / config.lidar.rate_hz,
                          core::RandomStream(kSeed, "driver"));
  BenchLog log;
  log.name = log_name;
  robot::CommandSeries commands;
  robot::Commanded commanded = robot::MotionKind::kRest;
  sim::Sensed sensed = simulator.sense();
  while (log.scans.size() < std::min<size_t>(most_scans, 1500)) {
    log.scans.push_back(sensed.scan);
    log.commands.push_back(commanded);
    log.truth.push_back({simulator.time_s(), simulator.truth()});
    const auto command = driver.next(sensed.scan, sensed.T_odom_robot, sensed.collided);
    if (driver.finished()) break;
    commanded = commands.next(command);
    sensed = simulator.step(command);
  }
  return log;
}

/// Scans and wheel odometry, at most so many.
BenchLog readScans(const std::string& path, const std::string& name, size_t most_scans) {
  BenchLog log;
  log.name = name;
  logs::LogReader reader(path);
  robot::CommandSeries commands;
  while (log.scans.size() < most_scans) {
    auto entry = reader.next();
    if (!entry) break;
    log.scans.push_back(std::move(entry->scan));
    log.commands.push_back(entry->has_odometry || log.wheels.empty() ? commands.next(entry->T_previous_robot)
                                                                     : robot::Commanded());
    log.wheels.push_back(entry->T_odom_robot);
  }
  if (log.scans.empty()) throw core::InputError(path + ": holds 0 laser scans, expected at least 1");
  return log;
}

BenchLog readRing(const std::string& data, const std::string& name, size_t most_scans) {
  BenchLog log = readScans(data + "/sim/" + name + ".clf.xz", name, most_scans);
  log.truth = logs::readTum(data + "/sim/" + name + ".truth.tum");
  log.truth.resize(std::min(log.truth.size(), log.scans.size()));
  for (size_t i = 0; i < log.truth.size(); ++i)
    if (std::abs(log.truth[i].time_s - log.scans[i].time_s) > 1e-3)
      throw core::InputError(name + ": scan and truth " + std::to_string(i) + " have different stamps");
  return log;
}

BenchLog readReal(const std::string& data, const std::string& name, const std::string& file, double sigma_m,
                  size_t most_scans) {
  const std::string folder = data + "/logs/" + name + "/";
  BenchLog log = readScans(folder + file, name, most_scans);
  for (auto& scan : log.scans) scan.range_sigma_m = sigma_m;
  log.relations = logs::readRelations(folder + name + ".relations");
  return log;
}

struct NamedLog {
  std::string name, path;  // path: what must exist, or ""
  std::function<BenchLog()> load;
};

std::vector<NamedLog> logs(const Arguments& a) {
  std::vector<NamedLog> all;
  const auto simulated = [&](const std::string& name, const char* world, const files::IniFile& lidar) {
    all.push_back({name, "", [=] { return simulate(name, world, lidar, a.scans); }});
  };
  for (const char* world : {"flat", "office_loop", "pillar_hall", "maze", "corridor"})
    simulated(std::string("sim ") + world, world, scannerAhead());
  const auto original = resources::readConfigFile(resources::configsFolder() + "/lidars/thesis_360.ini");
  for (const char* world : {"flat", "office_loop"})
    simulated(std::string("sim ") + world + ", thesis_360", world, original);
  for (const char* ring : {"ring_A", "ring_B"})
    all.push_back(
        {ring, a.data + "/sim/" + ring + ".clf.xz", [=] { return readRing(a.data, ring, a.scans); }});
  // What the lines do not say: how the readings scatter.
  const auto real = [&](const char* name, const std::string& file, double sigma_m) {
    all.push_back({name, a.data + "/logs/" + name + "/" + file,
                   [=] { return readReal(a.data, name, file, sigma_m, a.scans); }});
  };
  real("intel", "intel.clf.bz2", 0.01);
  real("fr079", "fr079.clf.bz2", 0.01);
  real("mit-killian", "mit-killian.reconstructed.clf.xz", 0.015);
  return all;
}

struct NamedMethod {
  std::string name;
  std::function<std::unique_ptr<odometry::ScanOdometry>()> make;
};

IcpSettings icpSettings(const Arguments& a) {
  IcpSettings s;
  for (const std::string& text : a.icp) {
    const size_t equals = text.find('=');
    const std::string key = text.substr(0, equals);
    const double value = std::atof(text.substr(equals + 1).c_str());
    if (key == "threshold_m")
      s.threshold_m = value;
    else if (key == "threshold_deg")
      s.threshold_deg = value;
    else if (key == "smallest_threshold_m")
      s.smallest_threshold_m = value;
    else if (key == "shrink")
      s.shrink = value;
    else if (key == "point_distance_m")
      s.point_distance_m = value;
    else if (key == "constant_velocity")
      s.constant_velocity = value != 0;
    else
      throw core::InputError("--icp " + text + ": unknown setting");
  }
  return s;
}

std::vector<NamedMethod> methods(const Arguments& a) {
  std::vector<NamedMethod> all;
  for (const std::string& name : odometry::scanOdometryNames())
    all.push_back({name, [name] {
                     odometry::ScanOdometryOptions options;
                     options.method = name;
                     return odometry::makeScanOdometry(options);
                   }});
  all.push_back({"mrpt_icp", [settings = icpSettings(a)] { return makeMrptIcp(settings); }});
  return all;
}

table::Table emptyTable() {
  table::Table table;
  table.caption = "Odometry from consecutive scans";
  table.columns = {{"log", "log"},
                   {"method", "method"},
                   {"scans", "scans", 0},
                   {"drift_m_per_m", "drift (m/m)", 4},
                   {"drift_rad_per_rad", "drift (rad/rad)", 4},
                   {"long_drift_m_per_m", "long drift (m/m)", 4},
                   {"median_error_m", "median error (m)", 4},
                   {"median_error_deg", "median error (deg)", 3},
                   {"wrong", "wrong by > 0.1 m", 0},
                   {"flagged", "flagged steps", 0},
                   {"median_us", "us per pair", 0}};
  table.notes = {
      "drift: errors over stretches of 1 m (with truth) or over relations at most 5 s apart, summed, over "
      "the "
      "metres driven or radians turned in them; medians: error of one stretch",
      "long drift: the same over stretches of 10 m, or over relations 5 to 300 s apart and the metres that "
      "the "
      "wheels counted between; the relations' own errors, a few centimetres each, weigh little there",
      "wrong: steps (with truth) or related pairs (intel, fr079, mit-killian) off by more than 0.1 m; "
      "flagged: "
      "steps that the method itself calls unreliable",
      "us per pair: thread CPU time of one update, median",
      "range_flow measures against one scan while the robot is within 0.4 m and 15 degrees of it; the "
      "others, "
      "and mrpt_icp, against the scan before",
      "argmax knows whether the robot moved or turned: the simulated robot was told, of the others the "
      "wheels "
      "say; argmax_blind guesses it from the scans",
      "mrpt_icp: mrpt::slam::CICP, icpClassic, scan to scan, no thinning, started from the step before; "
      "thresholdDist 0.5 m, smallestThresholdDist 0.02 m, ALFA 0.5: the best geometric mean of drift over "
      "all "
      "logs among 0.3, 0.5, 1 m x 0.02, 0.05, 0.1 m x 0.5, 0.8 x from the step before or from rest"};
  return table;
}

Arguments parse(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i < argc; ++i) {
    const std::string key = argv[i];
    if (i + 1 >= argc) throw core::InputError(key + ": expected a value");
    const std::string value = argv[++i];
    if (key == "--data")
      a.data = value;
    else if (key == "--csv")
      a.csv = value;
    else if (key == "--json")
      a.json = value;
    else if (key == "--log")
      a.log = value;
    else if (key == "--method")
      a.method = value;
    else if (key == "--icp")
      a.icp.push_back(value);
    else if (key == "--scans")
      a.scans = std::strtoul(value.c_str(), nullptr, 10);
    else
      throw core::InputError(key + ": unknown option");
  }
  return a;
}

void run(const Arguments& a) {
  table::Table table = emptyTable();
  for (const NamedLog& named : logs(a)) {
    if (named.name.find(a.log) == std::string::npos) continue;
    if (!named.path.empty() && !std::filesystem::exists(named.path)) {
      std::cerr << named.name << ": skipped, " << named.path << " is not there\n";
      continue;
    }
    const BenchLog log = named.load();
    for (const NamedMethod& method : methods(a)) {
      if (method.name.find(a.method) == std::string::npos) continue;
      const Drift d = measureDrift(log, *method.make());
      table.rows.push_back({log.name, method.name, double(log.scans.size()), d.per_metre, d.per_radian,
                            d.long_per_metre, d.median_m, core::radToDeg(d.median_rad), double(d.wrong),
                            double(d.flagged), d.median_us});
      std::cerr << log.name << " " << method.name << "\n";
    }
  }
  std::cout << table::toText(table);
  if (!a.csv.empty()) files::writeFileAtomically(a.csv, table::toCsv(table));
  if (!a.json.empty()) files::writeFileAtomically(a.json, table::toJson(table));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    ::run(parse(argc, argv));
    return 0;
  } catch (const core::InputError& error) {
    std::cerr << error.what() << "\n";
    return 3;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}

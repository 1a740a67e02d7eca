// How firmly the graph method stands: the annotated and the simulated logs as they are, with noise on every
// range, with rounded odometry and without any.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/metrics/relation_error.h"
#include "libslam/metrics/trajectory_error.h"
#include "libslam/threads/cpu_time.h"

namespace {

using slam::core::Pose2;
using slam::core::Trajectory;

struct BenchLog {
  std::string name;
  std::vector<slam::logs::LogEntry> entries;
  slam::core::Relations relations;
  Trajectory truth;
};

struct Variant {
  std::string name;
  double jitter_m = 0, round_m = 0, round_rad = 0;
  bool odometry = true;
  int seeds = 1;
};

BenchLog load(const std::string& name, const std::string& log, const std::string& relations,
              const std::string& truth) {
  BenchLog result{name, {}, {}, {}};
  slam::logs::LogReader reader(log);
  while (auto entry = reader.next()) result.entries.push_back(std::move(*entry));
  if (!relations.empty()) result.relations = slam::logs::readRelations(relations);
  if (!truth.empty()) result.truth = slam::logs::readTum(truth);
  return result;
}

double rounded(double value, double step) {
  return step > 0 ? std::round(value / step) * step : value;
}

void runOnce(const BenchLog& log, const Variant& variant, int seed) {
  slam::core::RandomStream noise(static_cast<std::uint64_t>(seed), "jitter");
  slam::graph::GraphSlam graph{slam::keyframes::GraphOptions()};
  Trajectory online;
  double cpu_s = 0;
  Pose2 T_odom_before;
  for (const auto& entry : log.entries) {
    auto scan = entry.scan;
    for (float& range : scan.ranges_m)
      if (slam::lidar::isReturn(range) && variant.jitter_m > 0)
        range += static_cast<float>(noise.uniform(-variant.jitter_m, variant.jitter_m));
    const Pose2& odom = entry.T_odom_robot;
    const Pose2 T_odom_robot{rounded(odom.x, variant.round_m), rounded(odom.y, variant.round_m),
                             rounded(odom.phi, variant.round_rad)};
    const Pose2 increment = slam::core::between(T_odom_before, T_odom_robot);
    T_odom_before = T_odom_robot;
    const double begin_s = slam::threads::cpuSeconds();
    const auto step = graph.process(scan, increment, entry.has_odometry && variant.odometry);
    cpu_s += slam::threads::cpuSeconds() - begin_s;
    online.push_back({scan.time_s, step.T_map_robot});
  }
  const double begin_s = slam::threads::cpuSeconds();
  graph.finish();
  cpu_s += slam::threads::cpuSeconds() - begin_s;
  Trajectory in_the_end = online;
  const auto poses = graph.poses();
  for (size_t i = 0; i < poses.size(); ++i) in_the_end[i].pose = poses[i];
  const double ms = 1000 * cpu_s / static_cast<double>(log.entries.size());
  if (!log.truth.empty()) {
    std::printf("%-12s %-18s %4d  %8.4f  %8.4f  %7s  %7.3f\n", log.name.c_str(), variant.name.c_str(), seed,
                slam::metrics::trajectoryError(log.truth, online).position_m.rmse,
                slam::metrics::trajectoryError(log.truth, in_the_end).position_m.rmse, "", ms);
  } else {
    const auto before = slam::metrics::relationError(log.relations, online);
    const auto after = slam::metrics::relationError(log.relations, in_the_end);
    std::printf("%-12s %-18s %4d  %8.4f  %8.4f  %7.3f  %7.3f\n", log.name.c_str(), variant.name.c_str(), seed,
                before.translation_m.mean, after.translation_m.mean,
                slam::core::radToDeg(after.rotation_rad.mean), ms);
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("The graph method on annotated and simulated logs, disturbed");
  std::string data = std::string(RASTERSLAM_SOURCE_DIR) + "/../shared/data";
  int seeds = 5;
  app.add_option("--data", data, "folder that holds logs/ and sim/");
  app.add_option("--seeds", seeds, "runs with noise");
  CLI11_PARSE(app, argc, argv);
  const double mm = 0.001;
  const std::vector<Variant> variants = {{"as it is", 0, 0, 0, true, 1},
                                         {"ranges +- 1 mm", mm, 0, 0, true, seeds},
                                         {"odometry rounded", 0, 10 * mm, slam::core::degToRad(0.5), true, 1},
                                         {"no odometry", 0, 0, 0, false, 1}};
  std::printf("log          variant            seed  online m   final m  rot deg  ms/scan\n");
  std::printf("(mean error of relations; for the rings ATE rmse. Odometry rounded to 1 cm and 0.5 deg.)\n");
  try {
    const std::string logs = data + "/logs/", sim = data + "/sim/";
    for (const auto& log : {load("intel", logs + "intel/intel.clf.bz2", logs + "intel/intel.relations", ""),
                            load("fr079", logs + "fr079/fr079.clf.bz2", logs + "fr079/fr079.relations", ""),
                            load("mit-killian", logs + "mit-killian/mit-killian.reconstructed.clf.xz",
                                 logs + "mit-killian/mit-killian.relations", ""),
                            load("ring_A", sim + "ring_A.clf.xz", "", sim + "ring_A.truth.tum"),
                            load("ring_B", sim + "ring_B.clf.xz", "", sim + "ring_B.truth.tum")})
      for (const auto& variant : variants)
        for (int seed = 1; seed <= variant.seeds; ++seed) runOnce(log, variant, seed);
  } catch (const slam::core::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 3;
  }
  return 0;
}

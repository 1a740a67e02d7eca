// The main path's cost: casting (MRPT's own simulator beside ours), simulating, and every method per scan.
// ./bootstrap.sh bench --benchmark_format=json > benchmarks/results/main_path.json
#include <benchmark/benchmark.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>

#include <memory>

#include "libslam/buildings/generator.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/process/worker.h"
#include "libslam/rays/ray_caster.h"
#include "libslam/record/record.h"
#include "libslam/resources/resources.h"
#include "libslam/score/evaluate.h"
#include "libslam/testing/temp_folder.h"

namespace {
using namespace slam;

constexpr int kBeams = 541;
const double kFov_rad = core::degToRad(270), kMaxRange_m = 30;

const world::Plan& plan() {
  static const world::Plan office = world::loadPlan(resources::resolvePlan("office_loop"));
  return office;
}

/// Poses that a robot really visits: every tenth of a recording.
const std::vector<core::Pose2>& poses() {
  static const std::vector<core::Pose2> visited = [] {
    const testing::TempFolder folder;
    files::IniFile ini;
    ini.set("simulation", "duration_s", "300", "benchmark");
    std::vector<core::Pose2> result;
    record::record(plan(), record::readRecordConfig(ini), 1, folder / "run.rawlog", {},
                   core::silentProgress());
    const auto truth = logs::readTum(folder / "run.gt.tum");
    for (size_t i = 0; i < truth.size(); i += 10) result.push_back(truth[i].pose);
    return result;
  }();
  return visited;
}

void castOurs(benchmark::State& state) {
  const rays::BeamTable beams(-kFov_rad / 2, kFov_rad / (kBeams - 1), kBeams);
  std::vector<float> ranges;
  size_t i = 0;
  for (auto _ : state) {
    rays::castScan(plan(), poses()[i++ % poses().size()], beams, kMaxRange_m, ranges);
    benchmark::DoNotOptimize(ranges.data());
  }
  state.counters["Mrays/s"] =
      benchmark::Counter(double(state.iterations()) * kBeams / 1e6, benchmark::Counter::kIsRate);
}
BENCHMARK(castOurs)->Name("cast/exact reference")->MinTime(0.5);

void castMrpt(benchmark::State& state) {
  mrpt::maps::COccupancyGridMap2D grid(0, float(plan().columns * plan().resolution_m), 0,
                                       float(plan().rows * plan().resolution_m), float(plan().resolution_m));
  for (int y = 0; y < plan().rows; ++y)
    for (int x = 0; x < plan().columns; ++x)
      grid.setCell(x, y, plan().at(x, y) == world::Cell::kOccupied ? 0.01F : 0.99F);
  mrpt::obs::CObservation2DRangeScan scan;
  scan.aperture = float(kFov_rad);
  scan.maxRange = float(kMaxRange_m);
  size_t i = 0;
  for (auto _ : state) {
    const auto& pose = poses()[i++ % poses().size()];
    const auto local = core::between(plan().T_frame_raster, pose);
    grid.laserScanSimulator(scan, {local.x, local.y, local.phi}, 0.5F, kBeams, 0);
    benchmark::DoNotOptimize(scan.getScanRange(0));
  }
  state.counters["Mrays/s"] =
      benchmark::Counter(double(state.iterations()) * kBeams / 1e6, benchmark::Counter::kIsRate);
}
BENCHMARK(castMrpt)->Name("cast/MRPT laserScanSimulator (approximate)")->MinTime(0.5);

/// Truth, odometry and a scan with noise per step, without a file. 361 beams over 180 degrees.
void senseOnly(benchmark::State& state) {
  lidar::LidarOptions lidar;
  lidar.fov_rad = core::kPi;
  lidar.beams = 361;
  const auto start = world::findStartPose(plan(), 0.5);
  sim::Simulator simulator(plan(), {}, lidar, {}, *start, 1);
  for (auto _ : state) {
    const auto sensed = simulator.step({0, 0.5, 0.1});
    benchmark::DoNotOptimize(sensed.scan.ranges_m.data());
  }
  state.counters["scans/s"] = benchmark::Counter(double(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(senseOnly)->Name("simulate, 361 beams with noise, no file")->MinTime(0.5);

void simulateAnHour(benchmark::State& state) {
  const testing::TempFolder folder;
  files::IniFile ini;
  for (const auto& [key, value] : {std::pair{"rate_hz", "10"}, std::pair{"beams", "361"}})
    ini.set("lidar", key, value, "benchmark");
  ini.set("simulation", "duration_s", "3600", "benchmark");
  const auto config = record::readRecordConfig(ini);
  buildings::BuildingOptions options;
  options.width_m = options.height_m = 100;
  const world::Plan building = buildings::generateBuilding("office", options, 1).plan;
  double scans = 0;
  for (auto _ : state)
    scans +=
        double(record::record(building, config, 1, folder / "run.rawlog", {}, core::silentProgress()).scans);
  state.counters["scans/s"] = benchmark::Counter(scans, benchmark::Counter::kIsRate);
}
BENCHMARK(simulateAnHour)
    ->Name("an hour at 10 Hz in an office of 100 x 100 m, 361 beams, written")
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

void simulate(benchmark::State& state) {
  const testing::TempFolder folder;
  files::IniFile ini;
  ini.set("simulation", "duration_s", "120", "benchmark");
  const auto config = record::readRecordConfig(ini);
  double simulated_s = 0, scans = 0;
  for (auto _ : state) {
    const auto recording =
        record::record(plan(), config, 1, folder / "run.rawlog", {}, core::silentProgress());
    simulated_s += recording.duration_s;
    scans += double(recording.scans);
  }
  state.counters["simulated_s/s"] = benchmark::Counter(simulated_s, benchmark::Counter::kIsRate);
  state.counters["scans/s"] = benchmark::Counter(scans, benchmark::Counter::kIsRate);
}
BENCHMARK(simulate)->Name("simulate and write a rawlog, 541 beams")->Unit(benchmark::kMillisecond);

void mapWith(benchmark::State& state, const std::string& method) {
  const testing::TempFolder folder;
  files::IniFile ini;
  ini.set("simulation", "duration_s", "60", "benchmark");
  record::record(plan(), record::readRecordConfig(ini), 1, folder / "run.rawlog", {}, core::silentProgress());
  // A process of its own, so that the memory is the method's alone.
  for (auto _ : state)
    process::runWorker(
        {RASTERSLAM_PROGRAM, "run", method, folder / "run.rawlog", "-o", folder / "out", "--overwrite", "-q"},
        core::silentProgress());
  const results::Cost cost = results::loadRun(folder / "out").cost;
  state.counters["ms/scan"] = cost.mean_ms_per_scan;
  state.counters["p99 ms"] = cost.p99_ms_per_scan;
  state.counters["x real time"] = cost.real_time_factor;
  state.counters["peak MB"] = cost.peak_memory_mb;
}

}  // namespace

int main(int argc, char** argv) {
  for (const auto& method : resources::namesInFolder(resources::configsFolder() + "/methods", ".ini"))
    benchmark::RegisterBenchmark(("map/" + method).c_str(), mapWith, method)
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}

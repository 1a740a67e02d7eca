// Whole scans cast by the exact reference, the sector table and MRPT's laserScanSimulator at the same random
// free poses of the committed worlds; and what the table costs to make.
//   rasterslam_casting_bench --benchmark_enable_random_interleaving=true --benchmark_repetitions=5
#include <benchmark/benchmark.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <string>
#include <vector>

#include "libslam/core/random.h"
#include "libslam/world/plan.h"
#include "libslam/world/ray_caster.h"
#include "libslam/world/sector_caster.h"

namespace {
using namespace slam;

constexpr int kBeams = 1080, kPoses = 200;
constexpr double kFirstAngle_rad = -core::kPi, kStep_rad = 2 * core::kPi / kBeams;
const world::BeamTable kTable(kFirstAngle_rad, kStep_rad, kBeams);

struct Scene {
  world::Plan plan;
  std::vector<core::Pose2> poses;
  world::SectorCaster caster, portable;

  explicit Scene(const std::string& name)
      : plan(world::loadPlan(RASTERSLAM_SOURCE_DIR "/datasets/worlds/" + name + ".yaml")),
        caster(plan),
        portable(plan, world::Instructions::kPortable) {
    core::RandomStream random(1, "casting benchmark");
    while (poses.size() < kPoses) {
      const core::Point2 cell{random.uniform(0, plan.columns), random.uniform(0, plan.rows)};
      const core::Point2 p = world::cellsToWorld(plan, cell);
      if (!world::discCollides(plan, p, 0.1))
        poses.push_back({p.x, p.y, random.uniform(-core::kPi, core::kPi)});
    }
  }
  core::Pose2 inPlan(const core::Pose2& pose) const { return core::between(plan.T_world_plan, pose); }
};

mrpt::maps::COccupancyGridMap2D mrptGrid(const world::Plan& plan) {
  mrpt::maps::COccupancyGridMap2D grid(0, float(plan.columns * plan.resolution_m), 0,
                                       float(plan.rows * plan.resolution_m), float(plan.resolution_m));
  for (int y = 0; y < plan.rows; ++y)
    for (int x = 0; x < plan.columns; ++x)
      grid.setCell(x, y, plan.at(x, y) == world::Cell::kOccupied ? 0.01F : 0.99F);
  return grid;
}

void countRays(benchmark::State& state) {
  state.counters["Mrays/s"] =
      benchmark::Counter(double(state.iterations()) * kBeams / 1e6, benchmark::Counter::kIsRate);
}

void castReference(benchmark::State& state, const Scene& scene) {
  std::vector<float> ranges;
  size_t i = 0;
  for (auto _ : state) {
    world::castScan(scene.plan, scene.poses[i++ % kPoses], kTable, 0, ranges);
    benchmark::DoNotOptimize(ranges.data());
  }
  countRays(state);
}

void castSectors(benchmark::State& state, const world::SectorCaster& caster, const Scene& scene) {
  std::vector<float> ranges;
  size_t i = 0;
  for (auto _ : state) {
    caster.castScan(scene.poses[i++ % kPoses], kTable, 0, ranges);
    benchmark::DoNotOptimize(ranges.data());
  }
  countRays(state);
}

/// MRPT gives up at 0.8 of the maximum range: with this one no wall of the plan is beyond it. Its error
/// against the reference is over the beams on which both see a wall.
void castMrpt(benchmark::State& state, const Scene& scene) {
  const auto grid = mrptGrid(scene.plan);
  mrpt::obs::CObservation2DRangeScan scan;
  scan.aperture = float(kStep_rad * (kBeams - 1));  // from its first beam to its last
  scan.maxRange = float(2 * std::hypot(scene.plan.columns, scene.plan.rows) * scene.plan.resolution_m);
  const auto cast = [&](const core::Pose2& pose) {
    const core::Pose2 local = scene.inPlan(pose);
    grid.laserScanSimulator(scan, {local.x, local.y, local.phi}, 0.5F, kBeams, 0);
  };
  size_t i = 0;
  for (auto _ : state) {
    cast(scene.poses[i++ % kPoses]);
    benchmark::DoNotOptimize(scan.getScanRange(0));
  }
  countRays(state);

  std::vector<float> exact;
  double sum_m = 0;
  int beams = 0;
  for (const core::Pose2& pose : scene.poses) {
    cast(pose);
    world::castScan(scene.plan, pose, {-scan.aperture / 2.0, kStep_rad, kBeams}, 0, exact);
    for (size_t beam = 0; beam < exact.size(); ++beam) {
      if (!scan.getScanRangeValidity(beam) || !std::isfinite(exact[beam])) continue;
      sum_m += std::abs(scan.getScanRange(beam) - exact[beam]);
      ++beams;
    }
  }
  state.counters["mean error in cells"] = sum_m / beams / scene.plan.resolution_m;
}

/// The share of a cast that is sine and cosine, which exactness takes from the reference.
void onlyDirections(benchmark::State& state) {
  double angle_rad = -core::kPi;
  for (auto _ : state)
    for (int i = 0; i < kBeams; ++i) {
      angle_rad = kFirstAngle_rad + i * kStep_rad;
      benchmark::DoNotOptimize(std::cos(angle_rad) + std::sin(angle_rad));
    }
  countRays(state);
}

void makeTable(benchmark::State& state, const Scene& scene) {
  for (auto _ : state) {
    const world::SectorCaster caster(scene.plan);
    benchmark::DoNotOptimize(&caster);
  }
  const double megacells = double(scene.plan.cells.size()) / 1e6;
  state.counters["Mcells"] = megacells;
  state.counters["s/Mcell"] = benchmark::Counter(double(state.iterations()) * megacells,
                                                 benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

}  // namespace

int main(int argc, char** argv) {
  std::deque<Scene> scenes;
  for (const std::string world : {"corridor", "flat", "maze", "office_loop", "pillar_hall"}) {
    const Scene& scene = scenes.emplace_back(world);
    const auto add = [&](const std::string& name, auto function) {
      benchmark::RegisterBenchmark((world + "/" + name).c_str(), [=, &scene](auto& state) {
        function(state, scene);
      })->Unit(benchmark::kMicrosecond);
    };
    add("exact reference", castReference);
    add("sector table", [](auto& state, const Scene& s) { castSectors(state, s.caster, s); });
    add("sector table, portable", [](auto& state, const Scene& s) { castSectors(state, s.portable, s); });
    add("MRPT laserScanSimulator (approximate)", castMrpt);
    add("make the sector table", makeTable);
  }
  benchmark::RegisterBenchmark("sine and cosine alone", onlyDirections)->Unit(benchmark::kMicrosecond);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}

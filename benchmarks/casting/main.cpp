// Whole scans cast by MRPT's laserScanSimulator, the exact reference and our sector table, on every
// instruction set of this processor, at the same random free poses: who is how fast and how exact.
//   rasterslam_casting_bench [--data FOLDER] [--plan FILE ...] [--rounds N] [--compare RAYS] [--csv FILE]
// One thread but for the last column. In every round each engine casts the same 200 scans, one engine after
// the other in an order that turns with the rounds; times are of the thread's CPU clock; the figures are
// medians over the rounds, and so are the ratios, each of one round. So what else the machine does weighs on
// all engines alike.
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include "libslam/buildings/generator.h"
#include "libslam/core/error.h"
#include "libslam/core/middle_value.h"
#include "libslam/core/random.h"
#include "libslam/files/files.h"
#include "libslam/rays/ray_caster.h"
#include "libslam/rays/sector_caster.h"
#include "libslam/table/table.h"
#include "libslam/threads/cpu_time.h"
#include "libslam/world/plan.h"

namespace {
using namespace slam;

constexpr int kBeams = 1080, kPoses = 1000, kPosesPerRound = 200;
constexpr double kFirstAngle_rad = -core::kPi, kStep_rad = 2 * core::kPi / kBeams;

struct Arguments {
  std::string data = "../shared/data", csv;
  std::vector<std::string> plans;
  int rounds = 25;
  double compare_rays = 1e6;
};

std::vector<core::Pose2> freePoses(const world::Plan& plan, int count, const std::string& stream) {
  core::RandomStream random(1, stream);
  std::vector<core::Pose2> poses;
  while (static_cast<int>(poses.size()) < count) {
    const core::Point2 cell{random.uniform(0, plan.columns), random.uniform(0, plan.rows)};
    const core::Point2 p = world::cellsToPoint(plan, cell);
    const auto at = plan.at(static_cast<int>(cell.x), static_cast<int>(cell.y));
    if (at == world::Cell::kFree && !world::discCollides(plan, p, 0.1))
      poses.push_back({p.x, p.y, random.uniform(-core::kPi, core::kPi)});
  }
  return poses;
}

/// MRPT's simulator in the plan. It gives up at 0.8 of the maximum range: with the one set here no wall is
/// beyond.
class MrptEngine {
 public:
  explicit MrptEngine(const world::Plan& plan)
      : plan_(plan),
        grid_(0, float(plan.columns * plan.resolution_m), 0, float(plan.rows * plan.resolution_m),
              float(plan.resolution_m)) {
    for (int y = 0; y < plan.rows; ++y)
      for (int x = 0; x < plan.columns; ++x)
        grid_.setCell(x, y, plan.at(x, y) == world::Cell::kOccupied ? 0.01F : 0.99F);
    scan_.aperture = float(kStep_rad * (kBeams - 1));  // from its first beam to its last
    scan_.maxRange = float(2 * std::hypot(plan.columns, plan.rows) * plan.resolution_m);
  }
  const mrpt::obs::CObservation2DRangeScan& cast(const core::Pose2& pose) {
    const core::Pose2 local = core::between(plan_.T_frame_raster, pose);
    grid_.laserScanSimulator(scan_, {local.x, local.y, local.phi}, 0.5F, kBeams, 0);
    return scan_;
  }
  double firstAngle() const { return -scan_.aperture / 2.0; }

 private:
  const world::Plan& plan_;
  mrpt::maps::COccupancyGridMap2D grid_;
  mrpt::obs::CObservation2DRangeScan scan_;
};

/// Over the beams on which both see a wall.
struct MrptError {
  double mean_cells = 0, beyond_two_cells_percent = 0;
};

MrptError mrptError(const world::Plan& plan, const rays::SectorCaster& exact, MrptEngine& mrpt,
                    const std::vector<core::Pose2>& poses) {
  const rays::BeamTable beams(mrpt.firstAngle(), kStep_rad, kBeams);
  std::vector<float> ranges;
  double sum = 0, far = 0, count = 0;
  for (const core::Pose2& pose : poses) {
    const auto& scan = mrpt.cast(pose);
    exact.castScan(pose, beams, 0, ranges);
    for (size_t i = 0; i < ranges.size(); ++i) {
      if (!scan.getScanRangeValidity(i) || !std::isfinite(ranges[i])) continue;
      const double error = std::abs(scan.getScanRange(i) - ranges[i]) / plan.resolution_m;
      sum += error;
      far += error > 2;
      ++count;
    }
  }
  return {sum / count, 100 * far / count};
}

/// Rays on which an engine's bits differ from the reference's, half of them with a maximum range.
double differences(const world::Plan& plan, const std::vector<rays::SectorCaster>& casters, double& rays) {
  const int scans = static_cast<int>(std::ceil(rays / kBeams));
  const auto poses = freePoses(plan, scans, "comparison");
  core::RandomStream random(1, "maximum range");
  const rays::BeamTable beams(kFirstAngle_rad, kStep_rad, kBeams);
  std::vector<float> expected, found;
  double count = 0;
  for (int i = 0; i < scans; ++i) {
    const double max_range_m = i % 2 == 0 ? 0 : random.uniform(0.1, 30);
    rays::castScan(plan, poses[static_cast<size_t>(i)], beams, max_range_m, expected);
    for (const auto& caster : casters) {
      caster.castScan(poses[static_cast<size_t>(i)], beams, max_range_m, found);
      for (size_t k = 0; k < found.size(); ++k)
        count += std::memcmp(&found[k], &expected[k], sizeof(float)) != 0;
    }
  }
  rays = double(scans) * kBeams;
  return count;
}

double makingSecondsPerMegacell(const world::Plan& plan) {
  std::vector<double> seconds;
  for (int i = 0; i < 9; ++i) {
    const double before = threads::cpuSeconds();
    const rays::SectorTable table(plan);
    seconds.push_back(threads::cpuSeconds() - before);
  }
  return core::middleValue(seconds) / (double(plan.cells.size()) / 1e6);
}

/// Wall time of a batch with one thread over that with two.
double speedUpOfTwoThreads(const rays::SectorCaster& caster, const std::vector<core::Pose2>& poses) {
  const rays::BeamTable beams(kFirstAngle_rad, kStep_rad, kBeams);
  std::vector<float> ranges;
  const auto seconds = [&](int threads) {
    const auto before = std::chrono::steady_clock::now();
    for (int i = 0; i < 4; ++i) caster.castScans(poses, beams, 0, threads, ranges);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
  };
  std::vector<double> ratios;
  for (int i = 0; i < 15; ++i) {
    const double one = seconds(1);
    ratios.push_back(one / seconds(2));
  }
  return core::middleValue(ratios);
}

struct Engine {
  std::string name;
  std::function<void(const core::Pose2&)> cast;
  std::vector<double> seconds, ratios;  ///< per scan; MRPT's over this engine's in the same round
};

void addRows(const world::Plan& plan, const Arguments& arguments, table::Table& table) {
  const auto poses = freePoses(plan, kPoses, "casting benchmark");
  const rays::BeamTable beams(kFirstAngle_rad, kStep_rad, kBeams);
  std::vector<float> ranges;
  MrptEngine mrpt(plan);
  std::vector<rays::SectorCaster> casters;
  casters.reserve(3);
  std::vector<Engine> engines;
  engines.push_back({"MRPT laserScanSimulator", [&](const core::Pose2& pose) { mrpt.cast(pose); }, {}, {}});
  engines.push_back({"exact walk (reference)",
                     [&](const core::Pose2& pose) { rays::castScan(plan, pose, beams, 0, ranges); },
                     {},
                     {}});
  for (const auto& [name, instructions] : {std::pair{"sector table, portable", rays::Instructions::kPortable},
                                           std::pair{"sector table, AVX2", rays::Instructions::kAvx2},
                                           std::pair{"sector table, AVX-512", rays::Instructions::kAvx512}}) {
    if (!rays::isSupported(instructions)) continue;
    casters.emplace_back(plan, instructions);
    const rays::SectorCaster* caster = &casters.back();
    engines.push_back(
        {name,
         [&beams, &ranges, caster](const core::Pose2& pose) { caster->castScan(pose, beams, 0, ranges); },
         {},
         {}});
  }
  for (int round = 0; round < arguments.rounds; ++round) {
    std::vector<double> seconds(engines.size());
    for (size_t turn = 0; turn < engines.size(); ++turn) {
      const size_t which = (turn + static_cast<size_t>(round)) % engines.size();
      const double before = threads::cpuSeconds();
      for (int i = 0; i < kPosesPerRound; ++i)
        engines[which].cast(poses[static_cast<size_t>(round * kPosesPerRound + i) % poses.size()]);
      seconds[which] = (threads::cpuSeconds() - before) / kPosesPerRound;
    }
    for (size_t i = 0; i < engines.size(); ++i) {
      engines[i].seconds.push_back(seconds[i]);
      engines[i].ratios.push_back(seconds[0] / seconds[i]);
    }
  }
  double rays = arguments.compare_rays;
  const double kNothing = std::nan("");
  const double different = differences(plan, casters, rays);
  const MrptError error = mrptError(plan, casters.front(), mrpt, poses);
  const double making_ms = 1e3 * makingSecondsPerMegacell(plan);
  const double two_threads = speedUpOfTwoThreads(casters.back(), poses);
  const std::string size = std::to_string(plan.columns) + " x " + std::to_string(plan.rows);
  for (size_t i = 0; i < engines.size(); ++i) {
    const bool is_mrpt = i == 0, is_table = i >= 2, is_fastest = i + 1 == engines.size();
    table.rows.push_back({plan.name, size, engines[i].name,
                          kBeams / core::middleValue(engines[i].seconds) / 1e6,
                          core::middleValue(engines[i].ratios), is_mrpt ? error.mean_cells : 0.0,
                          is_mrpt ? error.beyond_two_cells_percent : 0.0, is_table ? rays / 1e6 : kNothing,
                          is_table ? different : kNothing, is_table ? making_ms : kNothing,
                          is_fastest ? two_threads : kNothing});
  }
  std::fprintf(stderr, "%s done\n", plan.name.c_str());
}

int benchmark(const Arguments& arguments) {
  std::vector<std::string> plans = arguments.plans;
  if (plans.empty()) {
    for (const char* name : {"flat", "office_loop", "pillar_hall", "maze", "corridor"})
      plans.push_back(std::string(RASTERSLAM_SOURCE_DIR "/datasets/worlds/") + name + ".yaml");
    for (const char* name : {"willow/willow-full.yaml", "turtlebot3/map.yaml", "nav2/depot.yaml"}) {
      const std::string path = arguments.data + "/worlds/" + name;
      if (std::filesystem::exists(path))
        plans.push_back(path);
      else
        std::fprintf(stderr, "not there, skipped: %s\n", path.c_str());
    }
  }
  table::Table table;
  table.columns = {{"plan", "plan", 0},
                   {"cells", "cells", 0},
                   {"engine", "engine", 0},
                   {"mrays_per_s", "Mrays/s", 1},
                   {"times_mrpt", "x MRPT", 2},
                   {"error_cells", "mean error (cells)", 2},
                   {"beyond_two_cells_percent", "over 2 cells (%)", 1},
                   {"compared_mrays", "compared (Mrays)", 1},
                   {"bits_differ", "rays that differ", 0},
                   {"making_ms_per_megacell", "making (ms/Mcell)", 2},
                   {"two_threads", "2 threads", 2}};
  for (const auto& path : plans) addRows(world::loadPlan(path), arguments, table);
  if (arguments.plans.empty())
    for (const auto& kind : buildings::buildingKinds()) {
      buildings::BuildingOptions options;
      options.width_m = 100;
      options.height_m = 80;
      world::Plan plan = buildings::generateBuilding(kind.name, options, 1).plan;
      plan.name = kind.name + " 100 x 80 m";
      addRows(plan, arguments, table);
    }
  std::cout << table::toText(table);
  if (!arguments.csv.empty()) files::writeFileAtomically(arguments.csv, table::toCsv(table));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app{"Times whole-scan ray casting: MRPT, the exact walk, the sector table"};
  app.add_option("--data", arguments.data, "a folder with worlds/")->capture_default_str();
  app.add_option("--plan", arguments.plans, "plans instead of the usual ones");
  app.add_option("--rounds", arguments.rounds)->capture_default_str()->check(CLI::PositiveNumber);
  app.add_option("--compare", arguments.compare_rays, "rays compared with the reference")
      ->capture_default_str();
  app.add_option("--csv", arguments.csv, "write the table here too");
  CLI11_PARSE(app, argc, argv);
  try {
    return benchmark(arguments);
  } catch (const std::exception& error) {
    std::cerr << "rasterslam_casting_bench: " << error.what() << "\n";
    return 1;
  }
}

// rasterslam_finished_cells SUITE.ini FOLDER: a sweep's folder in which every cell is complete, with invented
// figures, to measure what listing, resuming and merging cost by themselves.
#include <cstdio>
#include <exception>
#include <filesystem>

#include "libslam/core/random.h"
#include "libslam/files/files.h"
#include "libslam/resources/file_hash.h"
#include "libslam/score/evaluate.h"
#include "libslam/score/metric_infos.h"
#include "libslam/sweep/cell.h"
#include "libslam/sweep/sweep.h"

namespace {
using namespace slam;

void finish(const std::string& folder, const std::string& id, const std::string& spec, bool is_run) {
  const std::string cell = folder + "/cells/" + id;
  std::filesystem::create_directories(cell + "/run");
  files::writeFileAtomically(cell + "/cell.json", spec);
  sweep::CellResult result;
  result.id = id;
  core::RandomStream random(1, id);
  // As many figures and files as a real run has.
  for (const auto& info : score::metricInfos())
    if (is_run) result.figures.emplace_back(info.key, random.uniform());
  for (const char* name : {"run/trajectory.tum", "run/map.png", "run/map.yaml", "run/journal.csv"}) {
    const std::string text(1000, 'x');
    files::writeFileAtomically(cell + "/" + name, text);
    result.files[name] = {text.size(), resources::sha256(text)};
  }
  sweep::writeCellResult(cell, result, {});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: rasterslam_finished_cells SUITE.ini FOLDER\n");
    return 2;
  }
  try {
    const auto sweep = sweep::planSweep(std::string(argv[1]));
    sweep::SweepRequest request;
    request.output = argv[2];
    sweep::prepareSweepFolder(sweep, request, {});
    for (std::size_t i = 0; i < sweep.plan.logs.size(); ++i)
      finish(argv[2], sweep.plan.logs[i].id, sweep.log_specs[i], false);
    for (std::size_t i = 0; i < sweep.plan.runs.size(); ++i)
      finish(argv[2], sweep.plan.runs[i].id, sweep.run_specs[i], true);
    std::printf("%zu logs, %zu runs\n", sweep.plan.logs.size(), sweep.plan.runs.size());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rasterslam_finished_cells: %s\n", error.what());
    return 1;
  }
}

#include "libslam/sweep/sweep.h"

#include <algorithm>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/sweep/sweep_runner.h"
#include "libslam/sweep/sweep_workplace.h"

namespace slam::sweep {
namespace fs = std::filesystem;
namespace {

/// A folder in which a sweep was begun that broke off, on a full disk, say, before it had written its plan.
bool isJustBegun(const std::string& output) {
  const fs::path cells = fs::path(output) / "cells";
  if (!fs::is_directory(cells) || !fs::is_empty(cells)) return false;
  return std::all_of(fs::directory_iterator(output), fs::directory_iterator(), [](const auto& entry) {
    const auto name = entry.path().filename();
    return name == "cells" || name == "partial" || name == "suite.ini";
  });
}

void prepare(const Sweep& sweep, const SweepRequest& request) {
  const std::string& output = request.output;
  if (fs::exists(output) && !fs::is_directory(output))
    throw core::InputError(output + ": is a file, expected a folder");
  const bool is_ours = fs::exists(output + "/plan.json");
  if (fs::exists(output) && !fs::is_empty(output) && !is_ours && !fs::exists(output + "/partial") &&
      !isJustBegun(output))
    throw core::InputError(output +
                           ": holds other files and no plan.json, so it is not replaced; remove it first");
  if (is_ours && !request.overwrite && !request.resume)
    throw core::InputError(output + ": exists; give --overwrite to replace it or --resume to go on");
  if (is_ours && request.overwrite) {
    std::error_code error;
    fs::remove_all(output, error);
    if (error) throw core::IoError(output + ": cannot be removed: " + error.message());
  }
  makeFolder(output);
  makeFolder(output + "/cells");
  if (!is_ours || request.overwrite || !request.only_cell.empty()) return;
  const auto there = readSweepPlan(output + "/plan.json");
  if (there.code != sweep.plan.code)
    throw core::InputError(output + ": was begun by " + there.code + ", this program is " + sweep.plan.code +
                           "; give --overwrite, or another folder");
  if (request.of > 1 && !areSame(there, sweep.plan))
    throw core::InputError(output + ": holds another sweep than " + sweep.suite.path +
                           "; its parts must be of one suite");
}

void publishPlan(const Workplace& workplace, const Sweep& sweep, const SweepRequest& request,
                 const resources::Manifest& manifest) {
  workplace.publish("suite.ini", sweep.suite.text, request.output);
  workplace.publish("plan.json", toJson(sweep.plan, request.output), request.output);
  resources::writeManifest(manifest, workplace.path() + "/manifest.json");
  fs::rename(workplace.path() + "/manifest.json", request.output + "/manifest.json");
}

}  // namespace

std::string reproduceLine(const std::string& id) {
  return "rasterslam bench exec suite.ini --cell " + id + " -o again";
}

void prepareSweepFolder(const Sweep& sweep, const SweepRequest& request,
                        const resources::Manifest& manifest) {
  prepare(sweep, request);
  const Workplace workplace(request.output);
  publishPlan(workplace, sweep, request, manifest);
}

SweepOutcome sweep(const Sweep& sweep, const SweepRequest& request, const resources::Manifest& manifest,
                   core::Progress& progress) {
  prepare(sweep, request);
  const Workplace workplace(request.output);
  workplace.removeLeftovers();
  publishPlan(workplace, sweep, request, manifest);
  return SweepRunner(sweep, request, workplace).go(progress);
}

}  // namespace slam::sweep

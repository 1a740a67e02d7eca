#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/resources/manifest.h"
#include "libslam/results/cost.h"
#include "libslam/results/pose_covariances.h"
#include "libslam/results/relative_covariances.h"
#include "libslam/world/cell_map.h"

namespace slam::results {

/// A folder that buildMap() wrote, read back.
struct RunFolder {
  std::string path, method;
  core::Trajectory estimate;  ///< online
  std::optional<core::Trajectory> final_estimate;
  std::vector<StampedCovariance>
      covariances;  ///< of `estimate`, pose by pose; empty where the method gives none
  std::vector<StampedCovariance> final_covariances;  ///< the same of `final_estimate`
  std::vector<RelativeCovariance> relative_covariances;
  world::CellMap map;  ///< in the map frame
  resources::Manifest manifest;
  Cost cost;
};
/// Errors: InputError naming the file that is missing or broken.
RunFolder loadRun(const std::string& folder);
/// The log that a run was made from, as its manifest names it: of older ones the input that is no map,
/// configuration or plan. "" where there is none.
std::string logInput(const resources::Manifest& manifest);

/// A number among a run's results. Errors: InputError that names the key, where it is missing; NaN where it
/// is no number.
double resultOf(const resources::Manifest& manifest, const std::string& key, const std::string& folder);
/// The same of a figure that not every run has: NaN where it is missing.
double resultIfThere(const resources::Manifest& manifest, const std::string& key);

}  // namespace slam::results

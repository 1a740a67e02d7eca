#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/explore/explore.h"
#include "libslam/files/ini.h"
#include "libslam/record/step_observer.h"
#include "libslam/world/plan.h"

namespace slam::explore {

/// What one run of the closed loop leaves besides its files.
struct LoopResult {
  Exploration exploration;
  std::vector<metrics::CoveragePoint> curve;
  bool plan_is_open = false;         ///< explorable space reaches the picture's edge
  bool saw_nothing = false;          ///< no scan had a single return
  std::vector<std::string> carries;  ///< when the robot was kidnapped, for people
};

/// The SLAM method of an exploration.
struct LoopMethod {
  std::string name;
  files::IniFile config;
  bool is_reference = false;  ///< localised by the truth
};

/// Runs the loop once. `folder` (existing) gets the run's files, see explore(); "" writes none. Errors:
/// InputError (start, configuration), MethodError (the method failed at the first scan). One that fails later
/// ends the run with ExplorationEnd::kFailed; the folder holds what it had mapped.
LoopResult exploreOnce(const world::Plan& given_plan, const ExploreConfig& config, const LoopMethod& method,
                       std::uint64_t seed, const std::string& folder, resources::Manifest manifest,
                       core::Progress& progress, record::StepObserver* observer = nullptr);

}  // namespace slam::explore

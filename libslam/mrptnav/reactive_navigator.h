#pragma once
#include <memory>
#include <string>

#include "libslam/core/parameters.h"
#include "libslam/navigate/goal_navigator.h"

namespace slam::mrptnav {

/// Section [mrpt_reactive].
struct ReactiveOptions {
  std::string config;   ///< MRPT's reactive2d_config.ini, or one like it
  double clearance_m;   ///< added all round the footprint's circle for MRPT's collision check
  double look_ahead_m;  ///< MRPT's ref_distance: obstacles and paths up to there count
  double give_up_s;     ///< without coming nearer to the goal
  ReactiveOptions();
  static const core::ParameterTable<ReactiveOptions>& table();
};

/// False when the program was built without MRPT's module nav (Debian: libmrpt-nav-dev).
bool reactiveNavigationAvailable();

/// MRPT's own mrpt::nav::CReactiveNavigationSystem (Blanco, Gonzalez and Fernandez-Madrigal, "Extending obstacle
/// avoidance methods through multiple parameter-space transformations", Autonomous Robots 24(1), 2008) as a goal
/// navigator, with trajectory families, scores and holonomic method of MRPT's configuration file; robot shape (an
/// octagon around the footprint's circle), speeds and the two distances come from us.
///
/// Of `navigate_options` goal_tolerance_m, clearance_m (what earlier scans showed is remembered, as for the
/// other methods) and time_limit_s count. MRPT has no notion of "unreachable": it ends with kReached or kGaveUp.
/// Its clock (mrpt::Clock, which is one for the whole process) is set to the scan's stamp during the constructor
/// and next(), and put back; two navigators must not run in two threads at once. It prints nothing and leaves no
/// file behind (its collision grids go to a scratch folder that is removed at once). The same scans and poses give
/// the same commands.
///
/// Errors: not available, or the configuration cannot be read (InputError); goal not finite, period not positive
/// (ContractError). Cost: 0.1 to 0.6 s to build, about 1 ms per call.
std::unique_ptr<navigate::GoalNavigator> makeReactiveNavigator(
    const ReactiveOptions& options, const navigate::NavigateOptions& navigate_options,
    const navigate::GoalTask& task);

}  // namespace slam::mrptnav

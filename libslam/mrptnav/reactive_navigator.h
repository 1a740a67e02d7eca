#pragma once
#include <memory>
#include <string>

#include "libslam/files/parameters.h"
#include "libslam/goals/goal_navigator.h"

namespace slam::mrptnav {

/// Section [mrpt_reactive].
struct ReactiveOptions {
  std::string config;   ///< MRPT's reactive2d_config.ini, or one like it
  double clearance_m;   ///< added all round the footprint's circle for MRPT's collision check
  double look_ahead_m;  ///< MRPT's ref_distance: obstacles and paths up to there count
  double give_up_s;     ///< without coming nearer to the goal
  ReactiveOptions();
  static const files::ParameterTable<ReactiveOptions>& table();
};

/// False when the program was built without MRPT's module nav (Debian: libmrpt-nav-dev).
bool reactiveNavigationAvailable();

/// MRPT's own mrpt::nav::CReactiveNavigationSystem (Blanco, Gonzalez and Fernandez-Madrigal, "Extending
/// obstacle avoidance methods through multiple parameter-space transformations", Autonomous Robots 24(1),
/// 2008) as a goal navigator, through an adapter to mrpt::nav::CRobot2NavInterface. Path families, scores and
/// holonomic method are those of MRPT's configuration file; robot shape (an octagon around the footprint's
/// circle), speeds and look-ahead come from us. MRPT's target is the goal or, while that is out of its reach,
/// a point on the straight line there. What MRPT's paths cannot do, the adapter does: it turns in place
/// towards a goal far aside, and drives the last half metre straight where that is free.
///
/// It keeps GoalNavigator's promises (its commands are slowed down where MRPT would come too near), and knows
/// no "unreachable": a drive ends with kReached or kGaveUp. The robot's time is put on MRPT's clock
/// (mrpt::Clock, one for the whole process) during next() and taken off again: two such navigators must not
/// run in two threads at once. Prints nothing and leaves no file behind; MRPT's collision grids go through a
/// scratch folder. The same scans and poses give the same commands.
///
/// Errors: not available, or the configuration is missing or refused by MRPT (InputError); goal not finite,
/// period not positive (ContractError). Cost: about 1 s to build, 1 ms per call.
std::unique_ptr<goals::GoalNavigator> makeReactiveNavigator(const ReactiveOptions& options,
                                                            const goals::NavigateOptions& navigate_options,
                                                            const goals::GoalTask& task);

}  // namespace slam::mrptnav

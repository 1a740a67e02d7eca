#pragma once
#include <string>
#include <vector>

#include "apps/commands.h"
#include "apps/show.h"

namespace slam::apps {

struct ViewArguments {
  std::string input;  ///< plan, log or folder
  std::string method, slam = kExplorersSlam, log, plan, start = "auto", goal, commands;
  SimulationFlags simulation;
  std::vector<std::string> carries;
  ShowFlags show;
};

/// The commands of `rasterslam view`: each shows its work while it is done, and returns the exit code.
int viewSimulate(const Context& context, const ViewArguments& arguments);
int viewDrive(const Context& context, const ViewArguments& arguments);
int viewExplore(const Context& context, const ViewArguments& arguments);
int viewNavigate(const Context& context, const ViewArguments& arguments);
int viewRun(const Context& context, const ViewArguments& arguments);
int viewReplay(const Context& context, const ViewArguments& arguments);

}  // namespace slam::apps

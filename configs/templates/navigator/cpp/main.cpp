// @name@ [PLAN [X,Y [OUTPUT [SEED]]]]: drives to a goal, once by @name@ and once by tangent, scored on the
// true plan.
#include <cstdlib>
#include <exception>
#include <iostream>
#include <vector>

#include "@name@.h"
#include "libslam/resources/resources.h"
#include "libslam/world/plan.h"

int main(int argc, char** argv) try {
  setenv("RASTERSLAM_DATA", RASTERSLAM_DATA_FOLDER, 0);
  const auto word = [&](int i, const char* otherwise) { return std::string(i < argc ? argv[i] : otherwise); };
  slam::files::IniFile settings;
  settings.set("navigate", "time_limit_s", "300", "main.cpp");
  slam::reach::ReachGoalRequest request;
  request.config = slam::reach::readReachGoalConfig(settings);
  request.plan = slam::world::loadPlan(slam::resources::resolvePlan(word(1, "pillar_hall")));
  request.p_world_goal = slam::reach::parsePlace(word(2, "20,17"), "goal");
  request.output = word(3, "@name@_out");
  request.seed = std::strtoull(word(4, "1").c_str(), nullptr, 10);
  request.T_world_start = slam::reach::goalStart(request.plan, request.config, "auto");
  request.own = {ownNavigator()};
  request.methods = {"@name@", "tangent"};
  request.slam = "naive_flow";
  request.methods_folder = slam::resources::configsFolder() + "/methods";
  const auto result = slam::reach::reachGoal(request, {}, slam::core::silentProgress());
  std::cout << slam::table::toText(result.table) << "\npaths, states, logs: " << request.output << "\n";
  return 0;
} catch (const std::exception& error) {
  std::cerr << "@name@: " << error.what() << "\n";
  return 1;
}

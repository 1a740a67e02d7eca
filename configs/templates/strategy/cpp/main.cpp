// @name@ [PLAN [OUTPUT [SEED [SECONDS]]]]: lets a robot explore a plan, once by @name@ and once by
// nearest_frontier, scored on the true plan.
#include <cstdlib>
#include <exception>
#include <iostream>
#include <vector>

#include "@name@.h"
#include "libslam/resources/resources.h"

int main(int argc, char** argv) try {
  setenv("RASTERSLAM_DATA", RASTERSLAM_DATA_FOLDER, 0);
  const auto word = [&](int i, const char* otherwise) { return std::string(i < argc ? argv[i] : otherwise); };
  slam::files::IniFile settings;
  settings.set("simulation", "duration_s", word(4, "300"), "SECONDS");
  settings.set("strategy", "name", "nearest_frontier", "main.cpp");
  const auto theirs = slam::explore::readExploreConfig(settings);
  auto mine = theirs;
  mine.own = ownStrategy();

  slam::explore::ExploreRequest request;
  request.plan_path = slam::resources::resolvePlan(word(1, "flat"));
  request.strategies = {mine, theirs};
  request.slam = slam::explore::kTruthReference;  // strategies are compared here, not SLAM; "graph" is the real thing
  request.methods_folder = slam::resources::configsFolder() + "/methods";
  request.output = word(2, "@name@_out");
  request.seed = std::strtoull(word(3, "1").c_str(), nullptr, 10);
  const auto result = slam::explore::explore(request, {}, slam::core::silentProgress());
  std::cout << slam::table::toText(result.scores) << "\ncoverage.png, paths and logs: " << request.output << "\n";
  return result.failed;
} catch (const std::exception& error) {
  std::cerr << "@name@: " << error.what() << "\n";
  return 1;
}

// Exit code 0 when all holds. ctest --test-dir build
#include <cstdio>
#include <cstdlib>

#include "@name@.h"
#include "libslam/files/files.h"
#include "libslam/resources/resources.h"

namespace {

int failures = 0;
void expect(bool holds, const char* what) {
  if (!holds) std::printf("failed: %s\n", what), ++failures;
}

}  // namespace

int main() {
  setenv("RASTERSLAM_DATA", RASTERSLAM_DATA_FOLDER, 0);
  slam::files::IniFile settings;
  settings.set("simulation", "duration_s", "60", "test");
  settings.set("lidar", "beams", "181", "test");
  slam::explore::ExploreRequest request;
  request.plan_path = slam::resources::resolvePlan("flat");
  request.strategies = {slam::explore::readExploreConfig(settings)};
  request.strategies.front().own = ownStrategy();
  request.slam = slam::explore::kTruthReference;
  request.methods_folder = slam::resources::configsFolder() + "/methods";
  request.tables_only = true;
  const slam::files::ScratchFolder scratch;
  request.output = scratch / "out";
  const auto run = slam::explore::explore(request, {}, slam::core::silentProgress()).runs.front();
  expect(run.strategy == "@name@", "it is this strategy that ran");
  expect(run.collisions == 0, "no collision");
  expect(run.figures.coverage > 0.3, "a good part of the flat is explored within a minute");
  return failures;
}

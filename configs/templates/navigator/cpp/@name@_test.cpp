// Exit code 0 when all holds. ctest --test-dir build
#include <cstdio>
#include <cstdlib>

#include "@name@.h"

namespace {

int failures = 0;
void expect(bool holds, const char* what) {
  if (!holds) std::printf("failed: %s\n", what), ++failures;
}

/// A room of 5 x 3 m with a pillar between start and goal.
slam::world::Plan room() {
  slam::world::Plan plan;
  plan.name = "room";
  plan.columns = 100, plan.rows = 60;
  plan.cells.assign(6000, slam::world::Cell::kFree);
  const auto wall = [&](int x0, int y0, int x1, int y1) {
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) plan.cells[static_cast<std::size_t>(y * 100 + x)] = slam::world::Cell::kOccupied;
  };
  wall(0, 0, 100, 1), wall(0, 59, 100, 60), wall(0, 0, 1, 60), wall(99, 0, 100, 60), wall(48, 24, 54, 30);
  return plan;
}

}  // namespace

int main() {
  setenv("RASTERSLAM_DATA", RASTERSLAM_DATA_FOLDER, 0);
  slam::reach::ReachGoalRequest request;
  request.plan = room();
  request.T_world_start = {1, 1.5, 0};
  request.p_world_goal = {4, 1.5};
  slam::files::IniFile settings;
  settings.set("navigate", "time_limit_s", "60", "test");
  request.config = slam::reach::readReachGoalConfig(settings);
  request.own = {ownNavigator()};
  const auto run = slam::reach::driveToGoal(request, "@name@", slam::core::silentProgress());
  expect(run.status == slam::goals::GoalStatus::kReached, "it reaches a goal behind a pillar");
  expect(run.collisions == 0, "no collision");
  return failures;
}

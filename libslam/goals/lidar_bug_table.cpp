#include <algorithm>
#include <array>

#include "libslam/goals/lidar_bug.h"

namespace slam::goals {
namespace {

using State = LidarBugState;
using Event = LidarBugEvent;

struct StateRow {
  const char *name, *meaning;
};
// In the order of LidarBugState.
constexpr std::array<StateRow, kLidarBugStates> kStates = {{
    {"TURN TO GOAL", "turns in place until it faces the goal"},
    {"DRIVE FORWARD", "drives towards the goal"},
    {"DRIVE AT GOAL", "the goal is near: drives at it whatever stands beside"},
    {"AVOID TURN", "stopped before an obstacle: turns until the front is clear"},
    {"AVOID DRIVE", "drives on along the obstacle for a set distance"},
    {"WALL FOLLOW", "keeps the wall's distance by turning towards it or away"},
    {"OPEN TURN",
     "the wall has ended: turns until the front is clear (and is the goal's side: wall_end = goal)"},
    {"OPEN DRIVE", "drives on past the wall's end for a set distance"},
    {"STUCK LEAVE", "bumped: backs off from what is in front, advances from what is behind"},
    {"STUCK TURN", "turns in place, away from the bump"},
    {"STUCK RETURN", "tries to return to normal: drives on for a set distance"},
    {"STUCK CLEAR", "several bumps in a row: turns until the front is clear beyond a limit"},
    {"REACHED", "stands at the goal"},
    {"GAVE UP", "stands: the time is up, or there is no way"},
}};

// In the order of LidarBugEvent.
constexpr std::array<const char*, 16> kEvents = {"faces the goal",
                                                 "off course",
                                                 "goal near",
                                                 "goal no longer near",
                                                 "obstacle in range",
                                                 "front clear",
                                                 "driven on",
                                                 "sides open",
                                                 "bump",
                                                 "several bumps",
                                                 "moved away",
                                                 "turned away",
                                                 "returned",
                                                 "no clear front",
                                                 "goal reached",
                                                 "gave up"};

constexpr const char* kDifferences = R"(
## Where it differs from the description

| the description | ours | as described |
|---|---|---|
| stops when an obstacle is nearer than 0.22 m | 0.22 m, but at least what the robot's circle needs: 0.343 m for the default robot of 0.4 m | `--config configs/navigate/thesis.ini`: a robot that fits into 0.22 m |
| where the wall ends: stop, turn until the front is clear, drive on | turns on until the goal's side is clear | `--set lidar_bug.wall_end=front` (`thesis.ini` has it) |
| indices 0, 28, 68, 207, 247 of a scan of 275 readings | the same directions as angles; the nearest reading within 3 degrees, of any lidar | `thesis.ini` has the 275 readings |
| readings from the lidar | from the robot's centre, wherever the lidar is mounted | a lidar at the centre: the default |
| commands as they are | shortened where they would touch something | |
| goes on for ever | gives up: time limit, no valid reading, no clear front in a full turn | |
| several bumps in a row: turn until the front is clear beyond a limit | three bumps, half as far again as `clear_front_m` | `bumps_in_a_row`, `clear_front_m` |

Distances and angles that the description leaves open are rows of `[lidar_bug]`: `rasterslam navigate --print-config`. Every
transition, also several of one period, and the places projected in the five directions stand in `states.csv`.
)";

std::vector<LidarBugTransition> allTransitions() {
  std::vector<LidarBugTransition> rows = {
      {State::kTurnToGoal, Event::kFacingGoal, State::kDriveForward},
      {State::kTurnToGoal, Event::kGoalNear, State::kDriveAtGoal},
      {State::kDriveForward, Event::kGoalNear, State::kDriveAtGoal},
      {State::kDriveForward, Event::kObstacleInRange, State::kAvoidTurn},
      {State::kDriveForward, Event::kOffCourse, State::kTurnToGoal},
      {State::kDriveAtGoal, Event::kGoalFar, State::kTurnToGoal},
      {State::kAvoidTurn, Event::kFrontClear, State::kAvoidDrive},
      {State::kAvoidTurn, Event::kNoClearFront, State::kGaveUp},
      {State::kAvoidDrive, Event::kDrivenOn, State::kWallFollow},
      {State::kAvoidDrive, Event::kObstacleInRange, State::kAvoidTurn},
      {State::kWallFollow, Event::kGoalNear, State::kDriveAtGoal},
      {State::kWallFollow, Event::kObstacleInRange, State::kAvoidTurn},
      {State::kWallFollow, Event::kSidesOpen, State::kOpenTurn},
      {State::kOpenTurn, Event::kFrontClear, State::kOpenDrive},
      {State::kOpenTurn, Event::kNoClearFront, State::kGaveUp},
      {State::kOpenDrive, Event::kDrivenOn, State::kTurnToGoal},
      {State::kOpenDrive, Event::kObstacleInRange, State::kAvoidTurn},
      {State::kStuckLeave, Event::kMovedAway, State::kStuckTurn},
      {State::kStuckTurn, Event::kTurnedAway, State::kStuckReturn},
      {State::kStuckReturn, Event::kReturned, State::kTurnToGoal},
      {State::kStuckClear, Event::kFrontClear, State::kAvoidDrive},
      {State::kStuckClear, Event::kNoClearFront, State::kGaveUp},
  };
  for (const State driving : {State::kDriveForward, State::kDriveAtGoal, State::kAvoidDrive,
                              State::kWallFollow, State::kOpenDrive, State::kStuckReturn}) {
    rows.push_back({driving, Event::kBump, State::kStuckLeave});
    rows.push_back({driving, Event::kManyBumps, State::kStuckClear});
  }
  for (int i = 0; i < static_cast<int>(State::kReached); ++i) {
    rows.push_back({static_cast<State>(i), Event::kGoalReached, State::kReached});
    if (!std::any_of(rows.begin(), rows.end(), [i](const LidarBugTransition& row) {
          return row.from == static_cast<State>(i) && row.event == Event::kEnded;
        }))
      rows.push_back({static_cast<State>(i), Event::kEnded, State::kGaveUp});
  }
  return rows;
}

std::string identifier(State state) {
  std::string name = lidarBugStateName(state);
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

}  // namespace

const char* lidarBugStateName(State state) {
  return kStates[static_cast<size_t>(state)].name;
}

const char* lidarBugEventName(Event event) {
  return kEvents[static_cast<size_t>(event)];
}

const std::vector<LidarBugTransition>& lidarBugTransitions() {
  static const std::vector<LidarBugTransition> rows = allTransitions();
  return rows;
}

std::string lidarBugDiagram() {
  std::string text =
      "# The state machine of `lidar_bug`\n\n"
      "Made from the table of transitions in `lidar_bug.cpp`; a test keeps the two alike. From every state\n"
      "*goal reached* also leads to REACHED, and *gave up* (time limit, no valid reading, no way) to GAVE "
      "UP.\n"
      "\n"
      "```mermaid\nstateDiagram-v2\n    [*] --> " +
      identifier(State::kTurnToGoal) + "\n";
  for (const auto& row : lidarBugTransitions()) {
    if (row.event == Event::kGoalReached || row.event == Event::kEnded) continue;
    text += "    " + identifier(row.from) + " --> " + identifier(row.to) + ": " +
            lidarBugEventName(row.event) + "\n";
  }
  text += "    REACHED --> [*]\n    GAVE_UP --> [*]\n```\n\n| state | what it does |\n|---|---|\n";
  for (const auto& row : kStates) text += std::string("| ") + row.name + " | " + row.meaning + " |\n";
  return text + kDifferences;
}

}  // namespace slam::goals

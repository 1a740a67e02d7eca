#pragma once
#include <string>
#include <vector>

#include "libslam/explore/exploration_loop.h"
#include "libslam/teams/team.h"
#include "libslam/teams/team_loop.h"

namespace slam::teams {

/// "robot1", "robot2", ...: the folder of one, and its name in tables.
std::string robotName(std::size_t robot);

/// A row for each robot and the team's figures as notes.
table::Table teamTable(const TeamRequest& request, const TeamReport& report, const std::string& plan_name,
                       const std::string& slam);

/// All that exploreTeam() documents but the robots' own folders and the manifest, into an existing folder.
void writeTeam(TeamLoop& loop, const TeamRequest& request, const TeamReport& report,
               const std::vector<explore::LoopResult>& results, const world::Plan& plan,
               const std::string& folder);

}  // namespace slam::teams

#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libslam/explore/exploring_robot.h"
#include "libslam/navigate/right_of_way.h"
#include "libslam/teams/team.h"
#include "libslam/teams/team_radio.h"
#include "libslam/threads/thread_team.h"

namespace slam::teams {

/// The loop of exploreTeam(). Keeps references to all that it is given.
class TeamLoop {
 public:
  /// `folders`: one for each robot, "" = no files.
  TeamLoop(const world::Plan& plan, const TeamRequest& request, const explore::LoopMethod& method,
           const std::vector<core::Pose2>& T_world_starts, const std::vector<std::string>& folders);

  /// Errors: MethodError when every robot's method failed at the first scan.
  void run(core::Progress& progress);

  TeamScores scores() const;
  std::size_t size() const { return members_.size(); }
  explore::ExploringRobot& robot(std::size_t i) { return *members_[i].robot; }
  const std::vector<metrics::CoveragePoint>& curve() const { return curve_; }  ///< of the team
  /// After every scan, each robot's path.
  const std::vector<std::vector<double>>& paths_m() const { return paths_m_; }
  /// All maps as one, in the first robot's frame; robots whose map has come apart are left out.
  gridmap::OccupancyRaster mergedMap() const;
  metrics::SeenMask seen() const { return coverage_.seen(); }

 private:
  struct Member {
    std::unique_ptr<explore::ExploringRobot> robot;
    navigate::RightOfWay right_of_way;
    explore::Referee referee;
    robot::Command command{};
    std::vector<navigate::NeighbourRobot> neighbours{};  ///< places in the robot's frame until it is located
    std::shared_ptr<const gridmap::OccupancyRaster> map{};  ///< of this scan, when somebody has asked
    bool has_failed = false, wants_to_drive = false;
    int gave_way = 0;
  };

  TeamLoop(const world::Plan& plan, const TeamRequest& request, const explore::LoopMethod& method,
           const std::vector<core::Pose2>& T_world_starts, const std::vector<std::string>& folders,
           std::vector<metrics::ExplorableArea> areas);
  void sight();
  void locate();
  void count();
  bool isOver();
  void endAll(explore::ExplorationEnd end);
  void speak();
  void decide(std::size_t i);
  void driveAll();
  void tellOthers(std::size_t i);
  std::shared_ptr<const gridmap::OccupancyRaster> mapOf(std::size_t i);
  gridmap::OccupancyRaster sharedMap(std::size_t i);
  double elapsed_s() const { return members_.front().robot->elapsed_s(); }

  const world::Plan& plan_;
  const TeamRequest& request_;
  std::vector<Member> members_;
  TeamRadio radio_;
  metrics::Coverage coverage_;
  threads::ThreadTeam threads_;
  std::vector<metrics::CoveragePoint> curve_;
  std::vector<std::vector<double>> paths_m_;
  std::optional<explore::ExplorationEnd> end_;
};

}  // namespace slam::teams

#include "libslam/teams/team_loop.h"

#include <algorithm>
#include <utility>

#include "libslam/gridmap/fused_raster.h"
#include "libslam/record/sensor.h"
#include "libslam/results/map_cells.h"
#include "libslam/sim/sightings.h"

namespace slam::teams {
namespace {

constexpr double kLeaveOut_m = 0.12;  // round another robot's disc: noise of the range, and the beam's width

/// The first robot's streams are those of a robot alone.
std::uint64_t seedOf(std::uint64_t seed, std::size_t robot) {
  return robot == 0 ? seed : core::RandomStream(seed, "robot " + std::to_string(robot + 1)).bits();
}

metrics::ExplorableArea areaFrom(const world::Plan& plan, const core::Pose2& start,
                                 const record::RecordConfig& record) {
  return metrics::explorableArea(plan, core::position(start), robot::circumscribedRadius(record.robot),
                                 record.lidar.max_range_m);
}

/// Whoever starts where another one can drive can explore the same.
std::vector<metrics::ExplorableArea> areasOf(const world::Plan& plan, const TeamRequest& request,
                                             const std::vector<core::Pose2>& starts) {
  std::vector<metrics::ExplorableArea> areas;
  areas.reserve(starts.size());
  for (const auto& start : starts)
    areas.push_back(areas.empty() || !request.T_world_starts.empty()
                        ? areaFrom(plan, start, request.config.record)
                        : areas.front());
  return areas;
}

/// What any of them can explore.
metrics::ExplorableArea unionOf(const std::vector<metrics::ExplorableArea>& areas) {
  metrics::ExplorableArea all = areas.front();
  if (all.cells == 0) return all;
  const double cell_m2 = all.area_m2 / static_cast<double>(all.cells);
  const double free_cells = static_cast<double>(all.cells) / all.share_of_free;
  for (const auto& area : areas)
    for (std::size_t cell = 0; cell < all.explorable.size(); ++cell)
      if (area.explorable[cell] && !all.explorable[cell]) all.explorable[cell] = 1, ++all.cells;
  all.area_m2 = cell_m2 * static_cast<double>(all.cells);
  all.share_of_free = static_cast<double>(all.cells) / free_cells;
  return all;
}

/// The part of a path that is still ahead: from its leg that is nearest on.
std::vector<core::Point2> restOf(const std::vector<core::Point2>& path, const core::Point2& here) {
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < path.size(); ++i)
    if (core::distance(path[i], here) < core::distance(path[nearest], here)) nearest = i;
  return {path.begin() + static_cast<std::ptrdiff_t>(nearest), path.end()};
}

}  // namespace

TeamLoop::TeamLoop(const world::Plan& plan, const TeamRequest& request, const explore::LoopMethod& method,
                   const std::vector<core::Pose2>& T_world_starts, const std::vector<std::string>& folders)
    : TeamLoop(plan, request, method, T_world_starts, folders, areasOf(plan, request, T_world_starts)) {}

TeamLoop::TeamLoop(const world::Plan& plan, const TeamRequest& request, const explore::LoopMethod& method,
                   const std::vector<core::Pose2>& T_world_starts, const std::vector<std::string>& folders,
                   std::vector<metrics::ExplorableArea> areas)
    : plan_(plan),
      request_(request),
      radio_(T_world_starts, request.radio_range_m),
      coverage_(plan, unionOf(areas)),
      threads_(request.threads) {
  for (std::size_t i = 0; i < T_world_starts.size(); ++i) {
    auto robot = std::make_unique<explore::ExploringRobot>(
        plan, request.config, method, seedOf(request.seed, i),
        explore::ExploringRobot::Place{T_world_starts[i], std::move(areas[i])}, folders[i]);
    const navigate::RightOfWay right_of_way(request.config.record.robot, robot->period_s(),
                                            static_cast<int>(i), static_cast<int>(T_world_starts.size()));
    members_.push_back({std::move(robot), right_of_way, explore::Referee(request.config.exploration)});
  }
}

void TeamLoop::run(core::Progress& progress) {
  const double duration_s = request_.config.record.simulation.duration_s;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    tellOthers(i);
    members_[i].robot->begin();
  }
  while (true) {
    const double now_s = elapsed_s();
    progress.update(duration_s > 0 ? now_s / duration_s : 1, now_s);
    sight();
    locate();
    count();
    if (isOver()) return;
    speak();
    for (std::size_t i = 0; i < members_.size(); ++i) decide(i);
    driveAll();
  }
}

/// Who sees whom; beams on the robots that are seen are no part of the map.
void TeamLoop::sight() {
  const double disc_m = members_.front().robot->radius_m() + kLeaveOut_m;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    std::vector<core::Point2> others;
    std::vector<std::size_t> who;
    for (std::size_t other = 0; other < members_.size(); ++other)
      if (other != i) others.push_back(core::position(members_[other].robot->truth())), who.push_back(other);
    Member& member = members_[i];
    member.neighbours.clear();
    member.map.reset();
    std::vector<movers::Disc> discs;
    for (const auto& seen : sim::sightings(plan_, member.robot->truth(), others)) {
      const std::size_t other = who[seen.robot];
      member.neighbours.push_back({static_cast<int>(other), seen.p_robot, members_[other].wants_to_drive});
      discs.push_back({seen.p_robot, disc_m});
    }
    member.robot->leaveOut(discs);
  }
}

/// Each robot by its own method, side by side.
void TeamLoop::locate() {
  threads_.forEach(members_.size(), [this](std::size_t i) {
    Member& member = members_[i];
    if (member.has_failed) return;
    try {
      member.robot->locate();
    } catch (const core::MethodError& error) {
      if (!member.robot->hasLocated()) throw;
      member.robot->fail(error);
      member.has_failed = true;
      member.wants_to_drive = false;
    }
    for (auto& neighbour : member.neighbours) neighbour.p_map = member.robot->estimate() * neighbour.p_map;
  });
}

/// What the truth has to say of the team.
void TeamLoop::count() {
  metrics::CoveragePoint point{elapsed_s(), 0, curve_.size() + 1, 0};
  paths_m_.emplace_back();
  for (const auto& member : members_) {
    const auto& scan = member.robot->sensed().scan;
    const auto [first_angle_rad, beams] = record::beamsOverFloor(request_.config.record.camera, scan);
    coverage_.look(member.robot->truth() * scan.T_robot_lidar, first_angle_rad, scan.step_rad, beams,
                   scan.max_range_m);
    point.path_m += member.robot->path_m();
    paths_m_.back().push_back(member.robot->path_m());
  }
  point.explored_m2 = coverage_.area_m2();
  curve_.push_back(point);
}

bool TeamLoop::isOver() {
  const double period_s = members_.front().robot->period_s();
  if (elapsed_s() + period_s / 2 >= request_.config.record.simulation.duration_s) {
    endAll(explore::ExplorationEnd::kDuration);
    return true;
  }
  bool is_over = true;
  explore::ExplorationEnd end = explore::ExplorationEnd::kFailed;
  for (auto& member : members_) {
    const auto verdict = member.referee.judge(elapsed_s(), coverage_.area_m2(), member.robot->truth());
    if (member.has_failed) continue;
    if (member.robot->driver().finished()) {
      if (end == explore::ExplorationEnd::kFailed) end = explore::ExplorationEnd::kFinished;
      continue;
    }
    if (verdict) end = *verdict;
    is_over = is_over && verdict;
  }
  if (is_over) endAll(end);
  return is_over;
}

void TeamLoop::endAll(explore::ExplorationEnd end) {
  end_ = end;
  for (auto& member : members_)
    if (!member.has_failed) member.robot->end(end);
}

/// What each robot says of itself, and what its neighbours hear of its way.
void TeamLoop::speak() {
  std::vector<core::Point2> places;
  for (const auto& member : members_) places.push_back(core::position(member.robot->truth()));
  radio_.listen(places);
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (members_[i].has_failed) continue;
    const auto& robot = *members_[i].robot;
    const auto& decision = robot.driver().currentDecision();
    RobotNews news{elapsed_s(), robot.estimate(), std::nullopt, nullptr};
    if (!decision.path.empty() && !decision.finished && !decision.comes_after) news.goal = decision.goal;
    radio_.tell(i, news);
  }
  for (std::size_t i = 0; i < members_.size(); ++i)
    for (auto& neighbour : members_[i].neighbours) {
      const auto other = static_cast<std::size_t>(neighbour.number);
      const auto& robot = *members_[other].robot;
      if (!neighbour.wants_to_drive || !radio_.hears(i, other)) continue;
      for (const auto& p : restOf(robot.driver().currentDecision().path, core::position(robot.estimate())))
        neighbour.way.push_back(radio_.frameOf(i, other) * p);
    }
}

/// As others get it.
std::shared_ptr<const gridmap::OccupancyRaster> TeamLoop::mapOf(std::size_t i) {
  Member& member = members_[i];
  if (!member.map) {
    auto map = member.robot->map();
    member.robot->driver().strategy().annotate(map);
    member.map = std::make_shared<const gridmap::OccupancyRaster>(std::move(map));
  }
  return member.map;
}

gridmap::OccupancyRaster TeamLoop::sharedMap(std::size_t i) {
  radio_.fetchMaps(i, elapsed_s(), [this](std::size_t other) { return mapOf(other); });
  return radio_.mapOf(i, members_[i].robot->map());
}

void TeamLoop::decide(std::size_t i) {
  Member& member = members_[i];
  auto& robot = *member.robot;
  member.command = {0, 0, robot.period_s()};
  if (member.has_failed) return;
  auto& driver = robot.driver();
  const bool was_finished = driver.finished();
  std::optional<robot::Command> wanted;
  if (!member.right_of_way.givesWay()) {
    wanted = member.command;
    if (!was_finished) {
      driver.setTeam(radio_.teamOf(i, elapsed_s()));
      std::optional<gridmap::OccupancyRaster> map;
      if (robot.wantsMap()) map = sharedMap(i);
      wanted = robot.decide(map ? &*map : nullptr);
    }
  } else if (!was_finished) {
    robot.watch();
  }
  if (!was_finished && driver.finished()) robot.end(explore::ExplorationEnd::kFinished);
  const bool gave_way = member.right_of_way.givesWay();
  const auto answer = member.right_of_way.next(wanted, robot.sensed().scan, robot.estimate(),
                                               member.neighbours, [this, i] { return sharedMap(i); });
  if (!gave_way && member.right_of_way.givesWay()) ++member.gave_way;
  if (answer.gave_way) driver.reconsider();
  member.command = answer.command;
  member.wants_to_drive = wanted && (wanted->speed_mps != 0 || wanted->turn_rate_radps != 0);
}

void TeamLoop::tellOthers(std::size_t i) {
  std::vector<movers::Disc> others;
  for (std::size_t other = 0; other < members_.size(); ++other)
    if (other != i)
      others.push_back({core::position(members_[other].robot->truth()), members_[other].robot->radius_m()});
  members_[i].robot->simulator().setOthers(others);
}

/// One after the other, each where the ones before have come to; then all look.
void TeamLoop::driveAll() {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    tellOthers(i);
    members_[i].robot->drive(members_[i].command);
  }
  for (std::size_t i = 0; i < members_.size(); ++i) tellOthers(i);
  threads_.forEach(members_.size(), [this](std::size_t i) { members_[i].robot->look(members_[i].command); });
}

gridmap::OccupancyRaster TeamLoop::mergedMap() const {
  std::vector<gridmap::OccupancyRaster> maps;
  std::vector<gridmap::PlacedRaster> placed;
  maps.reserve(members_.size());
  for (std::size_t i = 0; i < members_.size(); ++i) try {
      maps.push_back(members_[i].robot->map());
      placed.push_back({&maps.back(), radio_.frameOf(0, i)});
    } catch (const core::MethodError&) {
      continue;
    }
  return gridmap::merged(placed);
}

TeamScores TeamLoop::scores() const {
  TeamScores scores;
  const auto& area = coverage_.explorable();
  scores.end = end_.value_or(explore::ExplorationEnd::kFailed);
  scores.explorable_m2 = area.area_m2;
  scores.figures = metrics::explorationFigures(curve_, area.area_m2);
  std::vector<int> seen_by(area.explorable.size(), 0);
  for (const auto& member : members_) {
    scores.path_sum_m += member.robot->path_m();
    scores.path_longest_m = std::max(scores.path_longest_m, member.robot->path_m());
    scores.gave_way += member.gave_way;
    for (const auto& collision : member.robot->simulator().collisions())
      ++(collision.with_robot ? scores.robot_collisions : scores.wall_collisions);
    const auto seen = member.robot->coverage().seen();
    for (std::size_t cell = 0; cell < seen_by.size(); ++cell)
      seen_by[cell] += area.explorable[cell] && seen.free[cell];
  }
  const auto explored = std::count_if(seen_by.begin(), seen_by.end(), [](int robots) { return robots > 0; });
  const auto shared = std::count_if(seen_by.begin(), seen_by.end(), [](int robots) { return robots > 1; });
  scores.overlap = explored > 0 ? static_cast<double>(shared) / static_cast<double>(explored) : 0;

  results::RunFolder run;
  run.method = request_.slam;
  run.estimate = members_.front().robot->estimatedTrajectory();
  const auto map = mergedMap();
  run.map = results::toCellMap(map);
  run.manifest.results["map_mean_entropy_bits"] = files::formatNumber(metrics::mapEntropy(map.occupancy));
  score::Truth truth;
  truth.trajectory = members_.front().robot->trueTrajectory();
  truth.plan = plan_;
  truth.seen = coverage_.seen();
  scores.evaluation = score::evaluate(run, truth);
  return scores;
}

}  // namespace slam::teams

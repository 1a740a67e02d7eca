#include "libslam/movers/crowd.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "libslam/core/error.h"

namespace slam::movers {
namespace {

using core::Point2;

constexpr double kTick_s = static_cast<double>(kTick_ns) * 1e-9;
constexpr int kThinkEvery = 4;  // ticks: ten times a second

// Moussaid et al. 2011, but the sight, which is 10 m there: rooms are smaller than their streets.
constexpr double kRelaxation_s = 0.5, kSight_m = 6;
// tan(alpha / 2) of a direction, in twelfths: directions about 10 degrees apart, up to 74, without a sine.
constexpr int kDirectionsAside = 9;

constexpr double kKeepFromOthers_m = 0.1, kKeepFromRobot_m = 0.1, kComfortFromRobot_m = 0.4;
constexpr double kLeavesRobot_m = 0.5, kStartsFromRobot_m = 0.5;
constexpr double kArrived_m = 0.3, kNearEnough_m = 1.2, kSlow_mps = 0.1;
constexpr double kGivesWay_m = 0.4;
constexpr std::int64_t kGivesWayTicks = 20, kLostTicks = 20, kNearEnoughTicks = 40;

// Legs: width of the track and its place are our choice within the body's disc. 1.9 steps a second at an
// ordinary pace: Murray, Drought and Kory, Journal of Bone and Joint Surgery 46-A(2), 1964, men's free
// walking.
constexpr double kLegRadius_m = 0.06, kHalfTrack_m = 0.08, kStepsPerSecond = 1.9;

Point2 operator-(const Point2& a, const Point2& b) {
  return {a.x - b.x, a.y - b.y};
}
double dot(const Point2& a, const Point2& b) {
  return a.x * b.x + a.y * b.y;
}
double length(const Point2& a) {
  return std::sqrt(dot(a, a));
}

/// Turned by an angle given as tan(angle / 2).
Point2 turned(const Point2& v, double half_tangent) {
  const double t2 = half_tangent * half_tangent, c = (1 - t2) / (1 + t2), s = 2 * half_tangent / (1 + t2);
  return {c * v.x - s * v.y, s * v.x + c * v.y};
}
double cosineOf(double half_tangent) {
  return (1 - half_tangent * half_tangent) / (1 + half_tangent * half_tangent);
}

std::int64_t toTicks(double seconds) {
  return static_cast<std::int64_t>(seconds / kTick_s);
}

/// When two discs whose centres touch at `reach` meet: `to` from one to the other, `closing` the speed
/// towards it.
double timeToContact(const Point2& to, const Point2& closing, double reach_m) {
  const double a = dot(closing, closing), b = dot(to, closing), c = dot(to, to) - reach_m * reach_m;
  if (b <= 0) return std::numeric_limits<double>::infinity();
  if (c <= 0) return 0;
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return std::numeric_limits<double>::infinity();
  return c / (b + std::sqrt(discriminant));
}

/// From 1 down to -1 and up again over a turn of 1.
double triangleWave(double turns) {
  const double phase = turns - std::floor(turns);
  return phase < 0.5 ? 1 - 4 * phase : 4 * phase - 3;
}

}  // namespace

Crowd::Crowd(const world::Plan& plan, const LivingOptions& options, std::uint64_t seed,
             const Disc& robot_in_plan)
    : options_(options),
      walkways_(plan, options.radius_m, seed, robot_in_plan.p),
      last_robot_(robot_in_plan) {
  for (size_t i = 0; i < static_cast<size_t>(options.people); ++i) {
    Mind mind(core::RandomStream(seed, "person " + std::to_string(i)));
    double deviation = 0;
    do deviation = mind.random.normal();
    while (std::abs(deviation) > 2);
    mind.speed_mps =
        std::max(0.3 * options.speed_mps, options.speed_mps + options.speed_sigma_mps * deviation);
    mind.gait = mind.random.uniform();
    people_.emplace_back();
    minds_.push_back(std::move(mind));
    if (!placeOnAWay(i, robot_in_plan))
      throw core::InputError("plan '" + plan.name + "': section [living], key 'people': found " +
                             std::to_string(options.people) + ", expected at most " + std::to_string(i) +
                             ": there is no room for more");
  }
}

bool Crowd::placeOnAWay(size_t i, const Disc& robot) {
  if (walkways_.places() == 0) return false;
  Mind& mind = minds_[i];
  Person& person = people_[i];
  for (int tries = 0; tries < 200; ++tries) {
    mind.to = mind.random.below(walkways_.places());
    chooseWay(mind);
    const size_t leg = mind.random.below(mind.corners.size() - 1);
    const double s = mind.random.uniform();
    const Point2 &a = mind.corners[leg], &b = mind.corners[leg + 1];
    const Point2 p{a.x + s * (b.x - a.x), a.y + s * (b.y - a.y)};
    const auto isNear = [&](const Point2& q, double distance_m) { return length(q - p) < distance_m; };
    bool is_free =
        walkways_.canStand(p) && !isNear(robot.p, options_.radius_m + robot.radius_m + kStartsFromRobot_m);
    for (size_t other = 0; is_free && other < i; ++other)
      is_free = !isNear(people_[other].p, 2 * options_.radius_m + kKeepFromOthers_m);
    if (!is_free) continue;
    person.p = p;
    mind.next = leg + 1;
    return true;
  }
  return false;
}

void Crowd::chooseWay(Mind& mind) {
  const auto& ways = walkways_.waysFrom(mind.to);
  const auto& way = ways[mind.random.below(ways.size())];
  mind.from = mind.to;
  mind.to = way.to;
  mind.corners = way.corners;
  mind.next = 1;
  mind.slow_ticks = 0;
  mind.patience_ticks = toTicks(mind.random.uniform(3, 9));
}

void Crowd::turnBack(Mind& mind) {
  std::swap(mind.from, mind.to);
  std::reverse(mind.corners.begin(), mind.corners.end());
  mind.next = mind.corners.size() - mind.next;
  mind.slow_ticks = 0;
  mind.patience_ticks = toTicks(mind.random.uniform(3, 9));
}

void Crowd::tick(const Disc& robot) {
  robot_velocity_mps_ = robot.p - last_robot_.p;
  robot_velocity_mps_ = {robot_velocity_mps_.x / kTick_s, robot_velocity_mps_.y / kTick_s};
  last_robot_ = robot;
  ++ticks_;
  for (size_t i = 0; i < people_.size(); ++i) {
    think(i, robot);
    walk(i, robot);
  }
}

void Crowd::update(const world::Plan& plan, const world::Door& cells) {
  walkways_.update(plan, cells.x0, cells.y0, cells.x1, cells.y1);
}

void Crowd::think(size_t i, const Disc& robot) {
  Person& person = people_[i];
  Mind& mind = minds_[i];
  if (person.state == PersonState::kPausing) {
    const bool is_disturbed =
        length(robot.p - person.p) < options_.radius_m + robot.radius_m + kLeavesRobot_m;
    if (--mind.pause_ticks > 0 && !is_disturbed) return;
    person.state = PersonState::kWalking;
    chooseWay(mind);
  }
  const double to_goal_m = length(mind.corners.back() - person.p);
  if (to_goal_m < kArrived_m || (to_goal_m < kNearEnough_m && mind.slow_ticks > kNearEnoughTicks)) {
    if (mind.random.chance(options_.pause_share)) {
      person.state = PersonState::kPausing;
      mind.pause_ticks = toTicks(mind.random.uniform(0, 2 * options_.pause_s));
      mind.wanted_mps = {};
      return;
    }
    chooseWay(mind);
  }
  if (mind.slow_ticks > mind.patience_ticks) turnBack(mind);
  person.state = mind.slow_ticks > 0 ? PersonState::kWaiting : PersonState::kWalking;
  if ((ticks_ + static_cast<std::int64_t>(i)) % kThinkEvery != 0) return;
  followCorners(person, mind);
  mind.wanted_mps = wantedVelocity(i, robot);
}

void Crowd::followCorners(const Person& person, Mind& mind) const {
  const auto& corners = mind.corners;
  while (mind.next + 1 < corners.size()) {
    const double to_corner_m = length(corners[mind.next] - person.p);
    const bool is_there = to_corner_m < 0.15;
    if (!is_there && (to_corner_m > 1.5 || !walkways_.isClear(person.p, corners[mind.next + 1]))) break;
    ++mind.next;
  }
  // Pushed round a corner: back to the one before.
  if (mind.slow_ticks > kLostTicks && mind.next > 1 && !walkways_.isClear(person.p, corners[mind.next]))
    --mind.next;
}

double Crowd::freeWalk(const Person& person, const Point2& direction, double speed_mps,
                       double sight_m) const {
  double free_m = sight_m;
  for (const auto& other : neighbours_) {
    const Point2 to = other.p - person.p;
    const Point2 closing{speed_mps * direction.x - other.velocity_mps.x,
                         speed_mps * direction.y - other.velocity_mps.y};
    // Nearer than is comfortable: only contact counts, or nobody could ever pass again.
    const double reach_m = dot(to, to) > other.comfort_m * other.comfort_m ? other.comfort_m : other.reach_m;
    free_m = std::min(free_m, speed_mps * timeToContact(to, closing, reach_m));
  }
  return walkways_.freeDistance(person.p, direction, free_m);
}

Point2 Crowd::wantedVelocity(size_t i, const Disc& robot) {
  const Person& person = people_[i];
  const Mind& mind = minds_[i];
  const double at_robot_m = options_.radius_m + robot.radius_m;
  const Point2 from_robot = person.p - robot.p;
  const bool is_held_up = mind.slow_ticks > kGivesWayTicks || dot(robot_velocity_mps_, from_robot) > 0;
  const bool gives_way = is_held_up && length(from_robot) < at_robot_m + kGivesWay_m;
  const Point2 to = gives_way ? from_robot : mind.corners[mind.next] - person.p;
  const double distance_m = length(to);
  if (distance_m < 1e-6) return {};
  const Point2 ahead{to.x / distance_m, to.y / distance_m};
  const double sight_m = std::min(kSight_m, std::max(distance_m, 0.5));

  neighbours_.clear();
  const double contact_m = 2 * options_.radius_m;
  for (size_t other = 0; other < people_.size(); ++other) {
    const Point2 to_other = people_[other].p - person.p;
    const bool in_sight =
        dot(to_other, to_other) < (sight_m + 3) * (sight_m + 3) && dot(to_other, ahead) > -contact_m;
    if (other != i && in_sight)
      neighbours_.push_back(
          {people_[other].p, people_[other].velocity_mps, contact_m, contact_m + kKeepFromOthers_m});
  }
  neighbours_.push_back(
      {robot.p, robot_velocity_mps_, at_robot_m + kKeepFromRobot_m, at_robot_m + kComfortFromRobot_m});

  Point2 best = ahead;
  double best_free_m = freeWalk(person, ahead, mind.speed_mps, sight_m);
  const bool is_last = mind.next + 1 == mind.corners.size() && !gives_way;
  if (best_free_m >= sight_m) {
    const double speed_mps = is_last ? std::min(mind.speed_mps, distance_m / kRelaxation_s) : mind.speed_mps;
    return {speed_mps * ahead.x, speed_mps * ahead.y};
  }
  double least = (sight_m - best_free_m) * (sight_m - best_free_m);
  for (int k = 1; k <= kDirectionsAside; ++k) {
    const double cosine = cosineOf(k / 12.0);
    // However far one could walk that way, and the more so further aside, it would end no nearer.
    if (sight_m * sight_m * (1 - cosine * cosine) >= least) break;
    for (const int side : {-1, 1}) {  // the right hand first
      const Point2 direction = turned(ahead, side * k / 12.0);
      const double free_m = freeWalk(person, direction, mind.speed_mps, sight_m);
      const double rest = sight_m * sight_m + free_m * free_m - 2 * sight_m * free_m * cosine;
      if (rest < least) least = rest, best = direction, best_free_m = free_m;
    }
  }
  const double speed_mps = std::min(mind.speed_mps, best_free_m / kRelaxation_s);
  return {speed_mps * best.x, speed_mps * best.y};
}

void Crowd::walk(size_t i, const Disc& robot) {
  Person& person = people_[i];
  Mind& mind = minds_[i];
  const double share = kTick_s / kRelaxation_s;
  Point2& v = person.velocity_mps;
  v = {v.x + share * (mind.wanted_mps.x - v.x), v.y + share * (mind.wanted_mps.y - v.y)};
  const Point2 step{v.x * kTick_s, v.y * kTick_s};
  Point2 taken{};
  // Along the wall or past the neighbour where straight on is shut.
  for (const Point2& part : {step, Point2{step.x, 0}, Point2{0, step.y}, Point2{0.5 * step.x, 0.5 * step.y}})
    if (dot(part, part) > 0 && canStep(i, {person.p.x + part.x, person.p.y + part.y}, robot)) {
      taken = part;
      break;
    }
  person.p = {person.p.x + taken.x, person.p.y + taken.y};
  v = {taken.x / kTick_s, taken.y / kTick_s};
  const double speed_mps = length(v);
  if (speed_mps > kSlow_mps) person.heading = {v.x / speed_mps, v.y / speed_mps};
  if (person.state == PersonState::kPausing) return;
  // Setting out takes a tick or two as well: only who stays slow is waiting.
  mind.slow_ticks = speed_mps < kSlow_mps ? mind.slow_ticks + 1 : 0;
}

bool Crowd::canStep(size_t i, const Point2& to, const Disc& robot) const {
  if (!walkways_.canStand(to)) return false;
  const Point2& from = people_[i].p;
  const auto keeps = [&](const Point2& other, double distance_m) {
    const Point2 after = other - to, before = other - from;
    return dot(after, after) >= distance_m * distance_m || dot(after, after) > dot(before, before);
  };
  for (size_t other = 0; other < people_.size(); ++other)
    if (other != i && !keeps(people_[other].p, 2 * options_.radius_m)) return false;
  return keeps(robot.p, options_.radius_m + robot.radius_m + kKeepFromRobot_m);
}

void Crowd::appendBodies(std::vector<Disc>& bodies) const {
  for (size_t i = 0; i < people_.size(); ++i) {
    const Person& person = people_[i];
    if (options_.body == "disc") {
      bodies.push_back({person.p, options_.radius_m});
      continue;
    }
    // A leg that stands is passed at the walking speed: half a step ahead of the body to half a step behind
    // it.
    const double room_m = options_.radius_m - kLegRadius_m;
    const double most_m = std::sqrt(std::max(0.0, room_m * room_m - kHalfTrack_m * kHalfTrack_m));
    const double half_step_m = std::min(most_m, length(person.velocity_mps) / (2 * kStepsPerSecond));
    const double turns = minds_[i].gait + static_cast<double>(ticks_) * kTick_s * kStepsPerSecond / 2;
    for (const double side : {1.0, -1.0}) {
      const double along = side * half_step_m * triangleWave(turns), aside = side * kHalfTrack_m;
      bodies.push_back({{person.p.x + along * person.heading.x - aside * person.heading.y,
                         person.p.y + along * person.heading.y + aside * person.heading.x},
                        kLegRadius_m});
    }
  }
}

}  // namespace slam::movers

#pragma once
#include <cstdint>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/core/random.h"
#include "libslam/movers/disc.h"
#include "libslam/movers/living.h"
#include "libslam/movers/walkways.h"
#include "libslam/world/plan.h"

namespace slam::movers {

/// The world's clock: people and doors move at whole multiples of it.
inline constexpr std::int64_t kTick_ns = 25'000'000;

enum class PersonState { kWalking, kWaiting, kPausing };

/// A person, in the plan frame.
struct Person {
  core::Point2 p, velocity_mps;
  core::Point2 heading{1, 0};  ///< unit vector; that of the last walk while standing
  PersonState state = PersonState::kWalking;
};

/// People who walk from place to place, past each other, the walls and the robot.
///
/// A person goes for a place drawn from its own stream ("person N") on the way that Walkways knows, and now
/// and then stays there. Every 0.1 s it looks for the direction that leads nearest to its next corner, given
/// how far it could walk each way, at the speed it likes, before it met a wall or where somebody will be
/// then; it slows down so that what it might meet stays half a second away, and takes half a second to change
/// its velocity: Moussaid, Helbing and Theraulaz, PNAS 108(17), 2011. Ours: a sight of 6 m, 19 directions
/// over 148 degrees, of equals the right-hand one, and no forces between bodies, for none ever touch. Who
/// gets nowhere for 3 to 9 s turns back. Who stays at a place leaves it when the robot comes within 0.5 m;
/// who is within 0.4 m of the robot and held up, or approached by it, steps away from it.
///
/// Always: everybody stands where Walkways::canStand(); no two discs overlap; nobody comes nearer to the
/// robot's disc than 10 cm by their own step. The robot may come nearer.
class Crowd {
 public:
  /// `robot`: nobody begins within 0.5 m of it. InputError when the plan has no room for so many.
  Crowd(const world::Plan& plan, const LivingOptions& options, std::uint64_t seed, const Disc& robot_in_plan);

  /// One tick. Where the robot was at the tick before tells its velocity.
  void tick(const Disc& robot_in_plan);
  /// The robot was kidnapped: it did not walk there, so nobody takes the jump for its velocity.
  void noteCarried(const Disc& robot_in_plan) { last_robot_ = robot_in_plan; }
  /// These cells of the plan have changed, and no person is in the way.
  void update(const world::Plan& plan, const world::Door& cells);

  const std::vector<Person>& people() const { return people_; }
  double radius_m() const { return options_.radius_m; }
  /// What a lidar meets of the people, in the plan frame: their discs, or two legs each within the disc. Legs
  /// swing along the heading, one forward while the other stands, in step with the speed.
  void appendBodies(std::vector<Disc>& bodies) const;

 private:
  struct Mind {
    explicit Mind(core::RandomStream stream) : random(stream) {}
    core::RandomStream random;
    double speed_mps = 0;  ///< that it likes
    size_t from = 0, to = 0, next = 1;
    std::vector<core::Point2> corners;
    core::Point2 wanted_mps;
    std::int64_t pause_ticks = 0, slow_ticks = 0, patience_ticks = 0;
    double gait = 0;  ///< shifts the steps between people
  };
  struct Neighbour {
    core::Point2 p, velocity_mps;
    double reach_m, comfort_m;  ///< distance of the centres at contact, and the one to keep
  };

  bool placeOnAWay(size_t i, const Disc& robot);
  void chooseWay(Mind& mind);
  void turnBack(Mind& mind);
  void think(size_t i, const Disc& robot);
  void followCorners(const Person& person, Mind& mind) const;
  core::Point2 wantedVelocity(size_t i, const Disc& robot);
  double freeWalk(const Person& person, const core::Point2& direction, double speed_mps,
                  double sight_m) const;
  void walk(size_t i, const Disc& robot);
  bool canStep(size_t i, const core::Point2& to, const Disc& robot) const;

  LivingOptions options_;
  Walkways walkways_;
  std::vector<Person> people_;
  std::vector<Mind> minds_;
  std::vector<Neighbour> neighbours_;  ///< of the person that thinks
  Disc last_robot_;
  core::Point2 robot_velocity_mps_;
  std::int64_t ticks_ = 0;
};

}  // namespace slam::movers

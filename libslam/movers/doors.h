#pragma once
#include <cstdint>
#include <vector>

#include "libslam/core/random.h"
#include "libslam/movers/disc.h"
#include "libslam/movers/living.h"
#include "libslam/world/plan.h"

namespace slam::movers {

enum class DoorState { kOpen, kClosed, kHeld };  ///< held: would close, but somebody stands there

/// Doors that open and close by themselves. Each draws from its own stream ("door N", N its place in the
/// plan's list) whether it does, and then each of its times; it begins open.
class Doors {
 public:
  Doors(const world::Plan& plan, const LivingOptions& options, std::uint64_t seed);

  /// One tick of movers::kTick_ns. `bodies`: people and robot in the plan frame; a door does not close while
  /// one is in it or within `keep_m` of it. Returns the indices (into all()) of the doors whose cells
  /// changed.
  const std::vector<size_t>& tick(const std::vector<Disc>& bodies, double keep_m);

  struct MovingDoor {
    world::Door cells;
    size_t id;  ///< its place in the plan's list
    DoorState state = DoorState::kOpen;
  };
  const std::vector<MovingDoor>& all() const { return doors_; }

 private:
  double resolution_m_;
  LivingOptions options_;
  std::vector<MovingDoor> doors_;
  std::vector<core::RandomStream> random_;
  std::vector<std::int64_t> ticks_left_;
  std::vector<size_t> changed_;
};

}  // namespace slam::movers

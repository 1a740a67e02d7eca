#include "libslam/movers/doors.h"

#include <algorithm>
#include <string>

#include "libslam/movers/crowd.h"

namespace slam::movers {
namespace {

bool isInTheWay(const Disc& body, const world::Door& door, double resolution_m, double keep_m) {
  const auto gap = [&](double x, int low, int high) {
    return std::max({0.0, low * resolution_m - x, x - high * resolution_m});
  };
  const double dx = gap(body.p.x, door.x0, door.x1), dy = gap(body.p.y, door.y0, door.y1);
  const double keep = body.radius_m + keep_m;
  return dx * dx + dy * dy <= keep * keep;
}

std::int64_t drawTicks(core::RandomStream& random, double mean_s) {
  return static_cast<std::int64_t>(mean_s * random.uniform(0.5, 1.5) * 1e9 / static_cast<double>(kTick_ns));
}

}  // namespace

Doors::Doors(const world::Plan& plan, const LivingOptions& options, std::uint64_t seed)
    : resolution_m_(plan.resolution_m), options_(options) {
  for (size_t id = 0; id < plan.doors.size(); ++id) {
    core::RandomStream random(seed, "door " + std::to_string(id));
    if (!random.chance(options.doors_share)) continue;
    // Somewhere within its time, or all doors would begin to close together.
    const double passed = random.uniform();
    doors_.push_back({plan.doors[id], id});
    ticks_left_.push_back(
        static_cast<std::int64_t>(passed * static_cast<double>(drawTicks(random, options.door_open_s))));
    random_.push_back(random);
  }
}

const std::vector<size_t>& Doors::tick(const std::vector<Disc>& bodies, double keep_m) {
  changed_.clear();
  for (size_t i = 0; i < doors_.size(); ++i) {
    MovingDoor& door = doors_[i];
    if (--ticks_left_[i] > 0) continue;
    if (door.state == DoorState::kClosed) {
      door.state = DoorState::kOpen;
      ticks_left_[i] = drawTicks(random_[i], options_.door_open_s);
      changed_.push_back(i);
    } else if (std::any_of(bodies.begin(), bodies.end(), [&](const Disc& body) {
                 return isInTheWay(body, door.cells, resolution_m_, keep_m);
               })) {
      door.state = DoorState::kHeld;
    } else {
      door.state = DoorState::kClosed;
      ticks_left_[i] = drawTicks(random_[i], options_.door_closed_s);
      changed_.push_back(i);
    }
  }
  return changed_;
}

}  // namespace slam::movers

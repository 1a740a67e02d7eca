#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "libslam/explore/exploration_loop.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/robot/motion_kind.h"
#include "libslam/sim/simulator.h"

namespace slam::explore {

/// The method by its name in the folder, the path of an .ini, or kTruthReference. Errors: InputError, also
/// for a key of its configuration: that must not show in every run.
LoopMethod loadMethod(const std::string& slam, const std::string& methods_folder);

/// Where the robot believes to be, and the map that it makes of it.
class Localiser {
 public:
  Localiser(const LoopMethod& method, std::uint64_t seed)
      : builder_(mapping::makeMapBuilder(method.config, method.name, seed)),
        name_(method.name),
        is_reference_(method.is_reference) {}
  /// T_map_robot at the new scan. The truth is used by the reference alone: it takes the true increment for
  /// that of its wheels, and believes them.
  core::Pose2 update(const sim::Sensed& sensed, const core::Pose2& T_world_robot);
  /// What the robot is told to do next.
  void tell(const robot::Command& command) { commanded_ = commands_.next(command); }
  const mapping::MapBuilder& builder() const { return builder_; }
  gridmap::OccupancyRaster map() const;
  /// How far (m, one standard deviation) what is seen about kArm_m from the robot may lie off, by the
  /// method's own covariance of the newest pose: a heading that errs shifts all that is far away. nullopt:
  /// the method does not say.
  std::optional<double> spread_m() const;
  static constexpr double kArm_m = 3;

 private:
  mapping::MapBuilder builder_;
  std::string name_;
  bool is_reference_;
  std::optional<core::Pose2> last_truth_;
  robot::CommandSeries commands_;
  robot::Commanded commanded_ = robot::MotionKind::kRest;
};

}  // namespace slam::explore

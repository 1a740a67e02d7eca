#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "libslam/mapping/method_options.h"
#include "libslam/methods/slam_method.h"
#include "libslam/robot/motion_kind.h"

namespace slam::mapping {

/// What is remembered of the steps so far.
struct StepHistory {
  std::optional<lidar::Scan> previous_scan;
  std::optional<lidar::Scan> reference_scan;  ///< the last one of the lidar of the first
  core::Pose2 T_reference_previous;           ///< the motion fed since that one
  core::Pose2 T_previous_last;                ///< the last step, as the method has it
  double last_period_s = 0;                   ///< how long it took
  bool last_had_odometry = false;             ///< and whether the log gave odometry for it
  core::Pose2 T_map_robot;

  bool isReference(const lidar::Scan& scan) const;
  /// The step that ends with this scan; T_previous_robot is what the method was fed.
  void note(const lidar::Scan& scan, const core::Pose2& T_previous_robot, const core::Pose2& T_map_after);
};

/// Which motion a method is fed at each step: [method] odometry, as MapBuilder's processScan() has it.
class StepMotions {
 public:
  StepMotions(const MethodOptions& method, const odometry::ScanOdometryOptions& scan_odometry,
              bool goes_on_alone);
  void setCommands(std::vector<robot::Commanded> commands) { commands_ = std::move(commands); }

  /// Errors: MethodError for a motion that is not finite.
  methods::StepMotion next(const StepHistory& history, const lidar::Scan& scan,
                           const core::Pose2& T_previous_robot, bool has_odometry);
  /// The motion as the method took it, which made T_previous_robot of it.
  core::Pose2 asFed(const methods::StepMotion& motion, const core::Pose2& T_previous_robot) const;
  /// Before next(): what the robot was told at this step, as far as anybody knows.
  void noteCommand(const robot::Commanded& commanded, std::uint64_t step, const core::Pose2& T_previous_robot,
                   bool has_odometry);

 private:
  odometry::ScanMotion fromScans(const StepHistory& history, const lidar::Scan& scan);
  methods::StepMotion nextAlone(const StepHistory& history, const lidar::Scan& scan,
                                const core::Pose2& T_previous_robot, bool has_odometry);

  MethodOptions method_;
  odometry::ScanOdometryOptions scan_odometry_options_;
  bool goes_on_alone_;
  std::unique_ptr<odometry::ScanOdometry> scan_odometry_;
  bool scan_odometry_saw_previous_ = false;
  robot::Commanded commanded_;              ///< at this step
  std::vector<robot::Commanded> commands_;  ///< of all steps, where they are known; may be empty
  robot::CommandSeries wheels_commands_;    ///< what the wheels' increments say of it where nobody else does
};

}  // namespace slam::mapping

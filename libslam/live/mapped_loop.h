#pragma once
#include <string>

#include "libslam/mapping/map_builder.h"
#include "libslam/record/step_observer.h"

namespace slam::live {

/// Lets a method map along while a loop runs that builds no map itself, and shows its map and pose to another
/// observer. The loop does not hear of it.
class MappedLoop : public record::StepObserver {
 public:
  MappedLoop(mapping::MapBuilder method, record::StepObserver& next)
      : method_(std::move(method)), next_(next) {}
  /// A method that fails is fed no more: its map stays as it was, the pose goes on by the wheels, and the
  /// note says so.
  void onStep(const record::Step& step) override;

 private:
  mapping::MapBuilder method_;
  record::StepObserver& next_;
  core::Pose2 T_map_robot_;
  std::string failure_;
};

}  // namespace slam::live

#include "libslam/live/mapped_loop.h"

#include "libslam/core/error.h"
#include "libslam/run/log_feed.h"

namespace slam::live {

void MappedLoop::onStep(const record::Step& step) {
  if (failure_.empty()) {
    try {
      if (step.sensed != nullptr) run::tellSensors(method_, *step.sensed);
      T_map_robot_ = mapping::processScan(method_, step.scan, step.T_previous_robot, true, step.commanded);
    } catch (const core::MethodError& error) {
      failure_ = method_.name + " failed: " + error.what();
    }
  }
  record::Step mapped = step;
  if (failure_.empty()) {
    mapped.method = &method_;
  } else {
    if (core::isFinite(step.T_previous_robot)) T_map_robot_ = T_map_robot_ * step.T_previous_robot;
    mapped.note = failure_;
  }
  mapped.T_map_robot = T_map_robot_;
  next_.onStep(mapped);
}

}  // namespace slam::live

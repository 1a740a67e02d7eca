#include "libslam/doctor/log_visitor.h"

#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CSensoryFrame.h>

namespace slam::doctor {

void LogVisitor::visit(const mrpt::serialization::CSerializable& object) {
  using namespace mrpt::obs;
  if (const auto* frame = dynamic_cast<const CSensoryFrame*>(&object)) {
    for (const auto& observation : *frame) takeObservation(*observation, true);
  } else if (const auto* observation = dynamic_cast<const CObservation*>(&object)) {
    takeObservation(*observation, false);
  } else if (const auto* actions = dynamic_cast<const CActionCollection*>(&object)) {
    takeActions(*actions);
  } else {
    takeOther(object);
  }
}

}  // namespace slam::doctor

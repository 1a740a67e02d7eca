#pragma once
#include <optional>
#include <string>

#include "libslam/core/pose2.h"

namespace mrpt::serialization {
class CSerializable;
}
namespace mrpt::obs {
class CActionCollection;
class CObservation;
}  // namespace mrpt::obs

namespace slam::doctor {

/// What a log's objects hold, whichever of MRPT's two forms they have.
class LogVisitor {
 public:
  virtual ~LogVisitor() = default;
  /// Of a frame, one call per observation, in its order.
  virtual void takeObservation(const mrpt::obs::CObservation& observation, bool is_in_frame) = 0;
  virtual void takeActions(const mrpt::obs::CActionCollection& actions) = 0;
  virtual void takeOther(const mrpt::serialization::CSerializable& /*object*/) {}

  void visit(const mrpt::serialization::CSerializable& object);
};

}  // namespace slam::doctor

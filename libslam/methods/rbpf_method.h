#pragma once
#include "libslam/methods/method_type.h"

namespace slam::methods {

/// MRPT's CMetricMapBuilderRBPF, as its rbpf-slam runs it, but for the motion model, which that takes from
/// the log.
MethodType rbpfMethod();

}  // namespace slam::methods

#pragma once
#include "libslam/mapping/method_types.h"

namespace slam::mapping {

/// MRPT's CMetricMapBuilderRBPF, as its rbpf-slam runs it, but for the motion model, which that takes from
/// the log.
MethodType rbpfMethod();

}  // namespace slam::mapping

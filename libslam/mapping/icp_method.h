#pragma once
#include "libslam/mapping/method_types.h"

namespace slam::mapping {

/// MRPT's CMetricMapBuilderICP, as its icp-slam runs it.
MethodType icpMethod();

}  // namespace slam::mapping

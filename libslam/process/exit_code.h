#pragma once
#include <exception>

#include "libslam/core/error.h"

namespace slam::process {

/// What the program returns when this ended it; kFailed for what is no error of core/error.h.
core::ExitCode exitCodeOf(const std::exception& error);

}  // namespace slam::process

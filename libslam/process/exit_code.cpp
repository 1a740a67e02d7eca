#include "libslam/process/exit_code.h"

namespace slam::process {

core::ExitCode exitCodeOf(const std::exception& error) {
  if (dynamic_cast<const core::InputError*>(&error) != nullptr) return core::ExitCode::kBadInput;
  if (dynamic_cast<const core::MethodError*>(&error) != nullptr) return core::ExitCode::kMethodFailed;
  if (dynamic_cast<const core::Interrupted*>(&error) != nullptr) return core::ExitCode::kInterrupted;
  return core::ExitCode::kFailed;
}

}  // namespace slam::process

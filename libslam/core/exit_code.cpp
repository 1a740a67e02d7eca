#include "libslam/core/exit_code.h"

namespace slam::core {

ExitCode exitCodeOf(const std::exception& error) {
  if (dynamic_cast<const InputError*>(&error) != nullptr) return ExitCode::kBadInput;
  if (dynamic_cast<const MethodError*>(&error) != nullptr) return ExitCode::kMethodFailed;
  if (dynamic_cast<const Interrupted*>(&error) != nullptr) return ExitCode::kInterrupted;
  return ExitCode::kFailed;
}

}  // namespace slam::core

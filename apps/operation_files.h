#pragma once
#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "libslam/sim/original_log.h"

namespace slam::apps {

/// An operation log in either form.
struct OperationFile {
  std::vector<sim::Operation> operations;
  bool is_original = false;
};
/// Told by its content. Errors: InputError.
OperationFile readOperationFile(const std::string& path, const sim::OriginalUnits& units);

/// Whether a file's first line is an operation of either form.
bool isOperationFile(const std::string& path);

/// --pixel and --clockwise: what the numbers of the original form mean.
std::shared_ptr<sim::OriginalUnits> addOriginalUnits(CLI::App* command);

}  // namespace slam::apps

#pragma once
#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "libslam/sim/founding_log.h"

namespace slam::apps {

/// An operation log in either form.
struct OperationFile {
  std::vector<sim::Operation> operations;
  bool is_founding = false;
};
/// Told by its content. Errors: InputError.
OperationFile readOperationFile(const std::string& path, const sim::FoundingUnits& units);

/// Whether a file's first line is an operation of either form.
bool isOperationFile(const std::string& path);

/// --pixel and --clockwise: what the numbers of the founding form mean.
std::shared_ptr<sim::FoundingUnits> addFoundingUnits(CLI::App* command);

}  // namespace slam::apps

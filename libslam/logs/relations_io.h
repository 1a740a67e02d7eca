#pragma once
#include <string>

#include "libslam/core/relation.h"

namespace slam::logs {

/// The Freiburg benchmark's ground truth for real logs (Kümmerle et al., Autonomous Robots 27(4), 2009): per
/// line `t1 t2 x y z roll pitch yaw`, the pose of t2 seen from t1, in seconds, metres and radians. z, roll
/// and pitch are dropped. Blank lines and lines that start with # are passed over; no locale. Errors
/// (InputError with file:line): another number of columns, a number that is malformed or not finite, no
/// relation at all; and those of files::readTextFile().
core::Relations readRelations(const std::string& path);

/// The text that reads back to the same but for the sixth decimal. REQUIRES finite numbers and at least one
/// relation (ContractError). Errors: IoError; whole or not at all.
void writeRelations(const core::Relations& relations, const std::string& path);

}  // namespace slam::logs

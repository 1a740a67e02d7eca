#pragma once
#include <string>

#include "libslam/core/relation.h"
#include "libslam/metrics/relation_error.h"
#include "libslam/report/table.h"

namespace slam::run {

/// A row for translation and one for rotation, with the figures of Kümmerle et al. 2009; notes say what was
/// interpolated or could not be scored. `name`: of the trajectory.
report::Table relationTable(const std::string& name, const metrics::RelationError& error);
/// The relations that the trajectory fits worst.
report::Table worstRelationsTable(const core::Relations& relations, const metrics::RelationError& error);

}  // namespace slam::run

#pragma once
#include <string>

#include "libslam/core/pose2.h"
#include "libslam/core/progress.h"
#include "libslam/logs/kept_scans.h"
#include "libslam/metrics/placed_scans.h"
#include "libslam/world/cell_map.h"

namespace slam::results {

/// What a log, a path and a map say of one another, without any truth.
struct SelfScore {
  metrics::PointSharpness sharpness;
  metrics::ScanAgreement agreement;
};

/// Places scan i at path[i]; `map` in the map frame (toCellMap()). REQUIRES one pose per scan, in the order
/// of the log, and that kept.rewind() was true (ContractError). Errors: as logs::KeptScans.
SelfScore selfScore(logs::KeptScans& kept, const core::Trajectory& path, const world::CellMap& map,
                    core::Progress& progress);

/// The same, reading the log (once more). `reads_ahead`: by another thread, see logs::ReadAhead. Errors: as
/// logs::LogReader.
SelfScore selfScore(const std::string& log_path, const core::Trajectory& path, const world::CellMap& map,
                    core::Progress& progress, const std::string& lidars = "", bool reads_ahead = false);

}  // namespace slam::results

#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/metrics/relation_error.h"
#include "libslam/score/evaluate.h"
#include "libslam/table/table.h"

namespace slam::score {

/// How a path fits relations.
struct RelationScore {
  std::string path;  ///< whose: "icp", "rbpf final"
  metrics::RelationError error;
  /// ANEES of the relations, and the share of them within the 95 % region that the method claims for its pose
  /// as the other one sees it: of final paths with relative covariances (results::relationNees()).
  std::optional<double> anees = {}, within_95_share = {};
  /// The same with what the relations err by themselves added to what the method claims, where that is known.
  std::optional<double> anees_annotated = {}, within_95_share_annotated = {};
  std::optional<metrics::AnnotationError> annotation = {};  ///< what they err by, of every path
};

/// Of a run: its path, or where the method corrects its past the final path first and then the one given
/// online.
std::vector<RelationScore> scoreByRelations(const results::RunFolder& run, const core::Relations& relations);

/// One row per path: mean, deviation and maximum of the translational and of the rotational error (Kümmerle
/// et al. 2009), how many relations were scored; kFull also the squares and medians. Where a path has
/// covariances of them the share within the claimed 95 % region, and the same with what the relations err by
/// themselves; kFull also ANEES of both. The notes state how poses at the relations' stamps are found, and
/// what the relations err by.
table::Table relationTable(const std::vector<RelationScore>& scores, Detail detail);

/// The relations that each path fits worst: when, what the relation says, what the path has. kShort puts a
/// motion into one cell, "x y yaw" in metres and degrees; kFull gives each number a column.
table::Table worstRelationsTable(const core::Relations& relations, const std::vector<RelationScore>& scores,
                                 Detail detail);

}  // namespace slam::score

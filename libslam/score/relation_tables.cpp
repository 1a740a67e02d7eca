#include "libslam/score/relation_tables.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "libslam/results/pose_covariances.h"
#include "libslam/results/relative_covariances.h"
#include "libslam/stats/consistency.h"

namespace slam::score {
namespace {

using Row = std::vector<table::CellValue>;

struct Column {
  table::Column column;
  bool only_full;
  double (*of)(const metrics::RelationError&);
};

/// The figures of a row; those that only CSV and JSON show come in their place among the others.
const std::vector<Column>& figures() {
  using E = metrics::RelationError;
  constexpr double kDeg = core::radToDeg(1);
  static const std::vector<Column> columns = {
      {{"translation_mean_m", "m mean", 4}, false, [](const E& e) { return e.translation_m.mean; }},
      {{"translation_deviation_m", "m +-", 4}, false, [](const E& e) { return e.translation_m.deviation; }},
      {{"translation_median_m", "m median", 4}, true, [](const E& e) { return e.translation_m.median; }},
      {{"translation_max_m", "m max", 3}, false, [](const E& e) { return e.translation_m.max; }},
      {{"translation_mean_square_m2", "m2 mean", 5},
       true,
       [](const E& e) { return e.translation_m.mean_square; }},
      {{"translation_square_deviation_m2", "m2 +-", 5},
       true,
       [](const E& e) { return e.translation_m.square_deviation; }},
      {{"rotation_mean_deg", "deg mean", 3}, false, [](const E& e) { return e.rotation_rad.mean * kDeg; }},
      {{"rotation_deviation_deg", "deg +-", 3},
       false,
       [](const E& e) { return e.rotation_rad.deviation * kDeg; }},
      {{"rotation_median_deg", "deg median", 3},
       true,
       [](const E& e) { return e.rotation_rad.median * kDeg; }},
      {{"rotation_max_deg", "deg max", 2}, false, [](const E& e) { return e.rotation_rad.max * kDeg; }},
      {{"rotation_mean_square_deg2", "deg2 mean", 4},
       true,
       [](const E& e) { return e.rotation_rad.mean_square * kDeg * kDeg; }},
      {{"rotation_square_deviation_deg2", "deg2 +-", 4},
       true,
       [](const E& e) { return e.rotation_rad.square_deviation * kDeg * kDeg; }},
      {{"scored", "n", 0}, false, [](const E& e) { return static_cast<double>(e.scored); }},
      {{"interpolated", "off stamp", 0},
       false,
       [](const E& e) { return static_cast<double>(e.interpolated); }},
      {{"unmatched", "unmatched", 0}, true, [](const E& e) { return static_cast<double>(e.unmatched); }},
  };
  return columns;
}

std::string motionText(const core::Pose2& T) {
  char text[80];
  std::snprintf(text, sizeof text, "%.2f %.2f %.1f", T.x, T.y, core::radToDeg(core::wrapToPi(T.phi)));
  return text;
}

/// The last columns, where any path has them.
void addStated(const std::vector<RelationScore>& scores, Detail detail, table::Table& table) {
  if (std::none_of(scores.begin(), scores.end(), [](const auto& score) { return score.anees.has_value(); }))
    return;
  const auto add = [&](const table::Column& column, std::optional<double> RelationScore::*figure) {
    table.columns.push_back(column);
    for (size_t i = 0; i < scores.size(); ++i) {
      const auto& value = scores[i].*figure;
      table.rows[i].push_back(value ? table::CellValue(*value) : table::CellValue(std::string()));
    }
  };
  if (detail == Detail::kFull) add({"anees", "ANEES", 2}, &RelationScore::anees);
  add({"within_95_share", "95 %", 3}, &RelationScore::within_95_share);
  if (std::none_of(scores.begin(), scores.end(),
                   [](const auto& score) { return score.anees_annotated.has_value(); }))
    return;
  if (detail == Detail::kFull)
    add({"anees_annotated", "ANEES annotated", 2}, &RelationScore::anees_annotated);
  add({"within_95_share_annotated", "95 % annotated", 3}, &RelationScore::within_95_share_annotated);
}

std::string ownErrorText(const metrics::AnnotationError& annotation) {
  char text[300];
  std::snprintf(
      text, sizeof text,
      "The relations err by %.4f m and %.3f deg themselves (root mean square), as the gaps tell of %zu "
      "triangles that three of them make.",
      std::sqrt(2.0) * annotation.sigma_xy_m, core::radToDeg(annotation.sigma_turn_rad),
      annotation.triangles);
  return text;
}

bool hasColumn(const table::Table& table, const char* key) {
  return std::any_of(table.columns.begin(), table.columns.end(),
                     [key](const table::Column& column) { return column.key == key; });
}

}  // namespace

std::vector<RelationScore> scoreByRelations(const results::RunFolder& run, const core::Relations& relations) {
  RelationScore online{run.method, metrics::relationError(relations, run.estimate)};
  online.annotation = metrics::annotationError(relations);
  if (!run.final_estimate) return {online};
  online.path += " online";
  RelationScore final_score{run.method + " final", metrics::relationError(relations, *run.final_estimate)};
  final_score.annotation = online.annotation;
  const auto hold = [&](const Eigen::Matrix3d& of_relation, std::optional<double>& anees,
                        std::optional<double>& share) {
    const auto nees =
        results::relationNees(relations, *run.final_estimate, run.relative_covariances, of_relation);
    const auto stated = stats::consistency({nees}, results::kPoseDegreesOfFreedom);
    if (stated) anees = stated->anees.value, share = stated->coverage95.value;
  };
  hold(Eigen::Matrix3d::Zero(), final_score.anees, final_score.within_95_share);
  if (const auto& own = final_score.annotation) {
    const Eigen::Vector3d sigmas(own->sigma_xy_m, own->sigma_xy_m, own->sigma_turn_rad);
    hold(sigmas.cwiseAbs2().asDiagonal(), final_score.anees_annotated, final_score.within_95_share_annotated);
  }
  return {final_score, online};
}

table::Table relationTable(const std::vector<RelationScore>& scores, Detail detail) {
  table::Table table;
  const size_t relations = scores.empty() ? 0 : scores[0].error.scored + scores[0].error.unmatched;
  table.caption = "Error against " + std::to_string(relations) + " relations";
  table.columns = {{"path", "path", 0}};
  for (const auto& score : scores) table.rows.push_back({score.path});
  for (const auto& figure : figures()) {
    if (figure.only_full && detail == Detail::kShort) continue;
    table.columns.push_back(figure.column);
    for (size_t i = 0; i < scores.size(); ++i) table.rows[i].emplace_back(figure.of(scores[i].error));
  }
  addStated(scores, detail, table);
  table.notes = {
      "A relation's pose is the path's with the same stamp, to a microsecond; where there is none it is "
      "interpolated "
      "between the neighbours in time (position on the straight line, heading the shorter way round) and "
      "counted; a "
      "relation with a stamp outside the path's time span is not scored. +- is the sample's standard "
      "deviation."};
  if (hasColumn(table, "within_95_share"))
    table.notes.emplace_back(
        "95 %: share of the relations within the 95 % region that the method claims for them. Were they "
        "exact and the claims true, it were 0.95; what their annotation errs by counts as the method's "
        "error" +
        std::string(hasColumn(table, "within_95_share_annotated")
                        ? "; not so in '95 % annotated', where that is added to what the method claims."
                        : "."));
  if (!scores.empty() && scores[0].annotation) table.notes.push_back(ownErrorText(*scores[0].annotation));
  for (const auto& score : scores)
    if (score.error.unmatched > 0)
      table.notes.push_back(score.path + ": " + std::to_string(score.error.unmatched) +
                            " relations name a stamp outside the path's time span: not scored.");
  return table;
}

table::Table worstRelationsTable(const core::Relations& relations, const std::vector<RelationScore>& scores,
                                 Detail detail) {
  table::Table table;
  table.caption = "Worst relations";
  table.columns = {{"path", "path", 0}, {"from_s", "from (s)", 3}, {"apart_s", "apart (s)", 1}};
  if (detail == Detail::kFull)
    for (const char* key : {"says_x_m", "says_y_m", "says_yaw_deg", "has_x_m", "has_y_m", "has_yaw_deg"})
      table.columns.push_back({key, key, 3});
  else
    for (const char* key : {"says", "has"})
      table.columns.push_back(
          {key, std::string(key == std::string("says") ? "relation says" : "path has"), 0});
  table.columns.push_back({"translation_m", "error m", 3});
  table.columns.push_back({"rotation_deg", "error deg", 2});
  for (const auto& score : scores)
    for (const auto& scored : score.error.worst) {
      const auto& relation = relations[scored.index];
      Row row = {score.path, relation.from_time_s, relation.to_time_s - relation.from_time_s};
      for (const auto& T : {relation.T_from_to, scored.T_from_to}) {
        if (detail == Detail::kFull)
          row.insert(row.end(), {T.x, T.y, core::radToDeg(core::wrapToPi(T.phi))});
        else
          row.emplace_back(motionText(T));
      }
      row.emplace_back(scored.translation_m);
      row.emplace_back(core::radToDeg(scored.rotation_rad));
      table.rows.push_back(std::move(row));
    }
  table.notes = {
      "From a pose at one stamp to the pose that many seconds later, as the relation says and as the path "
      "has it" +
      std::string(detail == Detail::kShort ? ": x y (m) yaw (deg)." : ".")};
  return table;
}

}  // namespace slam::score

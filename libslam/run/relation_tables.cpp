#include "libslam/run/relation_tables.h"

namespace slam::run {
namespace {

using Row = std::vector<report::CellValue>;

Row rowOf(const std::string& name, const metrics::RelationStatistics& s, double unit) {
  return {name,
          s.mean * unit,
          s.deviation * unit,
          s.mean_square * unit * unit,
          s.square_deviation * unit * unit,
          s.median * unit,
          s.max * unit};
}

}  // namespace

report::Table relationTable(const std::string& name, const metrics::RelationError& error) {
  report::Table table;
  table.caption = name + ": error against " + std::to_string(error.scored) + " relations";
  table.columns = {{"error", "error", 0},
                   {"mean", "mean", 4},
                   {"deviation", "std dev", 4},
                   {"mean_square", "mean of squares", 5},
                   {"square_deviation", "their std dev", 5},
                   {"median", "median", 4},
                   {"max", "max", 3}};
  table.rows = {rowOf("translation (m)", error.translation_m, 1),
                rowOf("rotation (deg)", error.rotation_rad, core::radToDeg(1))};
  table.notes.push_back("Squares are in m2 and deg2.");
  if (error.interpolated > 0)
    table.notes.push_back(std::to_string(error.interpolated) +
                          " relations name a stamp between two poses: interpolated.");
  if (error.unmatched > 0)
    table.notes.push_back(std::to_string(error.unmatched) +
                          " relations name a stamp outside the trajectory: not scored.");
  return table;
}

report::Table worstRelationsTable(const core::Relations& relations, const metrics::RelationError& error) {
  report::Table table;
  table.caption = "Worst relations";
  table.columns = {{"from_s", "from (s)", 3},
                   {"to_s", "to (s)", 3},
                   {"translation_m", "translation error (m)", 3},
                   {"rotation_deg", "rotation error (deg)", 2}};
  for (const auto& scored : error.worst)
    table.rows.push_back({relations[scored.index].from_time_s, relations[scored.index].to_time_s,
                          scored.translation_m, core::radToDeg(scored.rotation_rad)});
  return table;
}

}  // namespace slam::run

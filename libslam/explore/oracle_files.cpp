#include "libslam/explore/oracle_files.h"

#include <cmath>
#include <cstdio>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/pictures/picture.h"
#include "libslam/table/table.h"

namespace slam::explore {
namespace {

constexpr const char* kLabel = "known map (oracle)";

core::Trajectory drawn(const std::vector<core::Point2>& path) {
  core::Trajectory trajectory;
  for (const auto& p : path) trajectory.push_back({static_cast<double>(trajectory.size()), {p.x, p.y, 0}});
  return trajectory;
}

}  // namespace

oracle::Oracle askOracle(const world::Plan& plan, const ExploreConfig& config, core::Progress& progress) {
  const auto& record = config.record;
  if (record.camera)
    throw core::InputError("section [sensor], key 'kind': found 'camera', expected 'lidar' with --oracle");
  oracle::TourRequest request;
  request.start_world = core::position(record::startPose(plan, record));
  request.radius_m = robot::circumscribedRadius(record.robot);
  const auto mounting = lidar::trueMountingPose(record.lidar);
  request.lidar_offset_m = core::hypot(mounting.x, mounting.y);
  request.max_range_m = record.lidar.max_range_m;
  request.beam_step_rad = lidar::beamStep(record.lidar);
  const auto area = metrics::explorableArea(plan, request.start_world, request.radius_m, request.max_range_m);
  return oracle::consultOracle(plan, area, request, [&] { progress.update(-1, 0); });
}

void compareWith(const oracle::Oracle& oracle, Exploration& e) {
  e.oracle90_m = oracle.to_90.length_m;
  e.oracle99_m = oracle.to_99.length_m;
  e.below90_m = oracle.below_90_m;
  e.below99_m = oracle.below_99_m;
  // Without a way to go there is nothing to compare.
  e.ratio90 = e.oracle90_m > 0 ? e.figures.path90_m / e.oracle90_m : std::nan("");
  e.ratio99 = e.oracle99_m > 0 ? e.figures.path99_m / e.oracle99_m : std::nan("");
}

draw::Curve oracleCurve(const oracle::Oracle& oracle) {
  draw::Curve curve;
  curve.label = kLabel;
  const auto& tour = std::isfinite(oracle.to_99.length_m) ? oracle.to_99 : oracle.to_90;
  for (const auto& point : tour.curve) curve.points.push_back({point.path_m, 100 * point.share});
  return curve;
}

void writeOracle(const oracle::Oracle& oracle, const world::Plan& plan, const std::string& folder) {
  table::Table table;
  table.columns = {{"to_percent", "to %", 0}, {"path_m", "path m", 3}, {"explored_share", "explored", 6}};
  table::Table places;
  places.columns = {{"to_percent", "to %", 0}, {"x_m", "x m", 3}, {"y_m", "y m", 3}};
  for (const auto* tour : {&oracle.to_90, &oracle.to_99}) {
    for (const auto& point : tour->curve)
      table.rows.push_back({100 * tour->share, point.path_m, point.share});
    for (const auto& p : tour->path) places.rows.push_back({100 * tour->share, p.x, p.y});
  }
  files::writeFileAtomically(folder + "/oracle.csv", table::toCsv(table));
  files::writeFileAtomically(folder + "/oracle_path.csv", table::toCsv(places));
  std::vector<pictures::DrawnPath> paths;
  for (const auto* tour : {&oracle.to_99, &oracle.to_90}) {
    char label[80];
    std::snprintf(label, sizeof label, "known map to %.0f %%: %.1f m", 100 * tour->share, tour->length_m);
    if (!tour->path.empty()) paths.push_back({drawn(tour->path), label});
  }
  pictures::drawMap(plan, paths, plan.name + ": with the plan in hand", folder + "/oracle.png");
}

std::string oracleNote(const oracle::Oracle& oracle) {
  char text[240];
  std::snprintf(
      text, sizeof text,
      "With the plan in hand %.1f m are enough for 90 %% and %.1f m for 99 %%; less than %.1f m and %.1f "
      "m are too little for anybody. Ratios are to the former.",
      oracle.to_90.length_m, oracle.to_99.length_m, oracle.below_90_m, oracle.below_99_m);
  return text;
}

}  // namespace slam::explore

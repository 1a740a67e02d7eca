#include "libslam/truth/movers_log.h"

#include <cmath>
#include <filesystem>
#include <sstream>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/files/csv.h"
#include "libslam/files/parameters.h"
#include "libslam/truth/number_rows.h"
#include "libslam/truth/truth_files.h"

namespace slam::truth {
namespace {

constexpr const char* kEnding = ".movers.csv";

const char* nameOf(movers::PersonState state) {
  switch (state) {
    case movers::PersonState::kWalking:
      return "walking";
    case movers::PersonState::kWaiting:
      return "waiting";
    case movers::PersonState::kPausing:
      return "pausing";
  }
  throw core::ContractError("MoversLog: no such state");
}

const char* nameOf(movers::DoorState state) {
  switch (state) {
    case movers::DoorState::kOpen:
      return "open";
    case movers::DoorState::kClosed:
      return "closed";
    case movers::DoorState::kHeld:
      return "held";
  }
  throw core::ContractError("MoversLog: no such state");
}

/// Millimetres and thousandths of a radian: finer than anything that reads it needs.
std::string rounded(double value) {
  return files::formatNumber(std::round(value * 1000) / 1000 + 0.0);
}

}  // namespace

std::vector<core::Point2> readPeople(const std::string& log_or_truth_path) {
  const std::string path = besideLog(log_or_truth_path, kEnding);
  std::vector<core::Point2> people;
  if (!std::filesystem::exists(path)) return people;
  const auto table = files::CsvTable::read(path);
  const auto kinds = table.texts("kind");
  const auto x_m = table.numbers("x_m"), y_m = table.numbers("y_m");
  for (size_t row = 0; row < kinds.size(); ++row)
    if (kinds[row] == "person") people.push_back({x_m[row], y_m[row]});
  return people;
}

MoversLog::MoversLog(const std::string& path) : file_(path) {
  file_.append("time_s,kind,id,x_m,y_m,heading_rad,state\n");
}

void MoversLog::add(const sim::Simulator& simulator) {
  const auto& scene = simulator.scene();
  const auto& plan = scene.plan();
  const std::string time = files::formatNumber(simulator.time_s());
  std::ostringstream lines;
  if (const auto* crowd = scene.crowd()) {
    size_t id = 0;
    for (const auto& person : crowd->people()) {
      const core::Point2 p = plan.T_frame_raster * person.p;
      const double heading_rad =
          core::wrapToPi(plan.T_frame_raster.phi + core::atan2(person.heading.y, person.heading.x));
      lines << time << ",person," << id++ << ',' << rounded(p.x) << ',' << rounded(p.y) << ','
            << rounded(heading_rad) << ',' << nameOf(person.state) << '\n';
    }
  }
  if (const auto* doors = scene.doors()) {
    const bool is_first = doors_.empty();
    doors_.resize(doors->all().size());
    for (size_t i = 0; i < doors_.size(); ++i) {
      const auto& door = doors->all()[i];
      if (!is_first && doors_[i] == door.state) continue;
      doors_[i] = door.state;
      const core::Point2 p = world::cellsToPoint(
          plan, {0.5 * (door.cells.x0 + door.cells.x1), 0.5 * (door.cells.y0 + door.cells.y1)});
      lines << time << ",door," << door.id << ',' << rounded(p.x) << ',' << rounded(p.y) << ",,"
            << nameOf(door.state) << '\n';
    }
  }
  file_.append(lines.str());
}

void MoversLog::commit() {
  file_.commit();
}

}  // namespace slam::truth

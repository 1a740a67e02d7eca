// Answers that are a method of the student's: run where the student has not seen it.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "libslam/core/error.h"
#include "libslam/core/middle_value.h"
#include "libslam/files/files.h"
#include "libslam/learn/check_answer.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/metrics/trajectory_error.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/run/external_method.h"

namespace slam::learn {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kHidden = 50;  // added to the seed of the drive that the student does not have
constexpr double kShareOfWheels = 0.5;
constexpr double kTurns_rad = 0.02;  // what counts as a turn between two scans

/// The first .ini of an external method in the folder or one below it; "" without one.
std::string methodIn(const std::string& folder) {
  std::vector<std::string> paths;
  for (auto it = fs::recursive_directory_iterator(folder); it != fs::recursive_directory_iterator(); ++it) {
    if (it.depth() > 1) it.disable_recursion_pending();
    if (it.depth() > 1 || it->path().extension() != ".ini" || it->path().filename() == "lesson.ini") continue;
    paths.push_back(it->path().string());
  }
  std::sort(paths.begin(), paths.end());
  for (const auto& path : paths)
    if (run::isExternal(resources::readConfigFile(path))) return path;
  return "";
}

struct Paths {
  core::Trajectory truth, wheels, student;
};

/// What an increment along x, or a turn, is of the true one: the median; 0 where nothing moved by `least`.
double medianRatio(const Paths& paths, double (*part)(const core::Pose2&), double least) {
  std::vector<double> ratios;
  for (std::size_t i = 1; i < paths.student.size() && i < paths.truth.size(); ++i) {
    const double truly = part(core::between(paths.truth[i - 1].pose, paths.truth[i].pose));
    if (std::abs(truly) >= least)
      ratios.push_back(part(core::between(paths.student[i - 1].pose, paths.student[i].pose)) / truly);
  }
  return core::middleValue(ratios);
}

double ahead(const core::Pose2& motion) {
  return motion.x;
}
double turn(const core::Pose2& motion) {
  return motion.phi;
}

/// Whether the student's turns are the reference's in degrees, taken for radians: near those, and far from
/// the right ones.
bool looksLikeDegrees(const core::Trajectory& student, const core::Trajectory& reference) {
  std::vector<double> from_degrees, from_radians;
  for (std::size_t i = 1; i < student.size() && i < reference.size(); ++i) {
    const double turned = turn(core::between(reference[i - 1].pose, reference[i].pose));
    if (std::abs(turned) < kTurns_rad) continue;
    const double found = turn(core::between(student[i - 1].pose, student[i].pose));
    from_degrees.push_back(std::abs(core::angleDifference(found, core::radToDeg(turned))));
    from_radians.push_back(std::abs(core::angleDifference(found, turned)));
  }
  return !from_degrees.empty() && core::middleValue(from_degrees) < 0.7 &&
         core::middleValue(from_radians) > 0.3;
}

bool isWheels(const Paths& paths) {
  for (std::size_t i = 0; i < paths.student.size(); ++i) {
    const auto wheels = core::between(paths.wheels.front().pose, paths.wheels[i].pose);
    if (core::distance(wheels, paths.student[i].pose) > 1e-4) return false;
  }
  return true;
}

std::optional<std::string> hintFor(const Paths& paths) {
  if (isWheels(paths)) return "unchanged";
  const double step = medianRatio(paths, ahead, 0.02), angle = medianRatio(paths, turn, kTurns_rad);
  const auto isNegated = [](double ratio) { return ratio > -1.5 && ratio < -0.5; };
  if (std::abs(step) > 20) return "centimetres";
  if (isNegated(step)) return "backwards";
  if (isNegated(angle)) return "turned_round";
  if (looksLikeDegrees(paths.student, paths.truth) || looksLikeDegrees(paths.student, paths.wheels))
    return "degrees";
  return std::nullopt;
}

std::string percentOf(double share) {
  return files::formatNumber(std::round(100 * share)) + " %";
}

}  // namespace

Verdict checkMethod(const Lesson& lesson, std::uint64_t student, const std::string& folder,
                    core::Progress& progress) {
  const std::string ini_path = methodIn(folder);
  if (ini_path.empty()) return hinted(lesson, Finding::kUnusable, "missing");
  const files::ScratchFolder scratch;
  const Place place{lesson, student, scratch.path(), progress};
  const auto plan = place.makePlan();
  const std::string log_path = scratch / "hidden.rawlog";
  record::record(plan, place.recordConfig(), place.seed() + kHidden, log_path, {}, progress);

  const std::string name = fs::path(ini_path).stem().string();
  const auto config = run::withFixedFolder(resources::readConfigFile(fs::absolute(ini_path).string()));
  run::ExternalRun done;
  try {
    done = run::runExternalMethod(run::readExternalMethod(config), log_path, student, scratch / "work",
                                  progress);
  } catch (const core::InputError& error) {
    auto verdict = hinted(lesson, Finding::kUnusable, "contract", error.what());
    return verdict;
  }
  if (!done.violations.empty()) {
    const std::string& first = done.violations.front();
    const bool has_crashed = first.find("the program ended with") == 0 || first.find("the program was") == 0;
    return hinted(lesson, has_crashed ? Finding::kCrashed : Finding::kWrong,
                  has_crashed ? "crashed" : "contract", core::oneLine(first));
  }
  Paths paths;
  paths.student = done.path;
  paths.truth = logs::readTum(scratch / "hidden.gt.tum");
  logs::LogReader log(log_path);
  while (const auto entry = log.next()) paths.wheels.push_back({entry->scan.time_s, entry->T_odom_robot});

  const auto errorOf = [&](const core::Trajectory& path) {
    return metrics::relativeErrorOverDistance(paths.truth, path, 1);
  };
  const auto wheels = errorOf(paths.wheels), mine = errorOf(paths.student);
  const double place_share = mine.translation_m.rmse / wheels.translation_m.rmse;
  const double heading_share = mine.rotation_rad.rmse / wheels.rotation_rad.rmse;
  const std::string found = name + ": " + percentOf(place_share) +
                            " of the wheels' error per metre in place, " + percentOf(heading_share) +
                            " in heading";
  if (place_share <= kShareOfWheels && heading_share <= kShareOfWheels)
    return {Finding::kRight, "right", found, ""};
  if (const auto hint = hintFor(paths)) return hinted(lesson, Finding::kWrong, *hint, found);
  return {Finding::kWrong, "wrong", found, lesson.options.wrong};
}

}  // namespace slam::learn

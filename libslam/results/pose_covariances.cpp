#include "libslam/results/pose_covariances.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "libslam/core/error.h"
#include "libslam/files/csv.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/metrics/trajectory_error.h"
#include "libslam/stats/consistency.h"

namespace slam::results {
namespace {

constexpr const char* kHeader = "time_s,xx,xy,xphi,yy,yphi,phiphi";
constexpr size_t kColumns = 7;

void append(std::string& line, double value, std::chars_format format, int precision) {
  std::array<char, 400> digits{};  // the largest double has 309 digits before the point
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, format, precision).ptr;
  line.append(digits.data(), end);
}

StampedCovariance covarianceOf(const std::vector<std::string>& fields, const std::string& place) {
  std::array<double, kColumns> values{};
  for (size_t i = 0; i < fields.size(); ++i) {
    double value = 0;
    if (!files::parseNumber(fields[i], value))
      throw core::InputError(place + ": found '" + fields[i] + "', expected a finite number");
    if (i < kColumns) values[i] = value;
  }
  if (fields.size() != kColumns)
    throw core::InputError(place + ": found " + std::to_string(fields.size()) + " numbers, expected 7 (" +
                           kHeader + ")");
  const auto& [time_s, xx, xy, xphi, yy, yphi, phiphi] = values;
  Eigen::Matrix3d covariance;
  covariance << xx, xy, xphi, xy, yy, yphi, xphi, yphi, phiphi;
  return {time_s, covariance};
}

}  // namespace

void writeCovariances(const std::vector<StampedCovariance>& covariances, const std::string& path) {
  std::string text = std::string(kHeader) + "\n";
  for (const auto& stamped : covariances) {
    append(text, stamped.time_s, std::chars_format::fixed, 6);
    const Eigen::Matrix3d covariance = stamped.covariance.matrix();
    for (int row = 0; row < 3; ++row)
      for (int column = row; column < 3; ++column) {
        text += ',';
        append(text, covariance(row, column), std::chars_format::general, 9);
      }
    text += '\n';
  }
  files::writeFileAtomically(path, text);
}

std::vector<StampedCovariance> readCovariances(const std::string& path) {
  const std::string text = files::readTextFile(path);
  files::CsvReader reader(text, path);
  std::vector<StampedCovariance> covariances;
  for (std::vector<std::string> fields; reader.next(fields);) {
    if (reader.line() == 1 && reader.record() == kHeader) continue;
    covariances.push_back(covarianceOf(fields, reader.place()));
  }
  return covariances;
}

std::vector<double> poseNees(const core::Trajectory& truth, const core::Trajectory& estimate,
                             const std::vector<StampedCovariance>& covariances,
                             const std::optional<core::Pose2>& T_world_map_known) {
  if (covariances.size() != estimate.size())
    throw core::ContractError("poseNees: " + std::to_string(covariances.size()) + " covariances for " +
                              std::to_string(estimate.size()) + " poses");
  std::vector<double> nees;
  core::Pose2 T_world_map, T_world_robot;
  if (estimate.empty() || !metrics::poseAt(truth, estimate.front().time_s, T_world_map)) return nees;
  T_world_map = T_world_map_known.value_or(T_world_map);
  for (size_t i = 0; i < estimate.size(); ++i) {
    if (!metrics::poseAt(truth, estimate[i].time_s, T_world_robot)) continue;
    const core::Pose2 T_map_robot = core::between(T_world_map, T_world_robot);
    const core::Pose2& estimated = estimate[i].pose;
    const Eigen::Vector3d error(estimated.x - T_map_robot.x, estimated.y - T_map_robot.y,
                                core::angleDifference(estimated.phi, T_map_robot.phi));
    constexpr double kRounding = 2e-6;
    if (const auto value = stats::normalizedErrorSquared(error, covariances[i].covariance.matrix()))
      nees.push_back(*value);
    else if (error.cwiseAbs().maxCoeff() > kRounding)
      nees.push_back(std::numeric_limits<double>::infinity());
  }
  return nees;
}

}  // namespace slam::results

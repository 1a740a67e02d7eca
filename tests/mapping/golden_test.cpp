// The bytes of all that our own methods say, on three short drives: poses given online and in the end,
// covariances of both, journal. They may only change with a commit that says why, since every published table
// of an older version changes with them.
#include <gtest/gtest.h>

#include <cstring>
#include <map>

#include "libslam/mapping/map_builder.h"
#include "libslam/resources/file_hash.h"
#include "tests/graph/drawn_drives.h"

namespace slam::mapping {
namespace {

using namespace graph::test_drives;

void append(std::string& bytes, const void* data, size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}

void append(std::string& bytes, const Eigen::Matrix3d& matrix) {
  append(bytes, matrix.data(), sizeof(double) * 9);
}

/// Of one method on one drive; every tenth step without odometry where `gaps`; of a lidar that is said to
/// take `sweep_s` for a scan.
std::string fingerprint(const std::string& name, const Drive& log, bool gaps, double sweep_s = 0) {
  auto method = makeMapBuilder(
      loadMethodConfig(std::string(RASTERSLAM_SOURCE_DIR) + "/configs/methods", name), name, 1);
  std::string bytes;
  core::Trajectory online;
  for (size_t i = 0; i < log.scans.size(); ++i) {
    const bool has_odometry = !gaps || i % 10 != 9;
    if (sweep_s > 0) setSweep(method, lidar::Sweep{sweep_s});
    online.push_back(
        {log.scans[i].time_s, processScan(method, log.scans[i], log.increments[i], has_odometry)});
    if (const auto covariance = poseCovariance(method)) append(bytes, *covariance);
  }
  append(bytes, online.data(), online.size() * sizeof(online[0]));
  finishMap(method);
  if (const auto path = finalPath(method, online))
    append(bytes, path->data(), path->size() * sizeof((*path)[0]));
  for (const auto& covariance : finalCovariances(method)) append(bytes, covariance);
  for (const auto& entry : journalOf(method)) {
    bytes += core::wordOf(entry.event) + entry.detail + std::to_string(entry.scan) + " " +
             std::to_string(entry.other_scan);
    append(bytes, &entry.value, sizeof(entry.value));
  }
  return resources::sha256(bytes).substr(0, 16);
}

std::vector<core::Pose2> everyOther(const std::vector<core::Pose2>& path, size_t most) {
  std::vector<core::Pose2> result;
  for (size_t i = 0; i < path.size() && result.size() < most; i += 2) result.push_back(path[i]);
  return result;
}

std::string fingerprints(const std::string& name) {
  // A lap and a bit, so that a loop is closed; a short way with gaps in the odometry; a clean corridor.
  static const Drive kLoop = drive(ring(), everyOther(lapsAround(2), 420), {}, 1e-3);
  static const Drive kGaps = drive(ring(), everyOther(lapsAround(1), 100), {}, 0, 2);
  static const Drive kCorridor = [] {
    std::vector<core::Pose2> path;
    path.reserve(60);
    for (int i = 0; i < 60; ++i) path.push_back({0.1 * i, 0, 0});
    return drive(rectangle(-100, -1, 100, 1), path, {}, 0, 3);
  }();
  return fingerprint(name, kLoop, false) + " " + fingerprint(name, kGaps, true) + " " +
         fingerprint(name, kCorridor, false);
}

TEST(Golden, OurOwnMethodsSayTheSameAsBefore) {
  for (const auto& [name, golden] : std::map<std::string, std::string>{
           {"naive", "16eac7748cb69432 81364e5b5deb9d2e a855a8fcf2b8ea62"},
           {"naive_wheel", "6e46b9189695762a 016392b374fd78df 69c38d9c18c07aa1"},
           {"naive_correlation", "478a941053dae483 ca3829b1bc8ffaa3 69c38d9c18c07aa1"},
           {"naive_flow", "03b3198de8c403c7 02f72b6892ea7eb7 69c38d9c18c07aa1"},
           {"graph", "9067ae9ab68e6982 44bee099b909ac66 1bd851756a452353"},
           {"particles", "8063edeccdfc454c 302e64f0585247c4 5e40c78057ca3e12"}})
    EXPECT_EQ(fingerprints(name), golden) << name;
}

TEST(Golden, OurOwnMethodsSayTheSameOfASpinningLidarAsBefore) {
  static const Drive kGaps = drive(ring(), everyOther(lapsAround(1), 100), {}, 0, 2);
  for (const auto& [name, golden] :
       std::map<std::string, std::string>{{"graph", "c816672f366f21ba"}, {"particles", "8118c87a65369213"}})
    EXPECT_EQ(fingerprint(name, kGaps, true, 0.15), golden) << name;
}

}  // namespace
}  // namespace slam::mapping

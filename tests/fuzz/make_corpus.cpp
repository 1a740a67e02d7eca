// Writes the seeds of the binary formats and of the estimators: make_corpus FOLDER. The same bytes every
// time.
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CSerializable.h>
#include <zlib.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "libslam/bags/ros_logs.h"
#include "libslam/files/files.h"
#include "libslam/logs/log_format.h"
#include "libslam/objects/object_stream.h"

namespace {

using Objects = std::vector<std::shared_ptr<mrpt::serialization::CSerializable>>;

template <class Observation>
std::shared_ptr<Observation> stamped(double time_s, const char* label) {
  auto observation = std::make_shared<Observation>();
  observation->timestamp = mrpt::Clock::fromDouble(time_s);
  observation->sensorLabel = label;
  return observation;
}

/// Two moments of a robot with a lidar of 8 beams, as bare observations.
Objects observations() {
  Objects objects;
  for (int i = 0; i < 2; ++i) {
    const double time_s = 1e9 + i;
    auto odometry = stamped<mrpt::obs::CObservationOdometry>(time_s, "ODOMETRY");
    odometry->odometry = {0.5 * i, 0.25 * i, 0.1 * i};
    objects.push_back(odometry);
    auto scan = stamped<mrpt::obs::CObservation2DRangeScan>(time_s, "scan");
    scan->aperture = 3.0F, scan->maxRange = 20, scan->rightToLeft = true;
    scan->resizeScan(8);
    for (size_t beam = 0; beam < 8; ++beam) {
      scan->setScanRange(beam, 1.0F + static_cast<float>(beam));
      scan->setScanRangeValidity(beam, beam != 3);
    }
    objects.push_back(scan);
  }
  return objects;
}

Objects frames() {
  Objects objects;
  for (const auto& object : observations()) {
    const auto scan = std::dynamic_pointer_cast<mrpt::obs::CObservation2DRangeScan>(object);
    if (!scan) continue;
    auto actions = std::make_shared<mrpt::obs::CActionCollection>();
    mrpt::obs::CActionRobotMovement2D move;
    move.timestamp = scan->timestamp;
    move.computeFromOdometry({0.1, 0, 0.05}, {});
    actions->insert(move);
    objects.push_back(actions);
    auto frame = std::make_shared<mrpt::obs::CSensoryFrame>();
    frame->insert(scan);
    objects.push_back(frame);
  }
  return objects;
}

void write(const Objects& objects, std::unique_ptr<slam::objects::ObjectSink> sink) {
  for (const auto& object : objects) sink->write(*object);
  sink->close();
}

std::string folderOf(const std::string& corpus, const char* name) {
  std::filesystem::create_directories(corpus + "/" + name);
  return corpus + "/" + name + "/";
}

/// Packed data hide every change behind a checksum; a fuzzer needs the plain bytes.
void unpack(const std::string& packed, const std::string& plain) {
  gzFile in = gzopen(packed.c_str(), "rb");
  std::ofstream out(plain, std::ios::binary);
  std::vector<char> buffer(1 << 16);
  for (int got = 0; (got = gzread(in, buffer.data(), static_cast<unsigned>(buffer.size()))) > 0;)
    out.write(buffer.data(), got);
  gzclose(in);
}

using Step = std::array<std::uint8_t, 4>;  // see ScanScript

std::vector<Step> repeated(const std::vector<Step>& steps, int times) {
  std::vector<Step> all;
  for (int i = 0; i < times; ++i) all.insert(all.end(), steps.begin(), steps.end());
  return all;
}

/// As the fuzzer found it: among its readings are finite ones of 3e38 m, of which an index overflowed.
constexpr std::uint8_t kReadingOf1e38_m[] = {
    255, 79, 60, 255, 0, 120, 19, 9, 20, 4,  145, 77, 251, 90, 69, 3, 100, 3,  254, 30, 178, 128, 64, 107,
    3,   80, 20, 4,   3, 78,  20, 4, 4,  90, 25,  8,  3,   80, 20, 4, 3,   78, 20,  4,  4,   90,  89, 8,
    3,   80, 20, 4,   3, 78,  20, 4, 4,  90, 25,  8,  3,   80, 20, 4, 3,   78, 20,  4,  4,   90,  25, 8,
    3,   80, 20, 4,   3, 78,  20, 4, 4,  90, 25,  8,  3,   80, 20, 4, 3,   78, 20,  4,  4,   90,  25, 8,
    3,   80, 20, 4,   3, 78,  20, 4, 4,  90, 25,  8,  3,   80, 20, 4, 3,   78, 20,  4,  4,   90,  25, 8,
    3,   80, 20, 4,   3, 78,  20, 4, 4,  90, 25,  8,  3,   80, 20, 4, 3,   78, 20,  4,  4,   90,  25, 8,
    3,   80, 20, 4,   3, 78,  20, 4, 4,  90, 25,  14, 0,   0,  0,  7, 0,   0,  0,   35, 70};

/// A drive through rooms and corridors for each estimator; and two that nobody would make.
void writeDrives(const std::string& folder) {
  const auto write = [&folder](const std::string& name, const std::vector<std::uint8_t>& head,
                               const std::vector<std::vector<Step>>& parts) {
    std::ofstream out(folder + name, std::ios::binary);
    for (const std::uint8_t byte : head) out.put(static_cast<char>(byte));
    for (const auto& part : parts)
      for (const Step& step : part)
        for (const std::uint8_t byte : step) out.put(static_cast<char>(byte));
  };
  const std::vector<Step> look_about = {{3, 80, 20, 4}, {3, 78, 20, 4}, {4, 90, 25, 8}};
  const auto room = repeated(look_about, 12), short_room = repeated(look_about, 4);
  const std::vector<Step> way = repeated({{2, 40, 30, 0}}, 10), turn = repeated({{3, 80, 10, 30}}, 4),
                          short_way = repeated({{2, 40, 30, 0}}, 6), blind = repeated({{6, 0, 20, 0}}, 3);
  write("graph", {255, 79, 178, 128, 64, 107}, {room, way, turn, room});
  write("localised", {254, 30, 178, 128, 64, 107}, {room, blind, room});
  write("particles", {5, 0, 178, 128, 64, 107}, {room, way, turn});
  for (std::uint8_t i = 0; i < 5; ++i)
    write("odometry" + std::to_string(i), {i, 0, 178, 128, 64, 107}, {short_room, short_way});
  const std::vector<Step> spoilt = {{19, 9, 20, 4}, {145, 77, 251, 90}, {69, 3, 100, 3},
                                    {14, 0, 0, 0},  {7, 0, 0, 0},       {35, 70, 20, 4}};
  write("spoilt", {255, 79, 60, 255, 0, 120}, {repeated(spoilt, 8)});
  write("reading_of_1e38_m", {std::begin(kReadingOf1e38_m), std::end(kReadingOf1e38_m)}, {});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_corpus FOLDER\n";
    return 2;
  }
  using namespace slam;
  const std::string corpus = argv[1];
  const std::string rawlog = folderOf(corpus, "rawlog"), format = folderOf(corpus, "log_format");
  const std::string packed = format + "frames.rawlog";
  write(frames(), logs::createLog(packed, logs::LogFormat::kRawlog));
  unpack(packed, rawlog + "frames.rawlog");
  const std::string bare = format + "observations.rawlog";
  write(observations(), logs::createLog(bare, logs::LogFormat::kRawlog));
  unpack(bare, rawlog + "observations.rawlog");
  write(observations(), bags::createRos1Bag(folderOf(corpus, "ros1_bag") + "a.bag"));
  write(observations(), bags::createRos2Db3(folderOf(corpus, "ros2_db3") + "a.db3"));
  for (const char* compression : {"none", "lz4", "zstd"}) {
    bags::McapWriteOptions options;
    options.compression = compression;
    options.ros1 = std::string(compression) == "lz4";
    write(observations(), bags::createMcap(folderOf(corpus, "mcap") + compression + ".mcap", options));
  }
  writeDrives(folderOf(corpus, "estimators"));
  return 0;
}

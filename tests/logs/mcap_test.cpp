#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "libslam/bags/ros_bytes.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"
#include "tests/logs/ros_fixtures.h"

namespace slam::logs {
namespace {

using mrpt::obs::CObservation2DRangeScan;
using mrpt::obs::CObservationRobotPose;
using ::testing::HasSubstr;

// --- Files made by hand -----------------------------------------------------------------------------------

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);

std::string text(const std::string& content) {
  std::string bytes;
  bags::appendSized<std::uint32_t>(bytes, content);
  return bytes;
}
template <class... Numbers>
std::string numbers(Numbers... values) {
  std::string bytes;
  (bags::appendNumberBytes(bytes, values), ...);
  return bytes;
}
std::string record(std::uint8_t op, const std::string& content) {
  return numbers(op, static_cast<std::uint64_t>(content.size())) + content;
}
std::string schema() {
  return record(3,
                numbers(std::uint16_t{1}) + text("sensor_msgs/msg/LaserScan") + text("ros2msg") + text(""));
}
std::string channel(const std::string& encoding = "cdr") {
  return record(4, numbers(std::uint16_t{5}, std::uint16_t{1}) + text("/scan") + text(encoding) + text(""));
}
std::string message(std::uint16_t channel_id = 5) {
  const std::uint64_t time = kRosStart_ns;
  return record(5, numbers(channel_id, std::uint32_t{0}, time, time) +
                       bags::encodeRos(bags::RosEncoding::kCdr, laserScan("laser", {1, 2, 3})));
}
std::string chunk(const std::string& records, const std::string& compression = "", std::uint32_t crc = 0,
                  std::uint64_t size_error = 0) {
  std::string content = numbers(std::uint64_t{0}, std::uint64_t{0}, records.size() + size_error, crc);
  content += text(compression);
  bags::appendSized<std::uint64_t>(content, bags::pack(compression, records));
  return record(6, content);
}
std::string whole(const std::string& data) {
  return std::string(kMagic) + record(1, text("") + text("")) + data + record(15, numbers(std::uint32_t{0})) +
         record(2, numbers(std::uint64_t{0}, std::uint64_t{0}, std::uint32_t{0})) + std::string(kMagic);
}

struct Reading {
  size_t objects = 0;
  std::string error;
};
Reading readBytesAsMcap(const std::string& bytes) {
  const testing::TempFolder folder;
  const auto path = folder / "log.mcap";
  writeBytes(bytes, path);
  Reading reading;
  reading.error = testing::errorOf([&] {
    const auto source = bags::openMcap(path);
    while (source->next()) ++reading.objects;
  });
  const auto at = reading.error.find(path + ": ");
  if (at == 0) reading.error.erase(0, path.size() + 2);
  return reading;
}

TEST(Mcap, NeedsNeitherChunksNorSummary) {
  const auto reading = readBytesAsMcap(whole(schema() + channel() + message() + message()));
  EXPECT_EQ(reading.error, "no error");
  EXPECT_EQ(reading.objects, 2U);
}

TEST(Mcap, PassesOverRecordsThatItDoesNotKnow) {
  const auto reading =
      readBytesAsMcap(whole(record(0x90, std::string(3'000'000, 'x')) + schema() + channel() + message()));
  EXPECT_EQ(reading.error, "no error");
  EXPECT_EQ(reading.objects, 1U);
}

TEST(Mcap, PassesOverOtherEncodings) {
  const auto reading = readBytesAsMcap(whole(schema() + channel("json") + message()));
  EXPECT_EQ(
      reading.error,
      "holds only 1 message of 1 topic (/scan sensor_msgs/LaserScan encoded as json), expected laser scans "
      "(sensor_msgs/LaserScan) or odometry (nav_msgs/Odometry)");
}

// Found by fuzzing: a damaged name broke the error's one line.
TEST(Mcap, KeepsDamagedNamesWithinOneLine) {
  const auto odd = record(4, numbers(std::uint16_t{5}, std::uint16_t{1}) +
                                 text("/sc\nan" + std::string(500, 'x')) + text("j\rson") + text(""));
  const auto reading = readBytesAsMcap(whole(schema() + odd + message()));
  EXPECT_EQ(reading.error, "holds only 1 message of 1 topic (/sc an" + std::string(124, 'x') + " ... " +
                               std::string(65, 'x') +
                               " sensor_msgs/LaserScan encoded as j son), expected laser scans "
                               "(sensor_msgs/LaserScan) or odometry (nav_msgs/Odometry)");
}

TEST(Mcap, ChecksTheSumOfAChunk) {
  const auto records = schema() + channel() + message();
  const auto crc = static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const unsigned char*>(records.data()),
                                                    static_cast<unsigned>(records.size())));
  EXPECT_EQ(readBytesAsMcap(whole(chunk(records, "", crc))).error, "no error");
  EXPECT_EQ(
      readBytesAsMcap(whole(chunk(records, "lz4", crc + 1))).error,
      "damaged MCAP file: record at byte 25, after 0 messages: the check sum of the chunk does not fit");
}

TEST(Mcap, ChecksTheSumsOfDataAndSummary) {
  const testing::TempFolder folder;
  bags::McapWriteOptions options;
  options.compression = "none";
  writeAll(drive(20), *bags::createMcap(folder / "log.mcap", options));
  const auto bytes = readBytes(folder / "log.mcap");
  auto in_data = bytes, in_summary = bytes;
  in_data[8 + 9 + 4] = 'R';  // the profile in the header, which nothing else covers
  const auto summary_text = bytes.rfind("sensor_msgs/msg/LaserScan");
  in_summary[summary_text] = 'S';
  EXPECT_THAT(readBytesAsMcap(in_data).error, HasSubstr("the check sum of the data section does not fit"));
  EXPECT_EQ(readBytesAsMcap(in_data).objects, 60U);
  EXPECT_THAT(readBytesAsMcap(in_summary).error, HasSubstr("the check sum of the summary does not fit"));
}

TEST(Mcap, SaysWhatIsWrongWithAChunk) {
  const auto records = schema() + channel() + message();
  const auto errorOfChunk = [&](const std::string& compression, std::uint64_t size_error) {
    return readBytesAsMcap(whole(chunk(records, compression, 0, size_error))).error;
  };
  EXPECT_THAT(errorOfChunk("xz", 0), HasSubstr("a chunk compressed as 'xz', expected lz4, zstd or none"));
  for (const char* compression : {"zstd", "lz4"}) {
    EXPECT_THAT(errorOfChunk(compression, 1), HasSubstr("a chunk unpacks to")) << compression;
    EXPECT_THAT(errorOfChunk(compression, ~std::uint64_t{9}), HasSubstr("more than the")) << compression;
    EXPECT_THAT(errorOfChunk(compression, std::uint64_t{1} << 40), HasSubstr("expected at most 1073741824"));
  }
  EXPECT_THAT(errorOfChunk("", 1), HasSubstr("a chunk without its end"));
}

TEST(Mcap, NeedsEveryChannelIntroduced) {
  EXPECT_THAT(readBytesAsMcap(whole(schema() + channel() + message(6))).error,
              HasSubstr("a message of channel 6, which was not introduced"));
}

TEST(Mcap, WithoutItsEndGivesWhatIsThereThenSaysSo) {
  const auto bytes = whole(chunk(schema() + channel() + message()) + chunk(message() + message()));
  const size_t record_bytes = message().size();
  // The second chunk, not packed, loses half of its last message.
  const auto cut = bytes.substr(0, bytes.size() - 8 - 29 - 13 - record_bytes / 2);
  const auto reading = readBytesAsMcap(cut);
  EXPECT_EQ(reading.objects, 2U);
  EXPECT_THAT(reading.error, ::testing::StartsWith("truncated MCAP file: record at byte "));
  EXPECT_THAT(
      reading.error,
      ::testing::EndsWith(", after 2 messages: the file ends before its footer (cut off, or its recorder "
                          "did not finish it)"));
}

// --- Foxglove's library on Node
// -----------------------------------------------------------------------------

// After the magic, the opcode and the length of the header, and its own length.
TEST(Mcap, TheHeaderSaysWhoseMessagesTheyAre) {
  const testing::TempFolder folder;
  for (const bool ros1 : {false, true}) {
    bags::McapWriteOptions options;
    options.ros1 = ros1;
    writeAll(drive(3), *bags::createMcap(folder / "log.mcap", options));
    EXPECT_EQ(files::readTextFile(folder / "log.mcap").substr(8 + 9 + 4, 4), ros1 ? "ros1" : "ros2");
  }
}

class McapNpm : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string folder = std::string(RASTERSLAM_BINARY_DIR) + "/mcap_npm";
    if (!testing::programExists("node"))
      GTEST_SKIP() << "Node is not installed: MCAP is not compared with npm's";
    if (!std::filesystem::exists(folder + "/node_modules/@mcap/core"))
      GTEST_SKIP() << "npm's @mcap/core is not there (cmake --build --target mcap_oracle fetches it)";
    oracle_ = "node " + folder + "/oracle.mjs ";
  }
  std::string run(const std::string& arguments) {
    const auto result = testing::runCommand(oracle_ + arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  }

  testing::TempFolder folder_;
  std::string oracle_;
};

TEST_F(McapNpm, FindsEverythingInOurFiles) {
  for (const char* compression : {"none", "lz4", "zstd"}) {
    for (const bool ros1 : {false, true}) {
      bags::McapWriteOptions options;
      options.compression = compression;
      options.ros1 = ros1;
      const auto path = folder_ / "log.mcap";
      writeAll(drive(3000), *bags::createMcap(path, options));
      const auto found = nlohmann::json::parse(run("read " + path));
      EXPECT_EQ(found["header"]["profile"], ros1 ? "ros1" : "ros2");
      EXPECT_EQ(found["messageCount"], "12001");
      EXPECT_EQ(found["chunkCount"], found["chunkIndexes"]);
      EXPECT_GE(found["chunkCount"], 4);
      EXPECT_EQ(found["compressions"][0], std::string(compression) == "none" ? "" : compression);
      EXPECT_EQ(found["summaryOffsets"], 4);
      EXPECT_EQ(found["streamDone"], true);
      EXPECT_EQ(found["increasing"], true);
      EXPECT_EQ(found["topics"]["/scan"]["count"], 3000);
      EXPECT_EQ(found["topics"]["/scan"]["schema"],
                ros1 ? "sensor_msgs/LaserScan" : "sensor_msgs/msg/LaserScan");
      EXPECT_EQ(found["topics"]["/tf_static"]["count"], 1);
      const auto& scan = found["firsts"]["/scan"];
      EXPECT_EQ(scan["header"]["stamp"]["sec"], 1'700'000'000);
      EXPECT_EQ(scan["header"]["stamp"][ros1 ? "nsec" : "nanosec"], 123'456'700);
      EXPECT_EQ(scan["header"]["frame_id"], "laser");
      EXPECT_EQ(scan["ranges"].size(), 7U);
      EXPECT_EQ(scan["ranges"][1].get<float>(), 2.2F);
      EXPECT_EQ(scan["ranges"][2], "Infinity");
      EXPECT_EQ(scan["ranges"][3], "NaN");
      const auto& mount = found["firsts"]["/tf_static"]["transforms"][0];
      EXPECT_EQ(mount["transform"]["translation"]["y"], -0.125);
      EXPECT_EQ(mount["child_frame_id"], "laser");
      EXPECT_EQ(found["firsts"]["/odom"]["child_frame_id"], "base_link");
      EXPECT_EQ(found["firsts"]["/ground_truth"]["pose"]["position"]["y"], 2);
    }
  }
}

TEST_F(McapNpm, WritesFilesThatWeRead) {
  for (const char* mode : {"unchunked", "chunks", "zstd", "ros1"}) {
    const auto path = folder_ / "npm.mcap";
    run("write " + path + " " + mode);
    const auto source = bags::openMcap(path);
    const auto objects = readAll(*source);
    const auto scans = only<CObservation2DRangeScan>(objects);
    const auto truth = only<CObservationRobotPose>(objects);
    ASSERT_EQ(scans.size(), 300U) << mode;
    ASSERT_EQ(truth.size(), 300U) << mode;
    for (size_t i = 0; i < scans.size(); ++i) {
      const auto& scan = *scans[i];
      EXPECT_EQ(stampNs(scan), (1'600'000'000 + static_cast<std::int64_t>(i)) * 1'000'000'000 + 700);
      EXPECT_EQ(scan.sensorLabel, "front/scan");
      EXPECT_EQ(scan.aperture, 2);
      ASSERT_EQ(scan.getScanSize(), 90U);
      for (size_t k = 0; k < 90; ++k) {
        EXPECT_EQ(scan.getScanRangeValidity(k), k != 7 && k != 8);
        if (k == 7 || k == 8) continue;
        EXPECT_EQ(scan.getScanRange(k), 0.125 * static_cast<double>(k + 1) + static_cast<double>(i) / 64);
      }
      EXPECT_EQ(truth[i]->pose.mean.x(), static_cast<double>(i) / 8);
    }
  }
}

}  // namespace
}  // namespace slam::logs

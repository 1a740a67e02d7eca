#include "libslam/bags/ros_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/evp.h>

#include <limits>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/testing/error_of.h"

#ifdef RASTERSLAM_HAS_FASTCDR
#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#endif

namespace slam::logs {
namespace {

using ::testing::HasSubstr;

bags::RosLaserScan sampleScan() {
  bags::RosLaserScan scan;
  scan.header = {1'700'000'000'987'654'321, "base_laser"};
  scan.angle_min = -1.5F;
  scan.angle_max = 1.5F;
  scan.angle_increment = 0.75F;
  scan.time_increment = 0.001F;
  scan.scan_time = 0.1F;
  scan.range_min = 0.05F;
  scan.range_max = 25.5F;
  scan.ranges = {1.25F, std::numeric_limits<float>::infinity(), 3.5F, 4.75F, 0.1F};
  scan.intensities = {10, 20, 30};
  return scan;
}

bags::RosOdometry sampleOdometry() {
  bags::RosOdometry odometry;
  odometry.header = {-1'500'000'000, "odom"};
  odometry.child_frame_id = "base";
  odometry.pose = {{1.5, -2.5, 3.5}, {0.1, 0.2, 0.3, 0.9}};
  for (size_t i = 0; i < 36; ++i) odometry.pose_covariance[i] = 0.5 * static_cast<double>(i);
  odometry.linear = {4, 5, 6};
  odometry.angular = {7, 8, 9};
  for (size_t i = 0; i < 36; ++i) odometry.twist_covariance[i] = -0.5 * static_cast<double>(i);
  return odometry;
}

bags::RosTransforms sampleTransforms() {
  return {{{{1, "a"}, "bcd", {1, 2, 3}, {0, 0, 0, 1}}, {{2, "efghi"}, "", {4, 5, 6}, {0, 0, 1, 0}}}};
}

void expectSame(const bags::RosLaserScan& a, const bags::RosLaserScan& b) {
  EXPECT_EQ(a.header.stamp_ns, b.header.stamp_ns);
  EXPECT_EQ(a.header.frame_id, b.header.frame_id);
  EXPECT_EQ(a.angle_increment, b.angle_increment);
  EXPECT_EQ(a.range_max, b.range_max);
  EXPECT_EQ(a.ranges, b.ranges);
  EXPECT_EQ(a.intensities, b.intensities);
}

TEST(RosMessages, ComeBackFromBothForms) {
  for (const auto form : {bags::RosEncoding::kRos1, bags::RosEncoding::kCdr}) {
    expectSame(bags::decodeRos<bags::RosLaserScan>(form, bags::encodeRos(form, sampleScan())), sampleScan());
    const auto transforms =
        bags::decodeRos<bags::RosTransforms>(form, bags::encodeRos(form, sampleTransforms()));
    ASSERT_EQ(transforms.transforms.size(), 2U);
    EXPECT_EQ(transforms.transforms[1].header.frame_id, "efghi");
    EXPECT_EQ(transforms.transforms[1].child_frame_id, "");
    EXPECT_EQ(transforms.transforms[1].translation.z, 6);
    EXPECT_EQ(transforms.transforms[1].rotation.z, 1);
    bags::RosMultiEchoLaserScan echoes;
    echoes.ranges = {{1, 2}, {}, {3}};
    EXPECT_EQ(bags::decodeRos<bags::RosMultiEchoLaserScan>(form, bags::encodeRos(form, echoes)).ranges,
              echoes.ranges);
  }
  const auto odometry = bags::decodeRos<bags::RosOdometry>(
      bags::RosEncoding::kCdr, bags::encodeRos(bags::RosEncoding::kCdr, sampleOdometry()));
  EXPECT_EQ(odometry.header.stamp_ns, -1'500'000'000);
  EXPECT_EQ(odometry.twist_covariance, sampleOdometry().twist_covariance);
}

// Byte by byte, from the rules of CDR alone: head 0 0 is big-endian, numbers are aligned to their size
// counted from after the head, texts carry a closing zero.
TEST(RosMessages, AreReadBigEndian) {
  const std::string bytes(
      "\0\0\0\0"                          // head
      "\0\0\0\5\0\0\0\7"                  // 5 s, 7 ns
      "\0\0\0\4map\0"                     // frame
      "\x3F\xF8\0\0\0\0\0\0"              // x 1.5, at 16
      "\xC0\x04\0\0\0\0\0\0"              // y -2.5
      "\0\0\0\0\0\0\0\0"                  // z
      "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"  // qx, qy
      "\0\0\0\0\0\0\0\0"                  // qz
      "\x3F\xF0\0\0\0\0\0\0",             // qw 1
      4 + 16 + 56);
  const auto pose = bags::decodeRos<bags::RosPoseStamped>(bags::RosEncoding::kCdr, bytes);
  EXPECT_EQ(pose.header.stamp_ns, 5'000'000'007);
  EXPECT_EQ(pose.header.frame_id, "map");
  EXPECT_EQ(pose.pose.position.x, 1.5);
  EXPECT_EQ(pose.pose.position.y, -2.5);
  EXPECT_EQ(pose.pose.orientation.w, 1);
}

TEST(RosMessages, OfEveryCutLengthAreRefused) {
  for (const auto form : {bags::RosEncoding::kRos1, bags::RosEncoding::kCdr}) {
    const auto bytes = bags::encodeRos(form, sampleScan());
    for (size_t length = 0; length < bytes.size(); ++length)
      EXPECT_THROW(bags::decodeRos<bags::RosLaserScan>(form, std::string_view(bytes).substr(0, length)),
                   core::InputError)
          << length;
    EXPECT_THROW(bags::decodeRos<bags::RosLaserScan>(form, bytes + "12345"), core::InputError);
  }
  // Some middleware pads a message to four bytes.
  EXPECT_NO_THROW(bags::decodeRos<bags::RosLaserScan>(
      bags::RosEncoding::kCdr, bags::encodeRos(bags::RosEncoding::kCdr, sampleScan()) + "123"));
}

TEST(RosMessages, TakeNoMemoryForALengthThatCannotBe) {
  auto scan = sampleScan();
  scan.header.frame_id = "";
  auto bytes = bags::encodeRos(bags::RosEncoding::kRos1, scan);
  const size_t at = 4 + 8 + 4 + 7 * 4;  // sequence, stamp, length of the frame, seven numbers
  bytes.replace(at, 4, "\xFF\xFF\xFF\xFF");
  EXPECT_EQ(testing::errorOf([&] { bags::decodeRos<bags::RosLaserScan>(bags::RosEncoding::kRos1, bytes); }),
            "a list of numbers of length 4294967295 does not fit into the 36 bytes left");
  EXPECT_THAT(testing::errorOf([] {
                bags::decodeRos<bags::RosTransforms>(bags::RosEncoding::kRos1,
                                                     std::string("\xFF\xFF\xFF\x00zzzzzzzz", 12));
              }),
              HasSubstr("a list of length 16777215 does not fit into the 8 bytes left"));
}

TEST(RosMessages, SayThatCdrIsCompressedOrNone) {
  EXPECT_EQ(testing::errorOf([] {
              bags::decodeRos<bags::RosLaserScan>(bags::RosEncoding::kCdr,
                                                  std::string("\x28\xB5\x2F\xFD....", 8));
            }),
            "its first two bytes are 40 181, expected 0 0 or 0 1 (plain CDR, not compressed)");
}

TEST(RosMessages, HoldTheStampsThatTheirNumbersReach) {
  EXPECT_TRUE(bags::rosCanHold(bags::RosEncoding::kRos1, 4'294'967'295'999'999'999));
  EXPECT_FALSE(bags::rosCanHold(bags::RosEncoding::kRos1, 4'294'967'296'000'000'000));
  EXPECT_FALSE(bags::rosCanHold(bags::RosEncoding::kRos1, -1));
  EXPECT_TRUE(bags::rosCanHold(bags::RosEncoding::kCdr, -1));
  EXPECT_FALSE(bags::rosCanHold(bags::RosEncoding::kCdr, 2'147'483'648'000'000'000));
  auto scan = sampleScan();
  scan.header.stamp_ns = -1;
  EXPECT_THROW(bags::encodeRos(bags::RosEncoding::kRos1, scan), core::ContractError);
}

std::string md5(const std::string& text) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned size = 0;
  EVP_Digest(text.data(), text.size(), digest, &size, EVP_md5(), nullptr);
  std::string hex;
  for (unsigned i = 0; i < size; ++i) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", digest[i]);
    hex += digits;
  }
  return hex;
}

/// ROS 1's sum by its rule (wiki.ros.org/ROS/Technical%20Overview): of the definition's lines, where a type
/// that is not built in is replaced by that type's own sum.
std::string sumOf(const std::string& type, const std::map<std::string, std::string>& definitions) {
  std::istringstream lines(definitions.at(type));
  std::string line, text;
  while (std::getline(lines, line)) {
    const auto space = line.find(' ');
    std::string field_type = line.substr(0, space);
    const auto bracket = field_type.find('[');
    const std::string plain = field_type.substr(0, bracket);
    if (definitions.count(plain)) field_type = sumOf(plain, definitions);
    text += (text.empty() ? "" : "\n") + field_type + line.substr(space);
  }
  return md5(text);
}

TEST(RosMessages, HaveTheSumsThatTheirDefinitionsGive) {
  for (const char* type : {bags::kLaserScanType, bags::kMultiEchoType, bags::kOdometryType,
                           bags::kPoseStampedType, bags::kTransformsType, bags::kOldTransformsType}) {
    std::map<std::string, std::string> definitions;
    std::string name = type;
    std::istringstream lines(bags::rosDefinition(bags::RosEncoding::kRos1, type));
    std::string line;
    while (std::getline(lines, line)) {
      if (line.front() == '=') continue;
      if (line.substr(0, 5) == "MSG: ")
        name = line.substr(5);
      else
        definitions[name] += line + "\n";
    }
    EXPECT_EQ(bags::rosMd5(type), sumOf(type, definitions)) << type;
  }
  EXPECT_EQ(bags::rosMd5("sensor_msgs/Image"), "");
}

TEST(RosMessages, ChangeBetweenBothWaysToNameAType) {
  EXPECT_EQ(bags::withMsg("nav_msgs/Odometry"), "nav_msgs/msg/Odometry");
  EXPECT_EQ(bags::withoutMsg("nav_msgs/msg/Odometry"), "nav_msgs/Odometry");
  EXPECT_EQ(bags::withoutMsg("nav_msgs/Odometry"), "nav_msgs/Odometry");
}

#ifdef RASTERSLAM_HAS_FASTCDR

using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

// Debian 12 has Fast-CDR 1, Debian 13 the second, with other names.
#if __has_include(<fastcdr/CdrEncoding.hpp>)
constexpr auto kDdsCdr = eprosima::fastcdr::DDS_CDR;
size_t lengthOf(const Cdr& cdr) {
  return cdr.get_serialized_data_length();
}
#else
constexpr auto kDdsCdr = Cdr::DDS_CDR;
size_t lengthOf(const Cdr& cdr) {
  return cdr.getSerializedDataLength();
}
#endif

/// Fast-CDR, ROS 2's own serializer, as the other side.
TEST(RosMessages, AreReadByFastCdr) {
  auto bytes = bags::encodeRos(bags::RosEncoding::kCdr, sampleScan());
  FastBuffer buffer(bytes.data(), bytes.size());
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, kDdsCdr);
  cdr.read_encapsulation();
  std::int32_t seconds = 0;
  std::uint32_t nanoseconds = 0;
  std::string frame;
  float angle_min = 0, angle_max = 0, increment = 0, time_increment = 0, scan_time = 0, range_min = 0,
        range_max = 0;
  std::vector<float> ranges, intensities;
  cdr >> seconds >> nanoseconds >> frame >> angle_min >> angle_max >> increment >> time_increment >>
      scan_time >> range_min >> range_max >> ranges >> intensities;
  EXPECT_EQ(seconds, 1'700'000'000);
  EXPECT_EQ(nanoseconds, 987'654'321U);
  EXPECT_EQ(frame, "base_laser");
  EXPECT_EQ(angle_min, -1.5F);
  EXPECT_EQ(range_max, 25.5F);
  EXPECT_EQ(ranges, sampleScan().ranges);
  EXPECT_EQ(intensities, sampleScan().intensities);
  EXPECT_EQ(lengthOf(cdr), bytes.size());
}

TEST(RosMessages, OfFastCdrAreReadInBothByteOrders) {
  for (const auto order : {Cdr::BIG_ENDIANNESS, Cdr::LITTLE_ENDIANNESS}) {
    FastBuffer buffer;
    Cdr cdr(buffer, order, kDdsCdr);
    cdr.serialize_encapsulation();
    const auto odometry = sampleOdometry();
    cdr << std::int32_t{-2} << std::uint32_t{500'000'000} << std::string("odom") << std::string("base");
    const auto& [position, q] = odometry.pose;
    cdr << position.x << position.y << position.z << q.x << q.y << q.z << q.w << odometry.pose_covariance;
    cdr << odometry.linear.x << odometry.linear.y << odometry.linear.z;
    cdr << odometry.angular.x << odometry.angular.y << odometry.angular.z << odometry.twist_covariance;
    const std::string_view bytes(buffer.getBuffer(), lengthOf(cdr));
    const auto found = bags::decodeRos<bags::RosOdometry>(bags::RosEncoding::kCdr, bytes);
    EXPECT_EQ(found.header.stamp_ns, odometry.header.stamp_ns);
    EXPECT_EQ(found.child_frame_id, "base");
    EXPECT_EQ(found.pose.orientation.w, 0.9);
    EXPECT_EQ(found.pose_covariance, odometry.pose_covariance);
    EXPECT_EQ(found.angular.z, 9);
    EXPECT_EQ(found.twist_covariance, odometry.twist_covariance);

    FastBuffer scan_buffer;
    Cdr scan_cdr(scan_buffer, order, kDdsCdr);
    scan_cdr.serialize_encapsulation();
    const auto scan = sampleScan();
    scan_cdr << std::int32_t{1'700'000'000} << std::uint32_t{987'654'321} << scan.header.frame_id
             << scan.angle_min << scan.angle_max << scan.angle_increment << scan.time_increment
             << scan.scan_time << scan.range_min << scan.range_max << scan.ranges << scan.intensities;
    expectSame(bags::decodeRos<bags::RosLaserScan>(bags::RosEncoding::kCdr,
                                                   {scan_buffer.getBuffer(), lengthOf(scan_cdr)}),
               scan);
    // Fast-CDR leaves what it pads with to chance, so only the size must agree.
    EXPECT_EQ(bags::encodeRos(bags::RosEncoding::kCdr, odometry).size(), bytes.size());
  }
}

#else

TEST(RosMessages, AreReadByFastCdr) {
  GTEST_SKIP() << "this test was built without Fast-CDR (Debian: libfastcdr-dev)";
}

#endif

}  // namespace
}  // namespace slam::logs

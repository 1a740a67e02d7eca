#include "libslam/bags/ros_messages.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

#include "libslam/core/error.h"

namespace slam::bags {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

struct SplitStamp {
  std::int64_t seconds = 0;
  std::uint32_t nanoseconds = 0;
};
SplitStamp split(std::int64_t stamp_ns) {
  std::int64_t seconds = stamp_ns / kNanosecondsPerSecond, rest = stamp_ns % kNanosecondsPerSecond;
  if (rest < 0) --seconds, rest += kNanosecondsPerSecond;
  return {seconds, static_cast<std::uint32_t>(rest)};
}

/// Reads the fields of a message one after the other.
class Decoder {
 public:
  Decoder(RosEncoding encoding, std::string_view bytes) : is_cdr_(encoding == RosEncoding::kCdr) {
    if (is_cdr_) {
      if (bytes.size() < 4) throw core::InputError("ends inside the head of its CDR data");
      // Representation identifiers 0 and 1 are plain CDR, big- and little-endian.
      if (bytes[0] != 0 || (bytes[1] != 0 && bytes[1] != 1))
        throw core::InputError("its first two bytes are " + std::to_string(byteAt(bytes, 0)) + " " +
                               std::to_string(byteAt(bytes, 1)) +
                               ", expected 0 0 or 0 1 (plain CDR, not compressed)");
      is_big_endian_ = bytes[1] == 0;
      bytes.remove_prefix(4);
    }
    bytes_ = bytes;
  }

  template <class Number, class = std::enable_if_t<std::is_arithmetic_v<Number>>>
  void operator()(Number& number) {
    align(sizeof number);
    require(sizeof number, "a number");
    std::array<char, sizeof number> raw{};
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof number);
    if (is_big_endian_) std::reverse(raw.begin(), raw.end());
    std::memcpy(&number, raw.data(), sizeof number);
    at_ += sizeof number;
  }

  void operator()(std::string& text) {
    const size_t length = elements(1, "a text");
    text.assign(bytes_.data() + at_, length);
    at_ += length;
    // CDR counts and stores the closing zero, ROS 1 has none.
    if (is_cdr_ && !text.empty() && text.back() == '\0') text.pop_back();
  }

  template <class Number>
  void operator()(std::vector<Number>& values) {
    if constexpr (std::is_arithmetic_v<Number>) {
      const size_t count = elements(sizeof(Number), "a list of numbers");
      if (count == 0) return values.clear();
      align(sizeof(Number));
      require(count * sizeof(Number), "a list of numbers");
      values.resize(count);
      std::memcpy(values.data(), bytes_.data() + at_, count * sizeof(Number));
      at_ += count * sizeof(Number);
      if (is_big_endian_) std::for_each(values.begin(), values.end(), reverseBytes<Number>);
    } else {
      const size_t count = elements(4, "a list");
      values.clear();
      // One by one: the memory taken stays in proportion to the bytes that are there.
      for (size_t i = 0; i < count; ++i) fields(*this, values.emplace_back());
    }
  }

  template <size_t kCount>
  void operator()(std::array<double, kCount>& values) {
    for (double& value : values) (*this)(value);
  }

  void operator()(RosHeader& header) {
    std::uint32_t unused_sequence = 0, nanoseconds = 0;
    if (!is_cdr_) (*this)(unused_sequence);
    std::int64_t seconds = 0;
    if (is_cdr_) {
      std::int32_t value = 0;
      (*this)(value);
      seconds = value;
    } else {
      std::uint32_t value = 0;
      (*this)(value);
      seconds = value;
    }
    (*this)(nanoseconds);
    header.stamp_ns = seconds * kNanosecondsPerSecond + nanoseconds;
    (*this)(header.frame_id);
  }

  void requireEnd() const {
    const size_t left = bytes_.size() - at_, padding = is_cdr_ ? 3 : 0;
    if (left > padding)
      throw core::InputError(std::to_string(left) +
                             " bytes are left over: not a message of the type that its topic has");
  }

 private:
  static int byteAt(std::string_view bytes, size_t index) { return static_cast<unsigned char>(bytes[index]); }

  template <class Number>
  static void reverseBytes(Number& number) {
    std::array<char, sizeof(Number)> raw{};
    std::memcpy(raw.data(), &number, sizeof number);
    std::reverse(raw.begin(), raw.end());
    std::memcpy(&number, raw.data(), sizeof number);
  }

  void align(size_t size) {
    if (is_cdr_) at_ = (at_ + size - 1) / size * size;
  }

  void require(size_t count, const char* what) const {
    if (at_ > bytes_.size() || count > bytes_.size() - at_)
      throw core::InputError(std::string("ends inside ") + what);
  }

  /// A length, once it is known that so many elements can be there.
  size_t elements(size_t least_bytes_each, const char* what) {
    std::uint32_t count = 0;
    (*this)(count);
    const size_t left = bytes_.size() - at_;
    if (count > left / least_bytes_each)
      throw core::InputError(std::string(what) + " of length " + std::to_string(count) +
                             " does not fit into the " + std::to_string(left) + " bytes left");
    return count;
  }

  std::string_view bytes_;
  size_t at_ = 0;
  bool is_cdr_, is_big_endian_ = false;
};

class Encoder {
 public:
  explicit Encoder(RosEncoding encoding) : is_cdr_(encoding == RosEncoding::kCdr) {
    if (is_cdr_) bytes_.assign("\0\1\0\0", 4);
  }

  template <class Number, class = std::enable_if_t<std::is_arithmetic_v<Number>>>
  void operator()(const Number& number) {
    align(sizeof number);
    appendRaw(&number, sizeof number);
  }
  void operator()(const std::string& text) {
    (*this)(static_cast<std::uint32_t>(text.size() + (is_cdr_ ? 1 : 0)));
    bytes_ += text;
    if (is_cdr_) bytes_ += '\0';
  }
  template <class Element>
  void operator()(const std::vector<Element>& values) {
    (*this)(static_cast<std::uint32_t>(values.size()));
    if constexpr (std::is_arithmetic_v<Element>) {
      if (values.empty()) return;
      align(sizeof(Element));
      appendRaw(values.data(), values.size() * sizeof(Element));
    } else {
      for (const auto& value : values) fields(*this, value);
    }
  }
  template <size_t kCount>
  void operator()(const std::array<double, kCount>& values) {
    for (const double value : values) (*this)(value);
  }
  void operator()(const RosHeader& header) {
    if (!rosCanHold(is_cdr_ ? RosEncoding::kCdr : RosEncoding::kRos1, header.stamp_ns))
      throw core::ContractError("encodeRos: a stamp that the message cannot hold");
    const auto [seconds, nanoseconds] = split(header.stamp_ns);
    if (!is_cdr_) (*this)(std::uint32_t{0});
    (*this)(static_cast<std::uint32_t>(seconds));
    (*this)(nanoseconds);
    (*this)(header.frame_id);
  }

  std::string take() { return std::move(bytes_); }

 private:
  // Both forms are little-endian, as is every machine that Debian's MRPT runs on.
  void appendRaw(const void* data, size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  void align(size_t size) {
    if (!is_cdr_) return;
    while ((bytes_.size() - 4) % size != 0) bytes_ += '\0';
  }

  std::string bytes_;
  bool is_cdr_;
};

// The fields of each message, in the order of its definition: the one place for both directions and forms.

template <class Codec, class Vector>
void vectorFields(Codec& codec, Vector& v) {
  codec(v.x), codec(v.y), codec(v.z);
}
template <class Codec, class Quaternion>
void quaternionFields(Codec& codec, Quaternion& q) {
  codec(q.x), codec(q.y), codec(q.z), codec(q.w);
}
template <class Codec, class Pose>
void poseFields(Codec& codec, Pose& pose) {
  vectorFields(codec, pose.position);
  quaternionFields(codec, pose.orientation);
}
/// Of both kinds of laser scan; the lists differ in what they hold.
template <class Codec, class Scan>
void scanFields(Codec& codec, Scan& scan) {
  codec(scan.header);
  codec(scan.angle_min), codec(scan.angle_max), codec(scan.angle_increment);
  codec(scan.time_increment), codec(scan.scan_time);
  codec(scan.range_min), codec(scan.range_max);
  codec(scan.ranges), codec(scan.intensities);
}

template <class Codec, class Message>
void fields(Codec& codec, Message& m) {
  using Plain = std::remove_const_t<Message>;
  if constexpr (std::is_same_v<Plain, RosLaserScan> || std::is_same_v<Plain, RosMultiEchoLaserScan>) {
    scanFields(codec, m);
  } else if constexpr (std::is_same_v<Plain, std::vector<float>>) {
    codec(m);
  } else if constexpr (std::is_same_v<Plain, RosOdometry>) {
    codec(m.header), codec(m.child_frame_id);
    poseFields(codec, m.pose);
    codec(m.pose_covariance);
    vectorFields(codec, m.linear), vectorFields(codec, m.angular);
    codec(m.twist_covariance);
  } else if constexpr (std::is_same_v<Plain, RosPoseStamped>) {
    codec(m.header);
    poseFields(codec, m.pose);
  } else if constexpr (std::is_same_v<Plain, RosTransform>) {
    codec(m.header), codec(m.child_frame_id);
    vectorFields(codec, m.translation);
    quaternionFields(codec, m.rotation);
  } else {
    static_assert(std::is_same_v<Plain, RosTransforms>);
    codec(m.transforms);
  }
}

struct Definition {
  const char* type;
  const char* fields;
  const char* md5;  ///< of ROS 1; nullptr for parts of messages
};
// The field lists of the ROS types (facts of the interface, without their remarks).
constexpr const char* kScanFields =
    "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
    "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n"
    "float32[] ranges\nfloat32[] intensities\n";
constexpr const char* kMultiEchoFields =
    "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
    "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n"
    "sensor_msgs/LaserEcho[] ranges\nsensor_msgs/LaserEcho[] intensities\n";
constexpr const char* kTransformsFields = "geometry_msgs/TransformStamped[] transforms\n";
constexpr const char* kTransformsMd5 = "94810edda583a504dfda3829e70d7eec";

constexpr std::array<Definition, 17> kDefinitions{{
    {kLaserScanType, kScanFields, "90c7ef2dc6895d81024acba2ac42f369"},
    {kMultiEchoType, kMultiEchoFields, "6fefb0c6da89d7c8abe4b339f5c2f8fb"},
    {kOdometryType,
     "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
     "geometry_msgs/TwistWithCovariance twist\n",
     "cd5e73d190d741a2f92e81eda573aca7"},
    {kPoseStampedType, "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
     "d3812c3cbc69362b77dc0b19b345f8f5"},
    {kTransformsType, kTransformsFields, kTransformsMd5},
    {kOldTransformsType, kTransformsFields, kTransformsMd5},
    {"sensor_msgs/LaserEcho", "float32[] echoes\n", nullptr},
    {"geometry_msgs/TransformStamped",
     "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n", nullptr},
    {"geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
     nullptr},
    {"geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n", nullptr},
    {"geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n", nullptr},
    {"geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n", nullptr},
    {"geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n", nullptr},
    {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n", nullptr},
    {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n", nullptr},
    {"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n", nullptr},
    {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n", nullptr},
}};

std::string fieldsOf(RosEncoding encoding, std::string_view type) {
  if (type == "std_msgs/Header")
    return encoding == RosEncoding::kRos1 ? "uint32 seq\ntime stamp\nstring frame_id\n"
                                          : "builtin_interfaces/Time stamp\nstring frame_id\n";
  for (const auto& definition : kDefinitions)
    if (type == definition.type) return definition.fields;
  throw core::ContractError("rosDefinition: unknown type " + std::string(type));
}

/// Every type that stands in the fields, first met first.
void addPartsOf(RosEncoding encoding, std::string_view type, std::vector<std::string>& parts) {
  const std::string text = fieldsOf(encoding, type);
  for (size_t begin = 0; begin < text.size(); begin = text.find('\n', begin) + 1) {
    const std::string word = text.substr(begin, text.find_first_of(" [", begin) - begin);
    const bool is_known = std::find(parts.begin(), parts.end(), word) != parts.end();
    if (word.find('/') == std::string::npos || is_known) continue;
    parts.push_back(word);
    addPartsOf(encoding, word, parts);
  }
}

}  // namespace

bool rosCanHold(RosEncoding encoding, std::int64_t stamp_ns) {
  const std::int64_t seconds = split(stamp_ns).seconds;
  if (encoding == RosEncoding::kRos1)
    return seconds >= 0 && seconds <= std::numeric_limits<std::uint32_t>::max();
  return seconds >= std::numeric_limits<std::int32_t>::min() &&
         seconds <= std::numeric_limits<std::int32_t>::max();
}

template <class Message>
Message decodeRos(RosEncoding encoding, std::string_view bytes) {
  Decoder decoder(encoding, bytes);
  Message message;
  fields(decoder, message);
  decoder.requireEnd();
  return message;
}

template <class Message>
std::string encodeRos(RosEncoding encoding, const Message& message) {
  Encoder encoder(encoding);
  fields(encoder, message);
  return encoder.take();
}

template RosLaserScan decodeRos(RosEncoding, std::string_view);
template RosMultiEchoLaserScan decodeRos(RosEncoding, std::string_view);
template RosOdometry decodeRos(RosEncoding, std::string_view);
template RosPoseStamped decodeRos(RosEncoding, std::string_view);
template RosTransforms decodeRos(RosEncoding, std::string_view);
template std::string encodeRos(RosEncoding, const RosLaserScan&);
template std::string encodeRos(RosEncoding, const RosMultiEchoLaserScan&);
template std::string encodeRos(RosEncoding, const RosOdometry&);
template std::string encodeRos(RosEncoding, const RosPoseStamped&);
template std::string encodeRos(RosEncoding, const RosTransforms&);

std::string rosMd5(std::string_view type) {
  for (const auto& definition : kDefinitions)
    if (type == definition.type && definition.md5 != nullptr) return definition.md5;
  return "";
}

std::string rosDefinition(RosEncoding encoding, std::string_view type) {
  std::string text = fieldsOf(encoding, type);
  std::vector<std::string> parts;
  addPartsOf(encoding, type, parts);
  for (const auto& part : parts)
    text += std::string(80, '=') + "\nMSG: " + part + "\n" + fieldsOf(encoding, part);
  return text;
}

std::string withoutMsg(std::string_view type) {
  std::string name(type);
  const size_t at = name.find("/msg/");
  if (at != std::string::npos) name.erase(at, 4);
  return name;
}

std::string withMsg(std::string_view type) {
  std::string name(type);
  const size_t at = name.find('/');
  if (at != std::string::npos && name.find("/msg/") == std::string::npos) name.insert(at, "/msg");
  return name;
}

}  // namespace slam::bags

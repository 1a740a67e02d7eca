#include "libslam/logs/trajectory_io.h"

#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <sstream>
#include <string_view>
#include <vector>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/fixed_number.h"
#include "libslam/files/csv.h"

namespace slam::logs {
namespace {

constexpr int kTimeDecimals = 6;
constexpr int kTumDecimals = 9;
constexpr int kMrptDecimals = 6;
constexpr int kRelationDecimals = 6;
constexpr size_t kRelationNumbers = 8;
constexpr const char* kRelationColumns = "t1 t2 x y z roll pitch yaw";

// A quaternion in a text file has a length near 1; a shorter one than this holds no direction.
constexpr double kShortestQuaternion = 1e-6;

struct Line {
  size_t number = 0;  ///< from 1
  bool has_commas = false;
  std::vector<double> values;
};

[[noreturn]] void failAt(const std::string& path, size_t line, const std::string& what) {
  throw core::InputError(path + ":" + std::to_string(line) + ": " + what);
}

double parseFinite(std::string_view word, const std::string& path, size_t line) {
  // from_chars, and so no locale, decides what a decimal point is; unlike strtod it takes no leading '+'.
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
  const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (result.ec != std::errc() || result.ptr != digits.data() + digits.size() || !std::isfinite(value))
    failAt(path, line, "found '" + std::string(word) + "', expected a finite number");
  return value;
}

constexpr std::string_view kBlank = " \t\r\v\f";
constexpr std::string_view kCsvColumns = "time_s,x_m,y_m,yaw_rad";

std::vector<double> parseNumbers(std::string_view text, const std::string& path, size_t line) {
  std::vector<double> values;
  for (size_t begin = text.find_first_not_of(kBlank); begin != std::string_view::npos;) {
    const size_t end = std::min(text.find_first_of(kBlank, begin), text.size());
    values.push_back(parseFinite(text.substr(begin, end - begin), path, line));
    begin = text.find_first_not_of(kBlank, end);
  }
  return values;
}

std::string_view trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return "";
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

/// fields: memory that is used again.
std::vector<double> parseCsvNumbers(std::string_view text, const std::string& path, size_t line,
                                    std::vector<std::string>& fields) {
  files::CsvReader(text, path, static_cast<int>(line)).next(fields);
  std::vector<double> values;
  values.reserve(fields.size());
  for (const auto& field : fields) values.push_back(parseFinite(trimmed(field), path, line));
  return values;
}

/// A first line of words in a file with commas must be the one we write.
bool isCsvHeader(std::string_view content, const std::string& path, size_t line) {
  const auto text = trimmed(content);
  if (text.find_first_of("abcdefghijklmnopqrstuvwxyz") != 0) return false;
  if (text != kCsvColumns)
    failAt(
        path, line,
        "found the columns '" + std::string(text.substr(0, 80)) + "', expected " + std::string(kCsvColumns));
  return true;
}

/// The lines with numbers; blank lines and those that start with # (TUM) or % (MRPT) are passed over.
std::vector<Line> readLines(const std::string& path) {
  const std::string text = files::readTextFile(path);
  std::vector<Line> lines;
  size_t number = 0;
  bool is_csv = false, has_header = false;
  std::vector<std::string> fields;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view content(text.data() + begin, end - begin);
    begin = end + 1;
    ++number;
    const size_t first = content.find_first_not_of(kBlank);
    if (first == std::string_view::npos || content[first] == '#' || content[first] == '%') continue;
    if (lines.empty() && !has_header) is_csv = content.find(',') != std::string_view::npos;
    if (is_csv && lines.empty() && !has_header && isCsvHeader(content, path, number))
      has_header = true;
    else
      lines.push_back(
          {number, is_csv,
           is_csv ? parseCsvNumbers(content, path, number, fields) : parseNumbers(content, path, number)});
  }
  if (lines.empty()) throw core::InputError(path + ": holds no pose, expected at least 1");
  return lines;
}

core::Pose2 tumPose(const Line& line, const std::string& path) {
  const auto& v = line.values;
  const double qx = v[4], qy = v[5], qz = v[6], qw = v[7];
  if (std::sqrt(qx * qx + qy * qy + qz * qz + qw * qw) < kShortestQuaternion)
    failAt(path, line.number, "found a quaternion of length 0, expected length 1");
  // Yaw of the rotation matrix, atan2(R10, R00); of any scale, so that a rounded quaternion needs no
  // normalising.
  return {v[1], v[2], core::atan2(2 * (qw * qz + qx * qy), qw * qw + qx * qx - qy * qy - qz * qz)};
}

core::Pose2 mrptPose(const Line& line, const std::string& /*path*/) {
  return {line.values[1], line.values[2], line.values[3]};
}

struct Format {
  size_t numbers;
  const char* columns;
  core::Pose2 (*pose)(const Line&, const std::string&);
};
const Format kTum{8, "time x y z qx qy qz qw", tumPose};
const Format kMrpt{4, "time x y phi", mrptPose};
const Format kCsv{4, "time_s,x_m,y_m,yaw_rad", mrptPose};

core::Trajectory toTrajectory(const std::vector<Line>& lines, const Format& format, const std::string& path) {
  core::Trajectory trajectory;
  for (const Line& line : lines) {
    if (line.values.size() != format.numbers)
      failAt(path, line.number,
             "found " + std::to_string(line.values.size()) + " numbers, expected " +
                 std::to_string(format.numbers) + " (" + format.columns + ")");
    const double time_s = line.values[0];
    if (!trajectory.empty() && time_s < trajectory.back().time_s) {
      std::string found, before;
      core::appendFixed(found, time_s, kTimeDecimals);
      core::appendFixed(before, trajectory.back().time_s, kTimeDecimals);
      failAt(path, line.number, "found time " + found + ", expected none before " + before);
    }
    trajectory.push_back({time_s, format.pose(line, path)});
  }
  return trajectory;
}

void writeAll(const core::Trajectory& trajectory, const std::string& path, TrajectoryWriter::Format format) {
  TrajectoryWriter writer(path, format);
  for (const auto& pose : trajectory) writer.write(pose);
  writer.close();
}

}  // namespace

TrajectoryWriter::TrajectoryWriter(const std::string& path, Format format) : file_(path), format_(format) {
  if (format_ == Format::kTum) file_.append("# time x y z qx qy qz qw\n");
  if (format_ == Format::kCsv) file_.append(std::string(kCsvColumns) + "\n");
}

void TrajectoryWriter::write(const core::StampedPose& stamped) {
  const auto& [time_s, pose] = stamped;
  if (!std::isfinite(time_s) || !core::isFinite(pose))
    throw core::ContractError("a trajectory to write holds a number that is not finite");
  if (!is_first_ && time_s < last_time_s_)
    throw core::ContractError("a trajectory to write has stamps that run back");
  if (is_first_) start_ = pose;
  is_first_ = false;
  last_time_s_ = time_s;

  line_.clear();
  core::appendFixed(line_, time_s, kTimeDecimals);
  const auto append = [&](std::initializer_list<double> values, int decimals) {
    for (const double value : values) {
      line_ += format_ == Format::kCsv ? ',' : ' ';
      core::appendFixed(line_, value, decimals);
    }
  };
  if (format_ == Format::kCsv) {
    append({pose.x, pose.y, core::wrapToPi(pose.phi)}, kTumDecimals);
  } else if (format_ == Format::kTum) {
    const double half_rad = core::wrapToPi(pose.phi) / 2;
    append({pose.x, pose.y, 0.0, 0.0, 0.0, core::sin(half_rad), core::cos(half_rad)}, kTumDecimals);
  } else {
    const auto T_start_robot = core::between(start_, pose);
    append({T_start_robot.x, T_start_robot.y, T_start_robot.phi}, kMrptDecimals);
  }
  line_ += '\n';
  file_.append(line_);
}

void TrajectoryWriter::close() {
  if (is_first_) throw core::ContractError("a trajectory without poses cannot be written");
  file_.commit();
}

void writeTum(const core::Trajectory& trajectory, const std::string& path) {
  writeAll(trajectory, path, TrajectoryWriter::Format::kTum);
}

core::Trajectory readTum(const std::string& path) {
  return toTrajectory(readLines(path), kTum, path);
}

void writeMrptGroundTruth(const core::Trajectory& truth, const std::string& path) {
  writeAll(truth, path, TrajectoryWriter::Format::kMrptGroundTruth);
}

core::Trajectory readMrptGroundTruth(const std::string& path) {
  return toTrajectory(readLines(path), kMrpt, path);
}

void writeTrajectory(const core::Trajectory& trajectory, const std::string& path,
                     TrajectoryWriter::Format format) {
  writeAll(trajectory, path, format);
}

core::Trajectory readTrajectory(const std::string& path) {
  const auto lines = readLines(path);
  if (lines.front().has_commas) return toTrajectory(lines, kCsv, path);
  const size_t numbers = lines.front().values.size();
  if (numbers != kTum.numbers && numbers != kMrpt.numbers)
    failAt(path, lines.front().number,
           "found " + std::to_string(numbers) + " numbers, expected " + std::to_string(kTum.numbers) + " (" +
               kTum.columns + ") or " + std::to_string(kMrpt.numbers) + " (" + kMrpt.columns + ")");
  return toTrajectory(lines, numbers == kTum.numbers ? kTum : kMrpt, path);
}

core::Relations readRelations(const std::string& path) {
  std::istringstream text(files::readTextFile(path));
  core::Relations relations;
  size_t number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    const size_t first = line.find_first_not_of(kBlank);
    if (first == std::string::npos || line[first] == '#') continue;
    const auto values = parseNumbers(line, path, number);
    if (values.size() != kRelationNumbers)
      failAt(path, number,
             "found " + std::to_string(values.size()) + " numbers, expected " +
                 std::to_string(kRelationNumbers) + " (" + kRelationColumns + ")");
    relations.push_back({values[0], values[1], {values[2], values[3], values[7]}});
  }
  if (relations.empty())
    throw core::InputError(path + ": holds no relation, expected lines of " + kRelationColumns);
  return relations;
}

void writeRelations(const core::Relations& relations, const std::string& path) {
  if (relations.empty()) throw core::ContractError("writeRelations: no relation");
  files::GrowingFile file(path);
  for (const auto& [from_s, to_s, T] : relations) {
    if (!std::isfinite(from_s) || !std::isfinite(to_s) || !core::isFinite(T))
      throw core::ContractError("writeRelations: a number that is not finite");
    std::string line;
    for (const double value : {from_s, to_s, T.x, T.y, 0.0, 0.0, 0.0, core::wrapToPi(T.phi)}) {
      if (!line.empty()) line += ' ';
      core::appendFixed(line, value, kRelationDecimals);
    }
    file.append(line + '\n');
  }
  file.commit();
}

}  // namespace slam::logs

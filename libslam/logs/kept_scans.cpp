#include "libslam/logs/kept_scans.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>

#include "libslam/core/error.h"

namespace slam::logs {
namespace {

/// What stands before the readings of a scan.
struct Head {
  core::Pose2 T_robot_lidar;
  double first_angle_rad, step_rad;
  std::uint64_t beams_and_last;  ///< number of beams times two, plus one for the last scan of an entry
};

/// A file to read and write, without a name; null where there can be none.
std::FILE* namelessFile(const std::string& folder) {
  std::string name = folder + "/scans.XXXXXX";
  const int descriptor = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) return nullptr;
  ::unlink(name.c_str());
  std::FILE* const file = ::fdopen(descriptor, "w+b");
  if (!file) ::close(descriptor);
  return file;
}

}  // namespace

KeptScans::KeptScans(const std::string& folder, std::uint64_t most_bytes)
    : folder_(folder), file_(namelessFile(folder)), most_bytes_(most_bytes) {}

void KeptScans::add(const LogEntry& entry) {
  if (is_reading_) throw core::ContractError("KeptScans::add: after rewind()");
  bool is_written = file_ && write(entry.scan, entry.others.empty());
  for (size_t i = 0; is_written && i < entry.others.size(); ++i)
    is_written = write(entry.others[i].scan, i + 1 == entry.others.size());
  if (is_written)
    ++entries_;
  else
    file_.reset();
}

bool KeptScans::write(const lidar::Scan& scan, bool is_last) {
  const Head head{scan.T_robot_lidar, scan.first_angle_rad, scan.step_rad,
                  2 * std::uint64_t{scan.ranges_m.size()} + (is_last ? 1 : 0)};
  bytes_ += sizeof head + scan.ranges_m.size() * sizeof(float);
  return bytes_ <= most_bytes_ && std::fwrite(&head, sizeof head, 1, file_.get()) == 1 &&
         std::fwrite(scan.ranges_m.data(), sizeof(float), scan.ranges_m.size(), file_.get()) ==
             scan.ranges_m.size();
}

bool KeptScans::rewind() {
  // What is still buffered may find no room.
  if (!file_ || std::fflush(file_.get()) != 0 || std::fseek(file_.get(), 0, SEEK_SET) != 0) return false;
  is_reading_ = true;
  entries_read_ = 0;
  return true;
}

void KeptScans::read(void* data, std::size_t bytes) {
  if (std::fread(data, 1, bytes, file_.get()) != bytes)
    throw core::IoError(folder_ + ": the scans kept there cannot be read");
}

std::optional<std::vector<lidar::Scan>> KeptScans::next() {
  if (!is_reading_) throw core::ContractError("KeptScans::next: before rewind()");
  if (entries_read_ == entries_) return std::nullopt;
  std::vector<lidar::Scan> scans;
  for (bool is_last = false; !is_last;) {
    Head head;
    read(&head, sizeof head);
    lidar::Scan& scan = scans.emplace_back();
    scan.T_robot_lidar = head.T_robot_lidar;
    scan.first_angle_rad = head.first_angle_rad;
    scan.step_rad = head.step_rad;
    scan.ranges_m.resize(head.beams_and_last / 2);
    read(scan.ranges_m.data(), scan.ranges_m.size() * sizeof(float));
    is_last = head.beams_and_last % 2 == 1;
  }
  ++entries_read_;
  return scans;
}

}  // namespace slam::logs

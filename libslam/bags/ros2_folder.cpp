#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "libslam/bags/ros_bytes.h"
#include "libslam/bags/ros_logs.h"
#include "libslam/bags/ros_objects.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"

namespace slam::bags {
namespace fs = std::filesystem;
namespace {

/// The files of a bag one after the other.
class ChainedMessages : public RosMessages {
 public:
  ChainedMessages(std::vector<std::string> paths, bool is_mcap)
      : paths_(std::move(paths)), is_mcap_(is_mcap) {
    openNext();
  }
  bool next(RosMessage& message) override {
    while (!current_->next(message)) {
      if (opened_ == paths_.size()) return false;
      addRemark();
      openNext();
    }
    return true;
  }
  double fractionRead() const override {
    return (static_cast<double>(opened_ - 1) + current_->fractionRead()) / static_cast<double>(paths_.size());
  }
  std::string remark() const override {
    const auto newest = current_->remark();
    return remarks_.empty() || newest.empty() ? remarks_ + newest : remarks_ + "; " + newest;
  }

 private:
  void addRemark() { remarks_ = remark(); }
  void openNext() {
    const std::string& path = paths_[opened_++];
    // Channels are pointed to by the newest message only.
    current_ = is_mcap_ ? openMcapMessages(path) : openDb3Messages(path);
  }

  std::vector<std::string> paths_;
  bool is_mcap_;
  size_t opened_ = 0;
  std::unique_ptr<RosMessages> current_;
  std::string remarks_;
};

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\"'");
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t\r\"'") - first + 1));
}

struct FolderContent {
  bool is_mcap = false;
  std::vector<std::string> paths;
};

/// The few lines of metadata.yaml that matter; rosbag2 writes it in YAML's block style with one key a line.
FolderContent readMetadata(const std::string& folder) {
  const std::string path = (fs::path(folder) / kMetadataName).string();
  const std::string content = files::readTextFile(path);
  FolderContent result;
  std::string storage, compression;
  bool in_paths = false;
  for (size_t begin = 0; begin < content.size();) {
    const size_t end = std::min(content.find('\n', begin), content.size());
    const std::string line = trimmed(std::string_view(content).substr(begin, end - begin));
    begin = end + 1;
    const size_t colon = line.find(':');
    const std::string key = line.substr(0, colon);
    if (line.substr(0, 2) == "- " && in_paths) {
      result.paths.push_back((fs::path(folder) / trimmed(std::string_view(line).substr(2))).string());
      continue;
    }
    if (colon == std::string::npos) continue;
    in_paths = key == "relative_file_paths";
    const std::string value = trimmed(std::string_view(line).substr(colon + 1));
    if (key == "storage_identifier") storage = value;
    if (key == "compression_mode") compression = value;
  }
  if (storage != "sqlite3" && storage != "mcap")
    throw core::InputError(path + ": storage_identifier: found '" + shownName(storage) +
                           "', expected sqlite3 or mcap");
  if (!compression.empty() && compression != "NONE" && compression != "none")
    throw core::InputError(path + ": compression_mode: found '" + compression +
                           "', expected none (`ros2 bag convert` writes such a bag)");
  if (result.paths.empty())
    throw core::InputError(path + ": relative_file_paths: found none, expected the bag's files");
  result.is_mcap = storage == "mcap";
  return result;
}

}  // namespace

bool looksLikeRos2Folder(const std::string& path) {
  std::error_code ignored;
  return fs::is_regular_file(fs::path(path) / kMetadataName, ignored);
}

std::unique_ptr<objects::ObjectSource> openRos2Folder(const std::string& path,
                                                      const RosReadOptions& options) {
  const auto content = readMetadata(path);
  return makeRosSource(
      path, [content] { return std::make_unique<ChainedMessages>(content.paths, content.is_mcap); }, options);
}

}  // namespace slam::bags

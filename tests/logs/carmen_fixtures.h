#pragma once
#include <bzlib.h>
#include <lzma.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <zlib.h>

#include <memory>
#include <string>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/logs/log_format.h"
#include "libslam/objects/object_stream.h"
#include "libslam/testing/temp_folder.h"
#include "tests/logs/objects_of.h"

namespace slam::logs {

inline std::vector<Object> objectsOfText(const std::string& text) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "a.clf", text);
  return objectsOf(folder / "a.clf");
}

template <class T>
std::vector<std::shared_ptr<T>> all(const std::vector<Object>& objects) {
  std::vector<std::shared_ptr<T>> found;
  for (const auto& object : objects)
    if (auto match = std::dynamic_pointer_cast<T>(object)) found.push_back(match);
  return found;
}

/// The texts of comments, and the labels of everything else, in order.
inline std::vector<std::string> outline(const std::vector<Object>& objects) {
  std::vector<std::string> lines;
  for (const auto& object : objects) {
    if (const auto* comment = dynamic_cast<const mrpt::obs::CObservationComment*>(object.get()))
      lines.push_back(comment->text);
    else
      lines.push_back(dynamic_cast<const mrpt::obs::CObservation&>(*object).sensorLabel);
  }
  return lines;
}

/// How many objects came before the error, and its text after the path.
inline std::pair<size_t, std::string> failureOf(const std::string& path) {
  size_t count = 0;
  try {
    const auto source = openLog(path);
    while (source->next()) ++count;
  } catch (const core::InputError& error) {
    const std::string text = error.what();
    return {count, text.compare(0, path.size(), path) == 0 ? text.substr(path.size()) : text};
  }
  return {count, ""};
}
inline std::pair<size_t, std::string> failureOfText(const std::string& text) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "a.clf", text);
  return failureOf(folder / "a.clf");
}

inline std::string bzip2(std::string content) {
  auto size = static_cast<unsigned>(content.size() + content.size() / 100 + 600);  // as its manual says
  std::string packed(size, '\0');
  BZ2_bzBuffToBuffCompress(packed.data(), &size, content.data(), static_cast<unsigned>(content.size()), 9, 0,
                           0);
  packed.resize(size);
  return packed;
}
inline std::string xz(const std::string& content) {
  std::string packed(lzma_stream_buffer_bound(content.size()), '\0');
  size_t size = 0;
  lzma_easy_buffer_encode(6, LZMA_CHECK_CRC64, nullptr, reinterpret_cast<const std::uint8_t*>(content.data()),
                          content.size(), reinterpret_cast<std::uint8_t*>(packed.data()), &size,
                          packed.size());
  packed.resize(size);
  return packed;
}
inline std::string gzip(const std::string& content) {
  const testing::TempFolder folder;
  const gzFile file = gzopen((folder / "a").c_str(), "wb");
  gzwrite(file, content.data(), static_cast<unsigned>(content.size()));
  gzclose(file);
  return files::readTextFile(folder / "a");
}

}  // namespace slam::logs

#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <sstream>
#include <string>

#include "libslam/posegraph/g2o_io.h"
#include "libslam/testing/temp_folder.h"

namespace slam::posegraph {

/// posegraphs/NAME.g2o.xz of the real data; none where it is absent.
inline std::optional<PoseGraph> realGraph(const std::string& name) {
  const std::string data = testing::realDataFolder(RASTERSLAM_SOURCE_DIR);
  const std::string path = data + "/posegraphs/" + name + ".g2o.xz";
  if (data.empty() || !std::filesystem::exists(path)) return std::nullopt;
  const auto unpacked = testing::runCommand("xzcat '" + path + "'");
  EXPECT_EQ(unpacked.exit_code, 0) << unpacked.err;
  std::istringstream text(unpacked.out);
  return readG2o(text, path).graph;
}

}  // namespace slam::posegraph

#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "libslam/files/files.h"
#include "libslam/testing/temp_folder.h"
#include "tests/apps/program.h"

namespace slam::apps {

/// Two logs of five seconds and two methods on each: six cells.
inline constexpr const char* kTiny =
    "[suite]\nworlds = flat\nmethods = naive_wheel, naive\nseeds = 1..2\n"
    "[lidar]\nbeams = 61\n[simulation]\nduration_s = 5\n";

inline void write(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

inline std::string replaced(std::string text, const std::string& what, const std::string& with) {
  return text.replace(text.find(what), what.size(), with);
}

/// Everything in a sweep's folder that never differs, by path.
inline std::map<std::string, std::string> contents(const std::string& folder) {
  static const std::set<std::string> kDiffers = {"manifest.json", "run.manifest.json", "cost.json",
                                                 "cost.csv",      "cost_summary.txt",  "cost_summary.csv",
                                                 "stderr.txt"};
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && !kDiffers.count(entry.path().filename().string()))
      files[std::filesystem::relative(entry.path(), folder).string()] =
          files::readTextFile(entry.path().string());
  return files;
}

inline std::vector<std::string> cellsOf(const std::string& folder, const std::string& kind) {
  std::vector<std::string> cells;
  for (const auto& entry : std::filesystem::directory_iterator(folder + "/cells"))
    if (files::readTextFile(entry.path() / "cell.json").find("\"kind\": \"" + kind + "\"") !=
        std::string::npos)
      cells.push_back(entry.path().string());
  std::sort(cells.begin(), cells.end());
  return cells;
}

inline nlohmann::json resultsOf(const std::string& folder) {
  return nlohmann::json::parse(files::readTextFile(folder + "/results.json"))["rows"];
}

inline std::size_t timesIn(const std::string& text, const std::string& what) {
  std::size_t times = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++times;
  return times;
}

class Bench : public ::testing::Test {
 protected:
  void SetUp() override { write(folder_ / "tiny.ini", kTiny); }
  testing::CommandResult bench(const std::string& arguments) {
    return rasterslam("bench " + arguments, folder_.path());
  }
  testing::TempFolder folder_;
};

}  // namespace slam::apps

// docs/origins.md says of every number of the original documents which test holds it.
#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "libslam/files/files.h"

namespace slam::apps {
namespace {

// Each row of that table ends with `tests/room/file_test.cpp`: `Name` |
TEST(TheOriginsPage, NamesATestThatThereIsForEachNumber) {
  const std::string source = RASTERSLAM_SOURCE_DIR;
  std::istringstream lines(files::readTextFile(source + "/docs/origins.md"));
  static const std::regex kTest(R"re(`(tests/[^`]+)`: `([^`]+)` \|$)re");
  bool in_numbers = false;
  int rows = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind('|', 0) != 0) in_numbers = false;
    if (in_numbers && line.rfind("|---", 0) != 0) {
      std::smatch test;
      ASSERT_TRUE(std::regex_search(line, test, kTest)) << line;
      EXPECT_NE(
          files::readTextFile(source + "/" + std::string(test[1])).find(", " + std::string(test[2]) + ")"),
          std::string::npos)
          << line;
      ++rows;
    }
    in_numbers = in_numbers || line.rfind("| system |", 0) == 0;
  }
  EXPECT_GE(rows, 45);
}

}  // namespace
}  // namespace slam::apps

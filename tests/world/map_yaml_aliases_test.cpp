#include <gmock/gmock.h>

#include <fstream>

#include "libslam/core/error.h"
#include "libslam/testing/temp_folder.h"
#include "libslam/world/plan.h"

namespace slam::world {
namespace {

/// What is said of a map yaml without its path.
std::string refusalOf(const std::string& text) {
  const testing::TempFolder folder;
  const std::string path = folder / "map.yaml";
  std::ofstream(path) << text;
  try {
    loadPlan(path);
  } catch (const core::InputError& error) {
    return std::string(error.what()).substr(path.size());
  }
  return "";
}

TEST(MapYaml, OfListsThatHoldThemselvesIsRefusedInOneShortLine) {
  EXPECT_EQ(refusalOf("image: &a [*a]\n"), ":1: key 'image': found '[[[...]]]', expected one value");
}

TEST(MapYaml, OfListsThatAreEndlessWhenWrittenOutIsRefusedInOneShortLine) {
  std::string lists = "&a0 [x, x, x, x, x, x, x, x, x]";  // 9^9 items
  for (int i = 1; i < 9; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    lists += ", &a" + std::to_string(i) + " [";
    for (int k = 0; k < 9; ++k) lists += before + (k < 8 ? ", " : "]");
  }
  const std::string said = refusalOf("image: [" + lists + "]\n");
  EXPECT_THAT(said, ::testing::StartsWith(":1: key 'image': found '["));
  EXPECT_LT(said.size(), 10000U);
}

}  // namespace
}  // namespace slam::world

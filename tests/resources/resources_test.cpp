#include "libslam/resources/resources.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/testing/temp_folder.h"

namespace slam::resources {
namespace {

TEST(Plans, AreFoundByNameBesideAFolderOfResultsThatIsCalledSo) {
  const testing::TempFolder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  std::filesystem::create_directory("flat");
  std::filesystem::create_directory("attic");
  const std::string found = resolvePlan("flat"), attic = resolvePlan("attic"), dotted = resolvePlan("./flat");
  std::filesystem::current_path(before);
  EXPECT_EQ(found, worldsFolder() + "/flat.yaml");
  EXPECT_EQ(attic, "attic") << "who reads it says that it is a folder";
  EXPECT_EQ(dotted, "./flat");
}

}  // namespace
}  // namespace slam::resources

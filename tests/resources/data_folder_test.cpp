#include "libslam/resources/data_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "libslam/resources/resources.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::resources {
namespace {
namespace fs = std::filesystem;
using slam::testing::errorOf;

class DataFolder : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_ / name; }

  void install(const std::string& folder, const std::string& version) {
    fs::create_directories(path(folder + "/configs"));
    fs::create_directories(path(folder + "/worlds"));
    std::ofstream(path(folder + "/VERSION")) << version << "\n";
  }

  void makeSource() {
    fs::create_directories(path("source/configs"));
    fs::create_directories(path("source/datasets/worlds"));
  }

  testing::TempFolder folder_;
};

TEST_F(DataFolder, LiesBesideTheProgramOrTheLibraryThatHoldsTheCode) {
  install("prefix/share/rasterslam", "2.0");
  for (const char* code :
       {"prefix/bin/rasterslam", "prefix/lib/libslam.so", "prefix/lib/x86_64-linux-gnu/libslam.so"}) {
    const auto data = findData({"", path(code), "", "", ""}, "2.0");
    EXPECT_EQ(data.configs, path("prefix/share/rasterslam/configs")) << code;
    EXPECT_EQ(data.worlds, path("prefix/share/rasterslam/worlds")) << code;
    EXPECT_EQ(data.public_data, path("prefix/share/rasterslam/public_data.json")) << code;
  }
}

TEST_F(DataFolder, ThatTheVariableNamesWins) {
  install("prefix/share/rasterslam", "2.0");
  install("other", "2.0");
  EXPECT_EQ(findData({path("other"), path("prefix/bin/rasterslam"), "", "", ""}, "2.0").configs,
            path("other/configs"));
}

TEST_F(DataFolder, ThatTheVariableNamesIsRefusedWhenItHoldsNoData) {
  install("prefix/share/rasterslam", "2.0");
  fs::create_directories(path("empty"));
  EXPECT_EQ(errorOf([&] {
              findData({path("empty"), path("prefix/bin/rasterslam"), "", "", ""}, "2.0");
            }),
            "RASTERSLAM_DATA: " + path("empty") +
                ": found no folder 'configs' in it, expected the data of rasterslam 2.0");
}

TEST_F(DataFolder, OfAnotherVersionIsNamed) {
  install("prefix/share/rasterslam", "1.9");
  EXPECT_EQ(
      errorOf([&] {
        findData({"", path("prefix/bin/rasterslam"), "", "", ""}, "2.0");
      }),
      path("prefix/share/rasterslam") + ": found data of version 1.9, expected the data of rasterslam 2.0");
  fs::remove(path("prefix/share/rasterslam/VERSION"));
  EXPECT_EQ(
      errorOf([&] {
        findData({"", path("prefix/bin/rasterslam"), "", "", ""}, "2.0");
      }),
      path("prefix/share/rasterslam") + ": found no file VERSION in it, expected the data of rasterslam 2.0");
}

TEST_F(DataFolder, IsTheSourceTreeOnlyForAProgramInItsBuildFolder) {
  makeSource();
  const DataPlaces built = {"", path("build/apps/rasterslam"), path("build"), path("source"), ""};
  EXPECT_EQ(findData(built, "2.0").worlds, path("source/datasets/worlds"));
  DataPlaces moved = built;
  moved.code = path("builder/bin/rasterslam");
  EXPECT_EQ(errorOf([&] { findData(moved, "2.0"); }),
            "the data of rasterslam 2.0 is missing; looked at " + path("builder/share/rasterslam") + ", " +
                path("share/rasterslam") + "; RASTERSLAM_DATA can name its folder");
}

TEST_F(DataFolder, OfTheFirstInstallationServesProgramsElsewhere) {
  install("usr/share/rasterslam", "2.0");
  const DataPlaces places = {"", path("home/user/project/a.out"), "", "", path("usr/share/rasterslam")};
  EXPECT_EQ(findData(places, "2.0").worlds, path("usr/share/rasterslam/worlds"));
}

TEST(DataPlaces, OfATestAreItsBuildFolderAndItsSource) {
  const auto places = dataPlaces();
  EXPECT_EQ(fs::path(places.code).filename(), "test_resources");
  EXPECT_TRUE(fs::exists(places.source_folder + "/datasets/worlds/flat.yaml"));
  EXPECT_EQ(places.code.rfind(places.build_folder + "/", 0), 0U)
      << places.code << " in " << places.build_folder;
}

}  // namespace
}  // namespace slam::resources

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A folder with programs that only say how they were called.
class ViewMrpt : public ::testing::Test {
 protected:
  void addProgram(const std::string& name, int exit_code) {
    fs::create_directories(folder_ / "bin");
    const std::string path = folder_ / ("bin/" + name);
    std::ofstream(path) << "#!/bin/sh\necho " << name << " \"$@\"\nexit " << exit_code << "\n";
    fs::permissions(path, fs::perms::owner_all);
  }
  testing::CommandResult view(const std::string& arguments, const std::string& display = ":77") {
    return testing::runCommand("cd '" + folder_.path() + "' && PATH='" + (folder_ / "bin") + "' DISPLAY='" +
                               display + "' WAYLAND_DISPLAY= '" RASTERSLAM_PROGRAM "' view " + arguments);
  }
  void touch(const std::string& name) { std::ofstream(folder_ / name) << "x"; }
  testing::TempFolder folder_;
};

TEST_F(ViewMrpt, StartsTheProgramForTheKindOfFile) {
  addProgram("RawLogViewer", 0), addProgram("SceneViewer3D", 0), addProgram("robot-map-gui", 7);
  touch("a b.rawlog"), touch("map.3Dscene"), touch("map.simplemap");
  EXPECT_EQ(view("--mrpt 'a b.rawlog'").out, "RawLogViewer a b.rawlog\n");
  EXPECT_EQ(view("--mrpt map.3Dscene").out, "SceneViewer3D map.3Dscene\n");
  const auto failed = view("--mrpt map.simplemap");
  EXPECT_EQ(failed.out, "robot-map-gui map.simplemap\n");
  EXPECT_EQ(failed.exit_code, 7);  // the program's own
}

TEST_F(ViewMrpt, SaysWhatToInstall) {
  touch("map.3Dscene");
  const auto missing = view("--mrpt map.3Dscene");
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_EQ(missing.err,
            "rasterslam: SceneViewer3D: not found in PATH, needed to show map.3Dscene (Debian: apt install "
            "mrpt-apps)\n");
}

TEST_F(ViewMrpt, RefusesWhatNobodyShowsAndWhatIsNotThere) {
  addProgram("RawLogViewer", 0);
  touch("map.png");
  const auto other = view("--mrpt map.png");
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_THAT(other.err, HasSubstr("map.png: is of no kind that a viewer of MRPT's opens, expected .rawlog"));
  const auto none = view("--mrpt none.rawlog");
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_THAT(none.err, HasSubstr("none.rawlog: no such file"));
}

TEST_F(ViewMrpt, NeedsADisplay) {
  addProgram("RawLogViewer", 0);
  touch("a.rawlog");
  const auto blind = view("--mrpt a.rawlog", "");
  EXPECT_EQ(blind.exit_code, 1);
  EXPECT_EQ(blind.out, "");
  EXPECT_THAT(blind.err, HasSubstr("RawLogViewer: there is no display (DISPLAY is not set)"));
}

}  // namespace
}  // namespace slam::apps

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "libslam/files/files.h"
#include "libslam/resources/file_hash.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// Without a display, whatever this test is run in.
testing::CommandResult withoutDisplay(const std::string& arguments, const std::string& folder) {
  return testing::runCommand("cd '" + folder +
                             "' && env -u DISPLAY -u WAYLAND_DISPLAY '" RASTERSLAM_PROGRAM "' " + arguments);
}

bool hasViewer() {
  return fs::exists(fs::path(RASTERSLAM_PROGRAM).parent_path() / "rasterslam-view");
}

#define SKIP_WITHOUT_VIEWER() \
  if (!hasViewer()) GTEST_SKIP() << "rasterslam-view was not built: MRPT's GUI library is missing"

/// Before the program's name: it sees no display but one of its own, drawn to without a graphics card.
#define IN_A_WINDOW "LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -a -s '-screen 0 1280x800x24' "
/// The same for programs that have the sanitizers.
#ifdef RASTERSLAM_KEEP_LOADED
#define WITH_LIBRARIES_KEPT \
  "env LD_PRELOAD='" RASTERSLAM_KEEP_LOADED "' ASAN_OPTIONS=\"$ASAN_OPTIONS\":verify_asan_link_order=0 "
#else
#define WITH_LIBRARIES_KEPT
#endif

/// Centre of mass and number of the pixels of nearly that colour left of the panel.
struct Spot {
  double x = 0, y = 0;
  int pixels = 0;
};
Spot spotOf(const cv::Mat& picture, const cv::Scalar& bgr) {
  cv::Mat near;
  cv::inRange(picture.colRange(0, picture.cols - 330), bgr - cv::Scalar(10, 10, 10),
              bgr + cv::Scalar(10, 10, 10), near);
  Spot spot;
  for (int y = 0; y < near.rows; ++y)
    for (int x = 0; x < near.cols; ++x)
      if (near.at<unsigned char>(y, x)) spot.x += x, spot.y += y, ++spot.pixels;
  if (spot.pixels) spot.x /= spot.pixels, spot.y /= spot.pixels;
  return spot;
}

TEST(ViewCommand, HelpStandsBeforeItToo) {
  SKIP_WITHOUT_VIEWER();
  const auto before = testing::runCommand("'" RASTERSLAM_PROGRAM "' help view run"),
             after = testing::runCommand("'" RASTERSLAM_PROGRAM "' view run --help");
  EXPECT_EQ(before.exit_code, 0) << before.err;
  EXPECT_EQ(before.out, after.out);
  EXPECT_EQ(testing::runCommand("'" RASTERSLAM_PROGRAM "' help view rn").exit_code, 2);
}

TEST(ViewCommand, AScreenshotShowsTheRobotWhereItStarts) {
  SKIP_WITHOUT_VIEWER();
  const testing::TempFolder folder;
  const auto result = withoutDisplay(
      "view simulate flat --start 4,3,0 --set robot.side_m=0.6 --set lidar.max_range_m=0.2 "
      "--set lidar.min_range_m=0.05 --duration 2 --screenshot out.png --at 0 --size 1000x700",
      folder.path());
  if (result.exit_code == 1 && result.err.find("EGL") != std::string::npos) GTEST_SKIP() << result.err;
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "out.png\n");
  const auto picture = cv::imread(folder / "out.png");
  ASSERT_EQ(picture.cols, 1000);
  ASSERT_EQ(picture.rows, 700);
  // The plan of 13.6 x 10.6 m fills 670 x 700 pixels but for 5 % of air all round; (4, 3) is in the lower
  // left quarter.
  const double pixels_per_m = 670 / 13.6 / 1.1;
  const auto robot = spotOf(picture, {0, 94, 213});
  EXPECT_GT(robot.pixels, 0.5 * 0.36 * pixels_per_m * pixels_per_m);
  EXPECT_NEAR(robot.x, 335 + (4 - 6.8) * pixels_per_m, 2);
  EXPECT_NEAR(robot.y, 350 - (3 - 5.3) * pixels_per_m, 2);
  EXPECT_EQ(fs::directory_iterator(folder.path())->path().filename(), "out.png");  // and nothing else is left
}

TEST(ViewCommand, ScreenshotsOfMethodsAndReplaysAreRepeatable) {
  SKIP_WITHOUT_VIEWER();
  const testing::TempFolder folder;
  ASSERT_EQ(rasterslam("simulate flat -o run.rawlog --duration 20 --set lidar.beams=181 -q", folder.path())
                .exit_code,
            0);
  ASSERT_EQ(rasterslam("run graph run.rawlog -o out -q", folder.path()).exit_code, 0);
  for (const std::string what : {"run graph run.rawlog -q", "run particles run.rawlog -q", "replay out"}) {
    const std::string command = "view " + what + " --at 15 --screenshot ";
    const auto first = withoutDisplay(command + "a.png", folder.path());
    if (first.exit_code == 1 && first.err.find("EGL") != std::string::npos) GTEST_SKIP() << first.err;
    ASSERT_EQ(first.exit_code, 0) << first.err;
    ASSERT_EQ(withoutDisplay(command + "b.png", folder.path()).exit_code, 0);
    EXPECT_EQ(resources::fileSha256(folder / "a.png"), resources::fileSha256(folder / "b.png")) << what;
    const auto picture = cv::imread(folder / "a.png");
    EXPECT_GT(spotOf(picture, {0, 94, 213}).pixels, 50) << what;       // robot and scan
    EXPECT_GT(spotOf(picture, {178, 114, 0}).pixels, 50) << what;      // path
    EXPECT_GT(spotOf(picture, {255, 255, 255}).pixels, 5000) << what;  // the map's free space
  }
}

TEST(ViewCommand, WithoutADisplayItSaysSo) {
  SKIP_WITHOUT_VIEWER();
  const testing::TempFolder folder;
  for (const std::string what :
       {"simulate flat -q", "drive flat", "explore flat -q", "simulate flat -q -o run.rawlog"}) {
    const auto result = withoutDisplay("view " + what, folder.path());
    EXPECT_EQ(result.exit_code, 1) << what;
    EXPECT_THAT(result.err, HasSubstr("there is no display")) << what;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(ViewCommand, RefusesInOneLine) {
  SKIP_WITHOUT_VIEWER();
  const testing::TempFolder folder;
  const std::tuple<const char*, int, const char*> refusals[] = {
      {"simulate flatt", 3, "did you mean 'flat'?"},
      {"simulate flat --screenshot a.png", 3, "--at"},
      {"simulate flat --at 3", 3, "expected both"},
      {"simulate flat --duration 2 --screenshot a.png --at 9", 3, "--at: found 9, expected at most 2"},
      {"run grahp run.rawlog", 3, "did you mean 'graph'?"},
      {"run graph run.rawlog --at 1 --screenshot a.png", 3, "run.rawlog"},
      {"replay nowhere --at 1 --screenshot a.png", 3, "nowhere/manifest.json"},
      {"explore flat --strategy quadrantt", 3, "did you mean 'quadrant'?"},
      {"navigate flat --goal 3", 3, "expected two numbers"},
      {"drive flat --set robot.side_m=9", 3, "no free place"}};
  for (const auto& [arguments, code, what] : refusals) {
    const auto result = withoutDisplay("view " + std::string(arguments), folder.path());
    EXPECT_EQ(result.exit_code, code) << arguments;
    EXPECT_THAT(result.err, HasSubstr(what)) << arguments;
  }
  EXPECT_EQ(withoutDisplay("view simulate flat --size 10x10", folder.path()).exit_code, 2);
  EXPECT_EQ(withoutDisplay("view", folder.path()).exit_code, 2);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(ViewCommand, AWindowShowsARunToItsEndAndKeepsItsFiles) {
  SKIP_WITHOUT_VIEWER();
  if (!testing::programExists("xvfb-run") || !testing::programExists("xauth"))
    GTEST_SKIP() << "xvfb-run or xauth is missing (Debian: apt install xvfb xauth)";
  const testing::TempFolder folder;
  const std::string options = " flat --duration 3 --set lidar.beams=91 --seed 4";
  const auto shown = testing::runCommand("cd '" + folder.path() +
                                         "' && " IN_A_WINDOW WITH_LIBRARIES_KEPT "'" RASTERSLAM_PROGRAM
                                         "' view simulate --speed 0 --close -o a.rawlog" +
                                         options);
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("16 scans in 3.0 s"));
  ASSERT_EQ(rasterslam("simulate -o b.rawlog" + options, folder.path()).exit_code, 0);
  for (const std::string suffix : {".rawlog", ".gt.tum", ".operations.txt", ".rawlog.GT.txt"})
    EXPECT_EQ(resources::fileSha256(folder / ("a" + suffix)), resources::fileSha256(folder / ("b" + suffix)))
        << suffix;
}

TEST(ViewCommand, ADriveByCommandsShowsTheMapThatGrows) {
  SKIP_WITHOUT_VIEWER();
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "drive.txt", "move 1\nturn 90\nmove 1\nturn 90\nmove 1\n");
  const std::string command = "view drive flat --start 4,3,0 --commands drive.txt --screenshot ";
  int walls = 0;
  for (const std::string slam : {"naive_wheel", "odometry"}) {
    const auto result = withoutDisplay(command + slam + ".png --at 6 --slam " + slam, folder.path());
    if (result.exit_code == 1 && result.err.find("EGL") != std::string::npos) GTEST_SKIP() << result.err;
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, slam + ".png\n");
    const int black = spotOf(cv::imread(folder / (slam + ".png")), {30, 30, 30}).pixels;
    if (slam == "odometry")
      EXPECT_LT(black, walls / 2);
    else
      walls = black;
  }
  EXPECT_GT(walls, 200);
  EXPECT_FALSE(fs::exists(folder / "run.rawlog"));
  const auto late = withoutDisplay(command + "c.png --at 99", folder.path());
  EXPECT_EQ(late.exit_code, 3);
  EXPECT_THAT(late.err, HasSubstr("--at: found 99"));
  EXPECT_THAT(withoutDisplay("view drive flat --screenshot a.png --at 1", folder.path()).err,
              HasSubstr("expected --commands"));
}

TEST(ViewCommand, ADriveByCommandsInAWindowWritesWhatSimulateWrites) {
  SKIP_WITHOUT_VIEWER();
  if (!testing::programExists("xvfb-run") || !testing::programExists("xauth"))
    GTEST_SKIP() << "xvfb-run or xauth is missing (Debian: apt install xvfb xauth)";
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "drive.txt", "move 0.5\nturn 90\nmove 0.5\n");
  const std::string options = " flat --commands drive.txt --carry 1.5:11,3,0 --set lidar.beams=91 --seed 4";
  const auto shown = testing::runCommand("cd '" + folder.path() +
                                         "' && " IN_A_WINDOW WITH_LIBRARIES_KEPT "'" RASTERSLAM_PROGRAM
                                         "' view drive --speed 0 --close -o a.rawlog" +
                                         options);
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("kidnapped at 1.5 s"));
  ASSERT_EQ(rasterslam("simulate -o b.rawlog" + options, folder.path()).exit_code, 0);
  for (const std::string suffix : {".rawlog", ".gt.tum", ".operations.txt", ".rawlog.GT.txt", ".carries.csv"})
    EXPECT_EQ(resources::fileSha256(folder / ("a" + suffix)), resources::fileSha256(folder / ("b" + suffix)))
        << suffix;
}

TEST(ViewCommand, ADriverTypesACommandAndCarriesTheRobotByTheMouse) {
  SKIP_WITHOUT_VIEWER();
  for (const char* program : {"xvfb-run", "xauth", "xdotool"})
    if (!testing::programExists(program))
      GTEST_SKIP() << program << " is missing (Debian: apt install xvfb xauth xdotool)";
  const testing::TempFolder folder;
  // The scene is 950 x 800 pixels and the flat 13.6 x 10.6 m: from above 63.5 pixels are a metre, its middle
  // is in the middle. The robot starts at (4, 3) and is dragged to (11, 3) as soon as the window is there.
  files::writeFileAtomically(
      folder / "hand.sh", WITH_LIBRARIES_KEPT
      "'" RASTERSLAM_PROGRAM
      "' view drive flat --start 4,3,0 --set lidar.beams=91 -o a.rawlog > out.txt 2> "
      "err.txt &\nprogram=$!\n"
      "until window=$(xdotool search --onlyvisible --name 'drive flat' 2>/dev/null); do kill -0 $program || "
      "exit 9; "
      "done\n"
      "xdotool windowmove $window 0 0 windowfocus --sync $window\n"
      "xdotool mousemove 297 546 mousedown 1 mousemove 400 546 mousemove 742 546 mouseup 1\n"
      "xdotool key Return type 'move 0.5'\n"
      "xdotool key Return q\n"
      "wait $program\n");
  const auto result =
      testing::runCommand("cd '" + folder.path() +
                          "' && LIBGL_ALWAYS_SOFTWARE=1 timeout 450 xvfb-run -a -s '-screen 0 "
                          "1280x800x24' sh hand.sh");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto out = files::readTextFile(folder / "out.txt");
  EXPECT_THAT(out, HasSubstr("kidnapped at ")) << files::readTextFile(folder / "err.txt");
  EXPECT_THAT(out, HasSubstr("over 0.5 m"));
  EXPECT_THAT(out, HasSubstr("to (11.0"));
}

TEST(ViewCommand, TheMainProgramNeedsNoWindowLibrary) {
  const auto result =
      testing::runCommand("ldd '" RASTERSLAM_PROGRAM "' | grep -c -E 'mrpt-gui|nanogui|libglfw|libwx'");
  EXPECT_EQ(result.out, "0\n");
}

}  // namespace
}  // namespace slam::apps

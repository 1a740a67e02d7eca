#include "libslam/world/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "drawn_plan.h"
#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/files/files.h"
#include "libslam/testing/temp_folder.h"

namespace slam::world {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class Plans : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& content) {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }
  std::string write(const std::string& name, const cv::Mat& image, const std::vector<int>& settings = {}) {
    cv::imwrite(folder_ / name, image, settings);
    return folder_ / name;
  }
  /// The message of the InputError that loading gives; it must be one line and begin with the path.
  std::string errorOf(const std::string& path, const PlanOptions& options = {}) {
    try {
      loadPlan(path, options);
    } catch (const core::InputError& e) {
      const std::string message = e.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_THAT(message, StartsWith(path));
      return message.substr(path.size());
    }
    ADD_FAILURE() << path << " was read without an error";
    return "";
  }
  /// A yaml over a good picture; `lines` replaces or adds.
  std::string yamlError(const std::string& text) {
    write("good.png", halfAndHalf());
    return errorOf(write("map.yaml", text));
  }
  static cv::Mat halfAndHalf() {
    cv::Mat image(2, 4, CV_8U, cv::Scalar(255));
    image.at<std::uint8_t>(0, 0) = 0;
    return image;
  }

  testing::TempFolder folder_;
};

/// Top row first, as drawn.
std::string drawing(const Plan& plan) {
  std::string text;
  for (int row = plan.rows; row-- > 0; text += row > 0 ? "/" : "")
    for (int column = 0; column < plan.columns; ++column)
      text += plan.at(column, row) == Cell::kOccupied ? '#' : plan.at(column, row) == Cell::kFree ? '.' : '?';
  return text;
}

const char* const kHeader = "image: good.png\nresolution: 0.05\norigin: [0, 0, 0]\n";

TEST_F(Plans, PutThePicturesTopRowLast) {
  const Plan plan =
      loadPlan(write("a.pgm", "P5\n# drawn by hand\n3 2\n255\n" + std::string("\0\xff\xff\xff\xcd\xff", 6)));
  EXPECT_EQ(plan.name, "a");
  EXPECT_EQ(plan.columns, 3);
  EXPECT_EQ(plan.rows, 2);
  EXPECT_EQ(plan.resolution_m, 0.05);
  EXPECT_EQ(drawing(plan), "#../.?.");
  EXPECT_EQ(plan.at(0, 1), Cell::kOccupied);
  EXPECT_EQ(plan.at(1, 0), Cell::kUnknown);
}

TEST_F(Plans, FollowTheThresholdsOfMapServer) {
  // p = (255 - gray) / 255; with 0.2 and 0.6: 153 gives exactly 0.4, 102 exactly 0.6, 204 exactly 0.2.
  const std::string path = write("a.pgm", "P2 7 1 255 101 102 153 204 205 255 0");
  PlanOptions options;
  options.occupied_threshold = 0.6;
  options.free_threshold = 0.2;
  EXPECT_EQ(drawing(loadPlan(path, options)), "#???..#") << "equal to a threshold is unknown";
  options.negate = true;
  EXPECT_EQ(drawing(loadPlan(path, options)), "???###.");
}

TEST_F(Plans, ReadTheSameFromEveryFormat) {
  cv::Mat gray(3, 4, CV_8U, cv::Scalar(255));
  gray.at<std::uint8_t>(0, 1) = 0;
  gray.at<std::uint8_t>(2, 3) = 205;
  const std::string expected = ".#../..../...?";
  cv::Mat colour, wide, wide_colour;
  cv::merge(std::vector<cv::Mat>{gray, gray, gray}, colour);
  gray.convertTo(wide, CV_16U, 257);
  colour.convertTo(wide_colour, CV_16U, 257);
  const cv::Mat opaque8(gray.size(), CV_8U, cv::Scalar(255)),
      opaque16(gray.size(), CV_16U, cv::Scalar(65535));
  cv::Mat with_alpha, wide_with_alpha;
  cv::merge(std::vector<cv::Mat>{gray, gray, gray, opaque8}, with_alpha);
  cv::merge(std::vector<cv::Mat>{wide, wide, wide, opaque16}, wide_with_alpha);
  EXPECT_EQ(drawing(loadPlan(write("g.png", gray))), expected);
  EXPECT_EQ(drawing(loadPlan(write("c.png", colour))), expected);
  EXPECT_EQ(drawing(loadPlan(write("w.png", wide))), expected);
  EXPECT_EQ(drawing(loadPlan(write("wc.png", wide_colour))), expected);
  EXPECT_EQ(drawing(loadPlan(write("a.png", with_alpha))), expected) << "opaque everywhere: by gray level";
  EXPECT_EQ(drawing(loadPlan(write("wa.png", wide_with_alpha))), expected);
  EXPECT_EQ(drawing(loadPlan(write("g.bmp", gray))), expected);
  EXPECT_EQ(drawing(loadPlan(write("c.bmp", colour))), expected);
  EXPECT_EQ(drawing(loadPlan(write("g.pgm", gray))), expected);
  EXPECT_EQ(drawing(loadPlan(write("w.pgm", wide))), expected);
  EXPECT_EQ(drawing(loadPlan(write("ascii.pgm", gray, {cv::IMWRITE_PXM_BINARY, 0}))), expected);
  EXPECT_EQ(drawing(loadPlan(write("a picture.with.odd name", files::readTextFile(folder_ / "g.png")))),
            expected)
      << "told by content";
}

TEST_F(Plans, ReadAJpeg) {
  cv::Mat image(32, 32, CV_8U, cv::Scalar(255));
  image(cv::Rect(0, 0, 16, 32)) = 0;  // whole 8 x 8 blocks, so that the compression does not blur them
  const Plan plan = loadPlan(write("a.jpg", image));
  EXPECT_EQ(plan.at(3, 3), Cell::kOccupied);
  EXPECT_EQ(plan.at(28, 3), Cell::kFree);
  EXPECT_EQ(std::count(plan.cells.begin(), plan.cells.end(), Cell::kOccupied), 16 * 32);
}

TEST_F(Plans, ReadAOneBitPalettePng) {
  const unsigned char bytes[] = {0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49,
                                 0x48, 0x44, 0x52, 0x00, 0x00, 0x00, 0x04, 0x00, 0x00, 0x00, 0x02, 0x01, 0x03,
                                 0x00, 0x00, 0x00, 0x45, 0x66, 0xef, 0x20, 0x00, 0x00, 0x00, 0x06, 0x50, 0x4c,
                                 0x54, 0x45, 0xff, 0xff, 0xff, 0x00, 0x00, 0x00, 0x55, 0xc2, 0xd3, 0x7e, 0x00,
                                 0x00, 0x00, 0x0c, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x48, 0x60, 0x10,
                                 0x00, 0x00, 0x01, 0x34, 0x00, 0x71, 0xd1, 0x79, 0xe8, 0xa0, 0x00, 0x00, 0x00,
                                 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  const std::string path = write("p.png", std::string(reinterpret_cast<const char*>(bytes), sizeof bytes));
  EXPECT_EQ(drawing(loadPlan(path)), ".##./...#");
}

TEST_F(Plans, TakeOpaquePixelsOfABarePictureForObstacles) {
  cv::Mat image(1, 4, CV_8UC4, cv::Scalar(0, 0, 0, 0));
  image.at<cv::Vec4b>(0, 0) = {255, 255, 255, 255};  // white, but opaque
  image.at<cv::Vec4b>(0, 1) = {0, 0, 0, 254};
  EXPECT_EQ(drawing(loadPlan(write("a.png", image))), "#...");
}

TEST_F(Plans, TakeTransparentPixelsOfARosMapForUnknown) {
  cv::Mat image(1, 4, CV_8UC4, cv::Scalar(255, 255, 255, 255));
  image.at<cv::Vec4b>(0, 0) = {0, 0, 0, 255};
  image.at<cv::Vec4b>(0, 1) = {255, 255, 255, 0};
  write("good.png", image);
  EXPECT_EQ(drawing(loadPlan(write("map.yaml", kHeader))), "#?..");
}

TEST_F(Plans, TakeTheUnusedByteOfA32BitBmpForNoAlpha) {
  cv::Mat image(1, 3, CV_8UC4, cv::Scalar(255, 255, 255, 0));
  image.at<cv::Vec4b>(0, 1) = {0, 0, 0, 0};
  EXPECT_EQ(drawing(loadPlan(write("a.bmp", image))), ".#.");
}

TEST_F(Plans, ScaleAPgmByItsMaximum) {
  EXPECT_EQ(drawing(loadPlan(write("a.pgm", "P2 3 1 15 0 12 15"))), "#?.");
  EXPECT_EQ(drawing(loadPlan(write("b.pgm", std::string("P5 3 1 1000\n\0\0\3\x20\3\xe8", 18)))), "#?.");
}

TEST_F(Plans, ReadAMapYaml) {
  write("good.png", halfAndHalf());
  const std::string path =
      write("map.yaml",
            "# a map\r\n---\r\nimage: \"good.png\"   # beside this file\r\nresolution: 1e-1\r\n"
            "origin:\r\n  - -1.5\r\n  - 2\r\n  - 0.5\r\nnegate: false\nmode: scale\n"
            "occupied_thresh: 0.7\nfree_thresh: 0.2\n");
  const Plan plan = loadPlan(path);
  EXPECT_EQ(plan.name, "map");
  EXPECT_EQ(plan.resolution_m, 0.1);
  EXPECT_EQ(plan.T_frame_raster.x, -1.5);
  EXPECT_EQ(plan.T_frame_raster.y, 2);
  EXPECT_EQ(plan.T_frame_raster.phi, 0.5);
  EXPECT_EQ(drawing(plan), "#.../....");
}

TEST_F(Plans, HonourNegateAndRawOfAMapYaml) {
  write("good.png", cv::Mat(cv::Mat_<std::uint8_t>({1, 4}, {0, 50, 100, 255})));
  EXPECT_EQ(drawing(loadPlan(write("a.yaml", std::string(kHeader) + "negate: 1\n"))), ".??#");
  EXPECT_EQ(drawing(loadPlan(write("b.yaml", std::string(kHeader) + "mode: raw\n"))), ".?#?");
}

TEST_F(Plans, FindTheImageOfAYamlByAnAbsolutePathToo) {
  const std::string image = write("good.png", halfAndHalf());
  std::filesystem::create_directory(folder_ / "sub");
  EXPECT_EQ(loadPlan(write("sub/a.yaml", "image: '" + image + "'\nresolution: 1\norigin: [0,0,0]\n")).columns,
            4);
  EXPECT_EQ(loadPlan(write("sub/b.yaml", "image: ../good.png\nresolution: 1\norigin: [0,0,0]\n")).columns, 4);
}

TEST_F(Plans, RefuseAMalformedYamlInOneLine) {
  EXPECT_EQ(yamlError("image: good.png\nresolutoin: 0.05\norigin: [0,0,0]\n"),
            ":2: unknown key 'resolutoin'; did you mean 'resolution'?");
  EXPECT_EQ(yamlError("resolution: 0.05\norigin: [0,0,0]\n"), ": key 'image' is missing");
  EXPECT_EQ(yamlError("image: good.png\norigin: [0,0,0]\n"), ": key 'resolution' is missing");
  EXPECT_EQ(yamlError("image: good.png\nresolution: 0.05\n"), ": key 'origin' is missing");
  EXPECT_EQ(yamlError(""), ": key 'image' is missing");
  EXPECT_EQ(yamlError(std::string(kHeader) + "resolution: 1\n"),
            ":4: key 'resolution' is given twice, first at " + (folder_ / "map.yaml") + ":2");
  EXPECT_EQ(yamlError("just a text\n"), ":1: found 'just a text', expected key: value");
  EXPECT_EQ(yamlError("just\n\na text\n"), ":1: found 'just a text', expected key: value");
  EXPECT_EQ(yamlError("- good.png\n"), ":1: found '[good.png]', expected key: value");
  EXPECT_EQ(yamlError("[image]: good.png\n"), ":1: unknown key '[image]'; did you mean 'image'?");
  for (const std::string bad : {"image: [\n", "image: a: b\n", "\timage: good.png\n"})
    EXPECT_THAT(yamlError(bad), HasSubstr(" is not YAML: ")) << bad;
  EXPECT_THAT(yamlError(std::string(kHeader) + "---\nimage: good.png\n"),
              HasSubstr("goes on behind its first document"));
  EXPECT_EQ(yamlError("image:\nresolution: 1\norigin: [0,0,0]\n"),
            ":1: key 'image': found '', expected one value");
  EXPECT_EQ(yamlError("image: [good.png]\n"), ":1: key 'image': found '[good.png]', expected one value");
}

TEST_F(Plans, RefuseAYamlValueOutOfRangeInOneLine) {
  const auto withResolution = [&](const std::string& value) {
    return yamlError("image: good.png\nresolution: " + value + "\norigin: [0,0,0]\n");
  };
  for (const std::string bad : {"-0.05", "0", "nan", "inf", "0.05m", "1e9", "five"})
    EXPECT_EQ(withResolution(bad),
              ":2: key 'resolution': found '" + bad + "', expected metres per pixel, a number above 0");
  EXPECT_THAT(withResolution("'5\n\n  m'"), HasSubstr("found '5 m', expected"));
  const auto withOrigin = [&](const std::string& value) {
    return yamlError("image: good.png\nresolution: 1\norigin: " + value + "\n");
  };
  for (const std::string bad : {"[0, 0]", "[0, 0, 0, 0]", "[0, nan, 0]", "[0, zero, 0]", "[]", "0"})
    EXPECT_EQ(withOrigin(bad),
              ":3: key 'origin': found '" + bad + "', expected [x, y, yaw]: three finite numbers");
  EXPECT_EQ(yamlError(std::string(kHeader) + "occupied_thresh: 1.5\n"),
            ":4: key 'occupied_thresh': found '1.5', expected a number from 0 to 1");
  EXPECT_EQ(yamlError(std::string(kHeader) + "free_thresh: -0.1\n"),
            ":4: key 'free_thresh': found '-0.1', expected a number from 0 to 1");
  EXPECT_EQ(yamlError(std::string(kHeader) + "free_thresh: 0.65\n"),
            ":4: key 'free_thresh': found '0.65', expected a number below occupied_thresh 0.65");
  EXPECT_EQ(yamlError(std::string(kHeader) + "negate: 2\n"), ":4: key 'negate': found '2', expected 0 or 1");
  EXPECT_EQ(yamlError(std::string(kHeader) + "mode: ternary\n"),
            ":4: key 'mode': found 'ternary', expected trinary, scale or raw");
  EXPECT_EQ(yamlError("image: none.png\nresolution: 1\norigin: [0,0,0]\n"),
            ": key 'image': found '" + (folder_ / "none.png") + "', which does not exist");
}

TEST_F(Plans, RefuseOptionsOutOfRange) {
  const std::string path = write("a.png", halfAndHalf());
  PlanOptions options;
  options.resolution_m = -1;
  EXPECT_EQ(errorOf(path, options),
            ": key 'resolution': found '-1', expected metres per pixel, a number above 0");
  options = {};
  options.occupied_threshold = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(errorOf(path, options), ": key 'occupied_thresh': found 'nan', expected a number from 0 to 1");
  options = {};
  options.T_frame_raster.phi = std::numeric_limits<double>::infinity();
  EXPECT_EQ(errorOf(path, options), ": key 'origin': not finite, expected [x, y, yaw]");
}

TEST_F(Plans, RefuseWhatIsNoPicture) {
  EXPECT_EQ(errorOf(folder_ / "missing.png"), ": no such file");
  EXPECT_EQ(errorOf(folder_.path()), ": is a folder, expected a file");
  EXPECT_EQ(errorOf(write("empty.png", std::string())),
            ": is empty, expected a picture (bmp, png, pgm, jpg)");
  EXPECT_EQ(errorOf(write("text.png", std::string("hello"))),
            ": is not a picture that can be read (bmp, png, pgm, jpg)");
  EXPECT_EQ(errorOf(write("white.png", cv::Mat(2, 2, CV_8U, cv::Scalar(255)))),
            ": the picture has no obstacle, expected at least one occupied pixel");
  EXPECT_EQ(errorOf(write("black.png", cv::Mat(2, 2, CV_8U, cv::Scalar(0)))),
            ": the picture has no free space, expected at least one free pixel");
  EXPECT_EQ(errorOf(write("none.pgm", std::string("P5 0 4 255\n"))),
            ": the picture has 0 x 4 pixels, expected at least one");
  EXPECT_EQ(errorOf(write("huge.pgm", std::string("P5 30000 30000 255\n"))),
            ": the picture has 30000 x 30000 pixels, expected at most 32768 on a side and 2^28 in all (to "
            "simulate in "
            "takes some 13 bytes a pixel: 12 GB)");
  EXPECT_EQ(
      errorOf(write("long.pgm", std::string("P5 40000 1 255\n"))),
      ": the picture has 40000 x 1 pixels, expected at most 32768 on a side and 2^28 in all (to simulate in "
      "takes some 13 bytes a pixel: 0 GB)");
}

TEST_F(Plans, MayBeEmptyWhereThatIsAllowed) {
  PlanOptions options;
  options.allow_empty = true;
  EXPECT_EQ(drawing(loadPlan(write("good.png", cv::Mat(1, 2, CV_8U, cv::Scalar(255))), options)), "..");
  EXPECT_EQ(drawing(loadPlan(write("map.yaml", kHeader), options)), "..");
}

TEST_F(Plans, RefuseEveryCutOfAPictureWithoutANoise) {
  cv::Mat image(24, 24, CV_8UC3);
  core::RandomStream random(1, "picture");
  for (int i = 0; i < 24 * 24 * 3; ++i) image.data[i] = static_cast<std::uint8_t>(random.below(256));
  ::testing::internal::CaptureStderr();
  for (const std::string name : {"a.png", "a.jpg", "a.bmp", "a.pgm", "ascii.pgm"}) {
    const bool is_plain = name == "ascii.pgm";
    cv::Mat picture = image;
    if (name.find("pgm") != std::string::npos) cv::extractChannel(image, picture, 0);
    const std::string whole = files::readTextFile(
        write(name, picture, is_plain ? std::vector<int>{cv::IMWRITE_PXM_BINARY, 0} : std::vector<int>{}));
    EXPECT_NO_THROW(loadPlan(folder_ / name)) << name;
    // A plain PGM's last number may be cut, and then it is another whole picture.
    for (size_t length = 0; length + (is_plain ? 4 : 0) < whole.size(); length += length < 48 ? 1 : 97)
      EXPECT_THROW(loadPlan(write("cut", whole.substr(0, length))), core::InputError)
          << name << " " << length;
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  const std::string png = files::readTextFile(folder_ / "a.png");
  EXPECT_THAT(errorOf(write("cut.png", png.substr(0, png.size() - 20))),
              HasSubstr(": the picture is truncated: a PNG chunk at byte 33 needs"));
  EXPECT_EQ(errorOf(write("cut.png", png.substr(0, png.size() - 12))),
            ": the picture is truncated: a PNG ends with an IEND chunk, this one at byte " +
                std::to_string(png.size() - 12));
  std::string damaged = png;
  damaged[png.size() / 2] = static_cast<char>(~damaged[png.size() / 2]);
  EXPECT_THAT(errorOf(write("damaged.png", damaged)), HasSubstr(": the picture is damaged: wrong checksum"));
}

TEST_F(Plans, ComeBackFromDiskAsTheyWere) {
  Plan plan = drawnPlan({"#?.#", "....", "##??"}, 0.1 / 3);
  plan.T_frame_raster = {-1.0 / 3, 1e-7, -2.5};
  plan.doors = {{0, 1, 4, 2}, {3, 1, 4, 2}};
  for (const std::string name : {"plan.yaml", "it's a #1: plan.yaml", "-dash.yaml"}) {
    savePlan(plan, folder_ / name);
    const Plan loaded = loadPlan(folder_ / name);
    EXPECT_EQ(loaded.name, std::filesystem::path(name).stem().string());
    EXPECT_EQ(loaded.cells, plan.cells);
    EXPECT_EQ(loaded.columns, 4);
    EXPECT_EQ(loaded.rows, 3);
    EXPECT_EQ(loaded.resolution_m, plan.resolution_m);
    EXPECT_EQ(loaded.T_frame_raster.x, plan.T_frame_raster.x);
    EXPECT_EQ(loaded.T_frame_raster.y, plan.T_frame_raster.y);
    EXPECT_EQ(loaded.T_frame_raster.phi, plan.T_frame_raster.phi);
    ASSERT_EQ(loaded.doors.size(), 2U);
    EXPECT_EQ(loaded.doors[1].x0, 3);
    EXPECT_EQ(loaded.doors[1].y1, 2);
  }
}

TEST_F(Plans, KnowTheirDoors) {
  cv::imwrite(folder_ / "good.png", cv::Mat(3, 4, CV_8U, cv::Scalar(255)));
  const auto doorsIn = [&](const std::string& text) {
    PlanOptions options;
    options.allow_empty = true;
    return loadPlan(write("map.yaml", kHeader + text), options).doors;
  };
  EXPECT_TRUE(doorsIn("").empty());
  EXPECT_TRUE(doorsIn("doors: []\n").empty());
  EXPECT_TRUE(doorsIn("doors:\n").empty());
  for (const std::string text :
       {"doors: [[1, 0, 2, 2], [0, 0, 1, 1]]\n", "doors: [ [1,0,2,2],[0,0,1,1], ]  # two\n",
        "doors:\n  - [1, 0, 2, 2]\n  - [0, 0, 1, 1]\n"}) {
    const auto doors = doorsIn(text);
    ASSERT_EQ(doors.size(), 2U) << text;
    EXPECT_EQ(doors[0].x0, 1);
    EXPECT_EQ(doors[0].y0, 0);
    EXPECT_EQ(doors[0].x1, 2);
    EXPECT_EQ(doors[0].y1, 2);
    EXPECT_EQ(doors[1].x1, 1);
  }
}

TEST_F(Plans, RefuseDoorsThatAreNone) {
  const auto doorError = [&](const std::string& value) {
    return yamlError(std::string(kHeader) + "doors: " + value + "\n");
  };
  const std::string expected = "', expected [x0, y0, x1, y1]: whole numbers, x0 < x1 and y0 < y1";
  for (const std::string bad :
       {"[1, 0, 2]", "[1, 0, 2, 2, 3]", "[1, 0, 1, 2]", "[2, 0, 1, 2]", "[1, 0.5, 2, 2]", "[1, nan, 2, 2]",
        "[1, 1e9, 2, 1e10]", "[a, 0, 1, 1]", "7", "[[0, 0, 1, 1]]", ""})
    EXPECT_EQ(doorError("[" + bad + ", [0, 0, 1, 1]]"), ":4: key 'doors': found '" + bad + expected) << bad;
  EXPECT_EQ(doorError("[1, 0, 2, 2]"), ":4: key 'doors': found '1" + expected);
  EXPECT_EQ(doorError("open"), ":4: key 'doors': found 'open', expected a list of [x0, y0, x1, y1]");
  for (const std::string bad : {"[[1, 0, 2, 2]", "[[1, 0, 2, 2", "["})
    EXPECT_THAT(doorError(bad), HasSubstr(" is not YAML: ")) << bad;
  for (const std::string bad : {"[-1, 0, 1, 1]", "[0, 0, 5, 1]", "[0, 0, 1, 3]"})
    EXPECT_EQ(doorError("[" + bad + "]"),
              ":4: key 'doors': found '" + bad + "', expected cells of the plan, 0 to 4 by 0 to 2");
  EXPECT_THAT(doorError("[[0, 0, 4, 2]]"), HasSubstr("expected free cells, and ("));
}

TEST_F(Plans, LeaveNothingBehindWhereTheyCannotBeWritten) {
  std::filesystem::create_directory(folder_ / "plan.yaml");  // a folder stands where the yaml should go
  EXPECT_THROW(savePlan(drawnPlan({"#."}), folder_ / "plan.yaml"), core::InputError);
  EXPECT_THROW(savePlan(drawnPlan({"#."}), folder_ / "none/plan.yaml"), core::IoError);
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
    files += entry.is_regular_file();
  EXPECT_EQ(files, 0);
}

}  // namespace
}  // namespace slam::world

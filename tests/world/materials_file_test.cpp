#include "libslam/world/materials_file.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "drawn_plan.h"
#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/files/files.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"
#include "libslam/world/picture_file.h"

namespace slam::world {
namespace {
namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using M = Material;

/// Blue, green, red, as OpenCV has them.
cv::Mat colours(const std::vector<cv::Vec3b>& row) {
  return cv::Mat(row, true).reshape(3, 1);
}

class Materials : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const cv::Mat& image) {
    cv::imwrite(folder_ / name, image);
    return folder_ / name;
  }
  std::vector<Material> read(const std::string& path, const std::string& cells) {
    Plan plan = drawnPlan({cells});
    readMaterials(path, plan);
    return plan.materials;
  }

  testing::TempFolder folder_;
};

TEST_F(Materials, AreNamedByPureColours) {
  const auto path =
      write("m.png", colours({{255, 0, 0}, {0, 0, 255}, {0, 255, 0}, {0, 0, 0}, {205, 205, 205}}));
  EXPECT_THAT(read(path, "#####"), ElementsAre(M::kGlass, M::kMirror, M::kDark, M::kPlain, M::kPlain));
}

TEST_F(Materials, SurviveTurningThePictureGray) {
  const cv::Mat gray = (cv::Mat_<std::uint8_t>(1, 5) << 29, 76, 150, 254, 255);
  for (const std::string name : {"m.png", "m.bmp", "m.pgm"})
    EXPECT_THAT(read(write(name, gray), "#####"),
                ElementsAre(M::kGlass, M::kMirror, M::kDark, M::kPlain, M::kPlain))
        << name;
}

TEST_F(Materials, OfSixteenBitsAreTheSame) {
  cv::Mat deep(1, 3, CV_16UC3);
  deep.at<cv::Vec3w>(0, 0) = {65535, 0, 0};
  deep.at<cv::Vec3w>(0, 1) = {0, 0, 65535};
  deep.at<cv::Vec3w>(0, 2) = {0, 65535, 0};
  EXPECT_THAT(read(write("m.png", deep), "###"), ElementsAre(M::kGlass, M::kMirror, M::kDark));
}

TEST_F(Materials, CountOnWallsThatAreOpaque) {
  cv::Mat layer(1, 3, CV_8UC4, cv::Scalar(255, 0, 0, 255));
  layer.at<cv::Vec4b>(0, 1) = {12, 34, 56, 0};  // not opaque: whatever colour lies under it
  EXPECT_THAT(read(write("m.png", layer), "##."), ElementsAre(M::kGlass, M::kPlain, M::kPlain));
}

TEST_F(Materials, PutThePicturesTopRowLast) {
  Plan plan = drawnPlan({"##", "##"});
  cv::Mat image(2, 2, CV_8UC3, cv::Scalar(255, 255, 255));
  image.at<cv::Vec3b>(0, 1) = {0, 0, 255};
  readMaterials(write("m.png", image), plan);
  EXPECT_THAT(plan.materials, ElementsAre(M::kPlain, M::kPlain, M::kPlain, M::kMirror));
}

TEST_F(Materials, OfAnotherSizeOrAnUnknownColourAreRefused) {
  Plan plan = drawnPlan({"###", "..."});
  cv::Mat image(2, 3, CV_8UC3, cv::Scalar(255, 255, 255));
  image.at<cv::Vec3b>(1, 2) = {255, 255, 0};
  const auto path = write("m.png", image);
  EXPECT_EQ(
      testing::errorOf([&] { readMaterials(path, plan); }),
      path +
          ": pixel (2, 1): found colour 0 255 255, expected glass 0 0 255, mirror 255 0 0, dark 0 255 0, "
          "or gray 0, 205, 254 or 255 for plain");
  Plan small = drawnPlan({"###"});
  EXPECT_EQ(testing::errorOf([&] { readMaterials(path, small); }),
            path + ": the materials have 3 x 2 pixels, expected 3 x 1 as the plan");
}

Plan randomPlan() {
  core::RandomStream random(3, "materials test");
  Plan plan;
  plan.columns = 37, plan.rows = 23;
  for (int i = 0; i < plan.columns * plan.rows; ++i) {
    plan.cells.push_back(static_cast<Cell>(random.below(3)));
    const bool wall = plan.cells.back() == Cell::kOccupied;
    plan.materials.push_back(wall ? static_cast<M>(random.below(4)) : M::kPlain);
  }
  return plan;
}

TEST_F(Materials, LoadBackBitForBit) {
  Plan plan = randomPlan();
  savePlan(plan, folder_ / "plan.yaml");
  const Plan back = loadPlan(folder_ / "plan.yaml");
  EXPECT_EQ(back.cells, plan.cells);
  EXPECT_EQ(back.materials, plan.materials);
  EXPECT_THAT(files::readTextFile(folder_ / "plan.yaml"), HasSubstr("materials: plan.materials.png\n"));

  plan.materials.assign(plan.cells.size(), M::kPlain);
  savePlan(plan, folder_ / "plain.yaml");
  EXPECT_EQ(loadPlan(folder_ / "plain.yaml").materials, plan.materials);
}

TEST_F(Materials, AreNotWrittenForAPlanWithout) {
  Plan plan = randomPlan();
  plan.materials.clear();
  savePlan(plan, folder_ / "plan.yaml");
  EXPECT_FALSE(fs::exists(folder_ / "plan.materials.png"));
  EXPECT_TRUE(loadPlan(folder_ / "plan.yaml").materials.empty());
}

TEST_F(Materials, LeaveNothingBehindWhenOneFileCannotBeWritten) {
  fs::create_directory(folder_ / "plan.yaml");  // the last of the three cannot be renamed onto a folder
  EXPECT_THROW(savePlan(randomPlan(), folder_ / "plan.yaml"), core::InputError);
  EXPECT_FALSE(fs::exists(folder_ / "plan.png"));
  EXPECT_FALSE(fs::exists(folder_ / "plan.materials.png"));
}

TEST_F(Materials, ThatAreMissingAreRefusedByKey) {
  savePlan(randomPlan(), folder_ / "plan.yaml");
  fs::remove(folder_ / "plan.materials.png");
  EXPECT_EQ(testing::errorOf([&] { loadPlan(folder_ / "plan.yaml"); }),
            (folder_ / "plan.yaml") + ": key 'materials': found '" + (folder_ / "plan.materials.png") +
                "', which does not exist");
}

}  // namespace
}  // namespace slam::world

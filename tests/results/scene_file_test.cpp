#include "libslam/results/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/opengl/CFBORender.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/opengl/CSetOfTexturedTriangles.h>

#include <cstdlib>
#include <fstream>

#include "libslam/core/error.h"
#include "libslam/resources/file_hash.h"
#include "libslam/testing/temp_folder.h"
#include "tests/mapping/small_room.h"

namespace slam::results {
namespace {

using mrpt::opengl::COpenGLScene;

/// What `method` makes of a drive through a room, as a scene.
void write(const std::string& method_name, const std::string& file) {
  const std::string folder = std::string(RASTERSLAM_SOURCE_DIR) + "/configs/methods";
  auto method = mapping::makeMapBuilder(mapping::loadMethodConfig(folder, method_name), method_name, 1);
  core::Trajectory path;
  lidar::Scan last;
  for (const auto& entry : mapping::test::driveThroughRoom(30).entries) {
    path.push_back(
        {entry.scan.time_s, mapping::processScan(method, entry.scan, entry.T_previous_robot, true)});
    last = entry.scan;
  }
  writeScene(method, mapping::currentMap(method), path, last, file);
}

std::vector<std::string> layersOf(const std::string& file) {
  COpenGLScene scene;
  EXPECT_TRUE(scene.loadFromFile(file)) << file;
  std::vector<std::string> names;
  for (const auto& object : *scene.getViewport("main")) names.push_back(object->getName());
  return names;
}

TEST(SceneFile, HasTheLayersThatTheMethodKnows) {
  const testing::TempFolder folder;
  using ::testing::ElementsAre;
  write("icp", folder / "icp.3Dscene");
  EXPECT_THAT(layersOf(folder / "icp.3Dscene"), ElementsAre("map", "path", "scan", "robot"));
  write("particles", folder / "particles.3Dscene");
  EXPECT_THAT(layersOf(folder / "particles.3Dscene"),
              ElementsAre("map", "path", "scan", "robot", "particles"));
  write("graph", folder / "graph.3Dscene");
  EXPECT_THAT(layersOf(folder / "graph.3Dscene"), ElementsAre("map", "graph", "path", "scan", "robot"));
}

/// As plain lines and triangles they were behind the map in SceneViewer3D, whose depth buffer has 16 bits.
TEST(SceneFile, WhatLiesOnTheMapIsDrawnAsTheMapIs) {
  const testing::TempFolder folder;
  write("graph", folder / "graph.3Dscene");
  COpenGLScene scene;
  ASSERT_TRUE(scene.loadFromFile(folder / "graph.3Dscene"));
  for (const char* name : {"graph", "path", "scan", "robot"}) {
    const auto layer =
        std::dynamic_pointer_cast<mrpt::opengl::CSetOfObjects>(scene.getByName(std::string(name)));
    ASSERT_TRUE(layer) << name;
    EXPECT_GT(layer->size(), 0U) << name;
    for (const auto& part : *layer)
      EXPECT_TRUE(std::dynamic_pointer_cast<mrpt::opengl::CSetOfTexturedTriangles>(part)) << name;
  }
}

TEST(SceneFile, TheTruthGoesUnderneathAndTakesThePlaceOfAnEarlierOne) {
  const testing::TempFolder folder;
  const auto file = folder / "icp.3Dscene";
  write("icp", file);
  world::Plan plan;
  plan.columns = plan.rows = 20;
  plan.resolution_m = 0.5;
  plan.cells.assign(400, world::Cell::kFree);
  const core::Trajectory truth = {{0, {1, 2, 0}}, {1, {3, 2, 0}}};
  addTruthToScene(truth, &plan, {-1, -2, 0}, file);
  const std::vector<std::string> layers = {"plan", "map", "truth", "path", "scan", "robot"};
  EXPECT_EQ(layersOf(file), layers);
  const auto once = resources::fileSha256(file);
  addTruthToScene(truth, &plan, {-1, -2, 0}, file);
  EXPECT_EQ(layersOf(file), layers);
  EXPECT_EQ(resources::fileSha256(file), once);
  COpenGLScene scene;
  ASSERT_TRUE(scene.loadFromFile(file));
  EXPECT_NEAR(scene.getByName("plan")->getPose().x, -1, 1e-6);  // in the map frame
}

TEST(SceneFile, HasTheSameBytesAgain) {
  const testing::TempFolder folder;
  write("graph", folder / "a.3Dscene");
  write("graph", folder / "b.3Dscene");
  EXPECT_EQ(resources::fileSha256(folder / "a.3Dscene"), resources::fileSha256(folder / "b.3Dscene"));
}

TEST(SceneFile, ThatIsNoSceneIsAnInputError) {
  const testing::TempFolder folder;
  std::ofstream(folder / "no.3Dscene") << "something else";
  try {
    addTruthToScene({}, nullptr, {}, folder / "no.3Dscene");
    FAIL();
  } catch (const core::InputError& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("no.3Dscene: is not a scene, expected MRPT's .3Dscene"));
  }
  EXPECT_THROW(addTruthToScene({}, nullptr, {}, folder / "none.3Dscene"), core::InputError);
}

TEST(SceneFile, IsSeenFromAboveByItsOwnCamera) {
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  unsetenv("DISPLAY");
  const testing::TempFolder folder;
  write("icp", folder / "icp.3Dscene");
  COpenGLScene scene;
  ASSERT_TRUE(scene.loadFromFile(folder / "icp.3Dscene"));
  mrpt::img::CImage picture;
  try {
    mrpt::opengl::CFBORender renderer(300, 300);
    renderer.setCamera(scene, scene.getViewport("main")->getCamera());
    renderer.render_RGB(scene, picture);
  } catch (const std::exception& error) {
    GTEST_SKIP() << "no off-screen rendering here: " << std::string(error.what()).substr(0, 120);
  }
  // Free cells are white, the robot and the scan's returns vermillion, the path blue.
  int red = 0, blue = 0, white = 0;
  for (unsigned y = 0; y < 300; ++y)
    for (unsigned x = 0; x < 300; ++x) {
      const auto* pixel = picture.ptr<std::uint8_t>(x, y);  // blue, green, red
      if (pixel[2] > 180 && pixel[0] < 90) ++red;
      if (pixel[0] > 140 && pixel[2] < 60) ++blue;
      if (pixel[0] > 240 && pixel[1] > 240 && pixel[2] > 240) ++white;
    }
  EXPECT_GT(red, 20);
  EXPECT_GT(blue, 20);
  EXPECT_GT(white, 5000);
}

}  // namespace
}  // namespace slam::results

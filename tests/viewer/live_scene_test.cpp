#include "libslam/viewer/live_scene.h"

#include <gtest/gtest.h>
#include <mrpt/opengl/CSetOfTriangles.h>

#include <array>
#include <opencv2/imgcodecs.hpp>

#include "libslam/core/error.h"

namespace slam::viewer {
namespace {

/// A room of 8 x 6 m with walls one cell of 0.1 m thick, its lower left corner at (-4, -3).
world::Plan room() {
  world::Plan plan;
  plan.name = "room";
  plan.columns = 80, plan.rows = 60;
  plan.resolution_m = 0.1;
  plan.T_frame_raster = {-4, -3, 0};
  plan.cells.assign(4800, world::Cell::kFree);
  for (int row = 0; row < 60; ++row)
    for (int column = 0; column < 80; ++column)
      if (row == 0 || column == 0 || row == 59 || column == 79)
        plan.cells[static_cast<size_t>(row) * 80 + column] = world::Cell::kOccupied;
  return plan;
}

Snapshot robotAt(const core::Pose2& T_world_robot) {
  Snapshot snapshot;
  snapshot.title = "test";
  snapshot.T_map_robot = snapshot.T_scene_truth.emplace(T_world_robot);
  snapshot.scan.ranges_m.assign(2, lidar::kNoReturn);
  snapshot.scan.step_rad = 1;
  return snapshot;
}

bool isLayer(const LiveScene& scene, const char* name) {
  return scene.scene()->getViewport("main")->getByName(name) != nullptr;
}

std::shared_ptr<gridmap::OccupancyRaster> mapWithAWall() {
  auto map = std::make_shared<gridmap::OccupancyRaster>();
  map->columns = 20, map->rows = 10, map->resolution_m = 0.1;
  map->occupancy.assign(200, 0.1F);
  for (int column = 0; column < 20; ++column) map->occupancy[static_cast<size_t>(column)] = 0.95F;
  map->occupancy[199] = 0.5F;
  return map;
}

/// The picture, or nothing where the machine cannot render.
std::optional<cv::Mat> rendered(LiveScene& scene, const Camera& camera) {
  try {
    const std::string png = renderPng(scene, camera);
    const cv::Mat bytes(1, static_cast<int>(png.size()), CV_8UC1, const_cast<char*>(png.data()));
    return cv::imdecode(bytes, cv::IMREAD_COLOR);
  } catch (const core::IoError&) {
    return std::nullopt;
  }
}

bool isNear(const cv::Mat& picture, const draw::Pixel& at, draw::Colour colour, int slack = 12) {
  const auto& pixel = picture.at<cv::Vec3b>(static_cast<int>(at.y), static_cast<int>(at.x));
  return std::abs(pixel[0] - colour.blue) <= slack && std::abs(pixel[1] - colour.green) <= slack &&
         std::abs(pixel[2] - colour.red) <= slack;
}

TEST(CameraOver, ShowsTheWholeAreaWhateverTheShapes) {
  for (const WindowSize size : {WindowSize{1280, 800}, WindowSize{700, 1200}, WindowSize{1920, 480}})
    for (const draw::Window area : {draw::Window{0, 0, 40, 10}, draw::Window{-3, 5, -1, 50}}) {
      const auto camera = cameraOver(area, size);
      double least_x = 1e9, most_x = 0, least_y = 1e9, most_y = 0;
      for (const core::Point2 corner : {core::Point2{area.x0, area.y0}, core::Point2{area.x1, area.y1}}) {
        const auto pixel = pixelOf(corner, camera, size);
        least_x = std::min(least_x, pixel.x), most_x = std::max(most_x, pixel.x);
        least_y = std::min(least_y, pixel.y), most_y = std::max(most_y, pixel.y);
      }
      EXPECT_GT(least_x, 0);
      EXPECT_GT(least_y, 0);
      EXPECT_LT(most_x, size.sceneWidth());
      EXPECT_LT(most_y, size.height);
      // As large as it can be: one of the sides is nearly filled.
      EXPECT_GT(std::max((most_x - least_x) / size.sceneWidth(), (most_y - least_y) / size.height), 0.85);
    }
}

TEST(PlaceAt, IsTheOtherWayRoundFromAbove) {
  const WindowSize size;
  const Camera camera{{3, -2}, 17};
  for (const core::Point2 place : {core::Point2{0, 0}, core::Point2{5, -7}, core::Point2{-3, 4.5}}) {
    const auto found = placeAt(pixelOf(place, camera, size), camera, size);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->x, place.x, 1e-9);
    EXPECT_NEAR(found->y, place.y, 1e-9);
  }
  EXPECT_FALSE(placeAt({100, 100}, {{0, 0}, 10, -90, 0}, size));
}

TEST(PlaceAt, FindsTheRobotWhereItIsDrawnFromAnySide) {
  const auto plan = room();
  const std::pair<double, double> cameras[] = {{-60, 60}, {30, 35}, {150, 75}};
  for (const auto& [azimuth_deg, elevation_deg] : cameras) {
    const Camera camera{{0.5, 0}, 20, azimuth_deg, elevation_deg};
    LiveScene scene(&plan, 0.6, {});
    scene.show(robotAt({2, -1, 0.3}), {});
    const auto picture = rendered(scene, camera);
    if (!picture) GTEST_SKIP() << "EGL gives no context here";
    double x = 0, y = 0;
    int pixels = 0;
    for (int row = 0; row < picture->rows; ++row)
      for (int column = 0; column < WindowSize().sceneWidth(); ++column)
        if (isNear(*picture, {1.0 * column, 1.0 * row}, draw::kVermillion)) x += column, y += row, ++pixels;
    ASSERT_GT(pixels, 100);
    const auto place = placeAt({x / pixels, y / pixels}, camera, {}, heightOf(kRobotLayer));
    // The white arrow on the robot is ahead of its centre: what is vermillion lies a little behind.
    EXPECT_NEAR(place->x, 2, 0.06) << azimuth_deg << " " << elevation_deg;
    EXPECT_NEAR(place->y, -1, 0.06) << azimuth_deg << " " << elevation_deg;
  }
}

TEST(LiveScene, HasALayerForWhatThereIsAndNoneForTheRest) {
  const auto plan = room();
  LiveScene scene(&plan, 0.4, {});
  auto snapshot = robotAt({});
  scene.show(snapshot, {});
  for (const char* name : {kPlanLayer, kScanLayer, kRobotLayer}) EXPECT_TRUE(isLayer(scene, name)) << name;
  const std::array<const char*, 10> others = {kStrategicLayer, kMapLayer,      kTruthLayer,  kGraphLayer,
                                              kPathLayer,      kLoopsLayer,    kPeopleLayer, kCandidatesLayer,
                                              kObstaclesLayer, kParticlesLayer};
  for (const char* name : others) EXPECT_FALSE(isLayer(scene, name)) << name;

  snapshot.map = mapWithAWall();
  snapshot.truth = snapshot.path = {{0, {0, 0, 0}}, {1, {1, 0, 0}}};
  snapshot.nodes = {{0, 0}, {1, 0}};
  snapshot.edges = snapshot.loops = {{{0, 0}, {1, 0}}};
  snapshot.people = {{{1, 1}, 0.2}};
  snapshot.candidates = Candidates{{{1, 1}}, {2, 2}, {{0, 0}, {2, 2}}};
  snapshot.obstacles = LocalObstacles{{}, {{1, 0}}, {}, 4, 2, 5};
  snapshot.particles = {{0, 0, 0}, {0.1, 0, 0}};
  snapshot.strategic = StrategicView{0.3, {{1, 0}}};
  scene.show(snapshot, {});
  for (const char* name : others) EXPECT_TRUE(isLayer(scene, name)) << name;

  scene.show(robotAt({}), {});
  for (const char* name : others) EXPECT_FALSE(isLayer(scene, name)) << name;
}

TEST(LiveScene, DrawsNoLayerThatIsSwitchedOff) {
  const auto plan = room();
  LiveScene scene(&plan, 0.3, {});
  auto snapshot = robotAt({0, 0, 0});
  snapshot.map = mapWithAWall();
  const auto isDrawn = [&](const char* name) {
    return scene.scene()->getViewport("main")->getByName(name)->isVisible();
  };
  scene.show(snapshot, {});
  EXPECT_TRUE(isDrawn(kMapLayer));
  scene.hide("72");
  EXPECT_FALSE(isDrawn(kMapLayer));
  EXPECT_FALSE(isDrawn(kScanLayer));
  EXPECT_TRUE(isDrawn(kRobotLayer));
  snapshot.map = mapWithAWall();  // a new one is off as well
  scene.show(snapshot, {});
  EXPECT_FALSE(isDrawn(kMapLayer));
  scene.hide("");
  EXPECT_TRUE(isDrawn(kMapLayer));
  // Every layer but the robot has a key, and no key is there twice.
  std::string keys;
  for (const auto& one : layerSwitches()) {
    EXPECT_EQ(keys.find(one.key), std::string::npos);
    keys += one.key;
  }
}

TEST(LiveScene, LeavesTheMapAloneUntilThereIsANewOne) {
  LiveScene scene(nullptr, 0.4, {});
  auto snapshot = robotAt({});
  snapshot.map = mapWithAWall();
  scene.show(snapshot, {});
  const auto first = scene.scene()->getViewport("main")->getByName(kMapLayer);
  scene.show(snapshot, {});
  EXPECT_EQ(scene.scene()->getViewport("main")->getByName(kMapLayer), first);
  snapshot.map = mapWithAWall();
  scene.show(snapshot, {});
  EXPECT_NE(scene.scene()->getViewport("main")->getByName(kMapLayer), first);
}

TEST(LiveScene, WithoutAPlanItLooksAtTheMapAndThePath) {
  LiveScene scene(nullptr, 0.4, {});
  Snapshot snapshot = robotAt({});
  snapshot.T_scene_truth.reset();
  scene.show(snapshot, {});
  EXPECT_GE(scene.area().width(), 8);  // a scene that has only begun is not a point
  snapshot.path = {{0, {0, 0, 0}}, {1, {50, 20, 0}}};
  scene.show(snapshot, {});
  EXPECT_GE(scene.area().x1, 50);
  EXPECT_GE(scene.area().y1, 20);
}

TEST(LiveScene, ThePictureHasEverythingWhereItBelongs) {
  const auto plan = room();
  const WindowSize size{1000, 700};
  LiveScene scene(&plan, 0.8, size);
  auto snapshot = robotAt({2, 1, core::kPi / 2});
  snapshot.T_scene_map = {-1, -2, 0};
  snapshot.T_map_robot = core::between(snapshot.T_scene_map, *snapshot.T_scene_truth);
  snapshot.map = mapWithAWall();
  snapshot.loops = {{{0.5, 3}, {1.5, 3}}};
  scene.show(snapshot, {});
  const auto camera = cameraOver(scene.area(), size);
  const auto picture = rendered(scene, camera);
  if (!picture) GTEST_SKIP() << "EGL gives no context here";
  ASSERT_EQ(picture->cols, size.width);
  ASSERT_EQ(picture->rows, size.height);
  const auto at = [&](double x, double y) { return pixelOf({x, y}, camera, size); };
  // The robot's square is painted beside its white arrow, and ahead of it, at 0.5 m, is floor.
  EXPECT_TRUE(isNear(*picture, at(2.35, 1.3), draw::kVermillion));
  EXPECT_TRUE(isNear(*picture, at(1.65, 0.7), draw::kVermillion));
  EXPECT_TRUE(isNear(*picture, at(2, 1.1), {255, 255, 255}));  // the arrow: wide behind, narrow ahead
  EXPECT_TRUE(isNear(*picture, at(2.12, 0.82), {255, 255, 255}));
  EXPECT_TRUE(isNear(*picture, at(2.12, 1.2), draw::kVermillion));
  EXPECT_TRUE(isNear(*picture, at(2, 1.9), {226, 228, 232}));
  EXPECT_TRUE(isNear(*picture, at(-3.95, 0), {150, 150, 155}));  // the plan's wall
  // The map's lowest row is a wall, from its own origin on; above it is white floor, and one cell that it
  // does not know.
  EXPECT_TRUE(isNear(*picture, at(-0.5, -1.95), {30, 30, 30}, 30));
  EXPECT_TRUE(isNear(*picture, at(-0.5, -1.5), {255, 255, 255}));
  EXPECT_TRUE(isNear(*picture, at(0.95, -1.05), {226, 228, 232}));
  EXPECT_TRUE(isNear(*picture, at(0, 1), draw::kOrange));                                  // the loop
  EXPECT_TRUE(isNear(*picture, {size.width - 10.0, size.height - 5.0}, {247, 247, 247}));  // the panel
}

TEST(LiveScene, LiesInSheetsThatHideEachOtherInTheirOrder) {
  const auto plan = room();
  const WindowSize size{1000, 700};
  LiveScene scene(&plan, 0.8, size);
  auto snapshot = robotAt({});
  // All of it crosses the robot's square: what lies below it must not show.
  snapshot.truth = snapshot.path = {{0, {-2, 0.3, 0}}, {1, {2, 0.3, 0}}};
  snapshot.loops = {{{-2, 0.3}, {2, 0.3}}};
  snapshot.nodes = {{0.3, 0.3}, {1, 0.3}};
  scene.show(snapshot, {});
  const auto camera = cameraOver(scene.area(), size);
  const auto picture = rendered(scene, camera);
  if (!picture) GTEST_SKIP() << "EGL gives no context here";
  EXPECT_TRUE(isNear(*picture, pixelOf({0.3, 0.3}, camera, size), draw::kVermillion));
  EXPECT_TRUE(isNear(*picture, pixelOf({1.5, 0.3}, camera, size), draw::kOrange));  // loops lie over the path
}

TEST(Layers, LeaveOutWhatIsNotFinite) {
  const double nan = std::nan("");
  const auto layer = pathLayer({{0, {0, 0, 0}}, {1, {nan, 0, 0}}, {2, {2, 0, 0}}}, 0.1);
  const auto shapes = std::dynamic_pointer_cast<mrpt::opengl::CSetOfTriangles>(layer);
  ASSERT_TRUE(shapes);
  EXPECT_EQ(shapes->getTrianglesCount(), 0U);
  const auto particles =
      std::dynamic_pointer_cast<mrpt::opengl::CSetOfTriangles>(particlesLayer({{nan, 0, 0}, {0, 0, 0}}, 0.1));
  EXPECT_EQ(particles->getTrianglesCount(), 1U);
  const auto whole = std::dynamic_pointer_cast<mrpt::opengl::CSetOfTriangles>(
      pathLayer({{0, {0, 0, 0}}, {1, {1, 0, 0}}, {2, {2, 1, 0}}}, 0.1));
  EXPECT_EQ(whole->getTrianglesCount(), 4U);  // two pieces
}

size_t trianglesOfPath(const core::Trajectory& path, double line_m) {
  return std::dynamic_pointer_cast<mrpt::opengl::CSetOfTriangles>(pathLayer(path, line_m))
      ->getTrianglesCount();
}

TEST(Layers, DrawAPathWithNoMorePiecesThanItsWidthShows) {
  core::Trajectory there_and_back, round;
  for (int i = 0; i <= 4000; ++i) {
    const double way_m = i <= 2000 ? 0.01 * i : 40 - 0.01 * i;
    there_and_back.push_back({0.1 * i, {way_m, 0.002 * (i % 2), 0}});
    round.push_back({0.1 * i, core::Pose2{0, 0, 1e-3 * core::kPi * i / 2} * core::Pose2{5, 0, 0}});
  }
  EXPECT_EQ(trianglesOfPath(there_and_back, 0.1), 4U);
  EXPECT_EQ(trianglesOfPath({{0, {1, 1, 0}}, {1, {1, 1, 0}}}, 0.1), 2U);  // a dot
  EXPECT_GT(trianglesOfPath(round, 0.1), 50U);
  EXPECT_LT(trianglesOfPath(round, 0.1), 200U);
  const double nan = std::nan("");
  EXPECT_EQ(trianglesOfPath(
                {{0, {0, 0, 0}}, {1, {1, 0, 0}}, {2, {nan, 0, 0}}, {3, {5, 0, 0}}, {4, {6, 0, 0}}}, 0.1),
            4U);
}

TEST(Layers, DrawALargeGraphThinned) {
  const auto trianglesOf = [](size_t nodes) {
    const std::vector<core::Point2> places(nodes, {1, 2});
    const auto layer =
        std::dynamic_pointer_cast<mrpt::opengl::CSetOfObjects>(graphLayer(places, {{{0, 0}, {1, 0}}}, 0.1));
    return std::dynamic_pointer_cast<mrpt::opengl::CSetOfTriangles>(*std::next(layer->begin()))
        ->getTrianglesCount();
  };
  EXPECT_EQ(trianglesOf(kMostDots), 24 * kMostDots);
  EXPECT_EQ(trianglesOf(kMostDots + 1), 24 * ((kMostDots + 2) / 2));
}

}  // namespace
}  // namespace slam::viewer

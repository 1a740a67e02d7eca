#include "libslam/robot/camera.h"
#include "libslam/core/numbers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"

namespace slam::robot {
namespace {

using core::degToRad;
using core::kInfinity;

FloorCamera camera(double height_m = 0.5, double pitch_deg = 25, double fov_x_deg = 60,
                   double fov_y_deg = 45) {
  FloorCamera camera;
  camera.view.height_m = height_m;
  camera.view.pitch_rad = degToRad(pitch_deg);
  camera.view.fov_x_rad = degToRad(fov_x_deg);
  camera.view.fov_y_rad = degToRad(fov_y_deg);
  return camera;
}

std::string errorOf(const FloorCamera& camera) {
  try {
    requireSensible(camera);
  } catch (const core::InputError& e) {
    return e.what();
  }
  return "";
}

/// The document's and the pinhole's condition, written out anew: where a floor point lies in the picture.
bool isInPicture(const FloorCamera& camera, double x_m, double y_m) {
  const auto& view = camera.view;
  const double depth = x_m * std::cos(view.pitch_rad) + view.height_m * std::sin(view.pitch_rad);
  const double below = view.height_m * std::cos(view.pitch_rad) - x_m * std::sin(view.pitch_rad);
  return depth > 0 && std::abs(below) < depth * std::tan(view.fov_y_rad / 2) &&
         std::abs(y_m) < depth * std::tan(view.fov_x_rad / 2);
}

TEST(FloorCameras, SeeAlongABearingWhatIsInThePictureAndWithinReach) {
  for (const auto& eye :
       {camera(), camera(1.2, 60), camera(0.3, 5, 90), camera(0.5, -10), camera(2, 90, 40, 30)}) {
    const double most_m = asLidar(eye).max_range_m;
    for (int degree = -85; degree <= 85; degree += 5) {
      const auto span = bearingSpan(eye, degToRad(degree));
      for (double r = 0.005; r < eye.scan.reach_m + 0.5; r += 0.05) {
        const double x = r * std::cos(degToRad(degree)), y = r * std::sin(degToRad(degree));
        const bool is_near_a_border = std::abs(r - span.begin_m) < 1e-6 || std::abs(r - span.end_m) < 1e-6;
        const bool is_within = r <= most_m;
        if (is_near_a_border) continue;
        ASSERT_EQ(r > span.begin_m && r < span.end_m, is_within && isInPicture(eye, x, y))
            << degree << " deg, " << r << " m, pitch " << core::radToDeg(eye.view.pitch_rad);
      }
    }
  }
}

TEST(FloorCameras, GiveAScanFromTheDeadZoneToTheFarEdgeOrTheReach) {
  auto eye = camera();
  eye.view.x_m = 0.2, eye.view.y_m = -0.05;
  auto lidar = asLidar(eye);
  EXPECT_NEAR(lidar.min_range_m, 0.5 / std::tan(degToRad(47.5)), 1e-12)
      << "Ymin = ZC / tan(pitch + FOVy / 2)";
  EXPECT_EQ(lidar.max_range_m, 4) << "the far edge is at 11 m";
  EXPECT_EQ(lidar.mount_x_m, 0.2);
  EXPECT_EQ(lidar.mount_y_m, -0.05);
  EXPECT_EQ(lidar.mount_yaw_rad, 0);
  EXPECT_NEAR(lidar::beamStep(lidar), degToRad(0.5), 1e-12);
  // As far aside as the near corner: Xm / Ymin there, rounded inwards to a whole bearing.
  const auto floor = visibleFloor(eye.view);
  const double corner_rad = std::atan2(floor.halfWidth_m(floor.nearest_m), floor.nearest_m - floor.x_m);
  EXPECT_LE(-lidar::firstAngle(lidar), corner_rad);
  EXPECT_GT(-lidar::firstAngle(lidar), corner_rad - degToRad(0.5) - 1e-9);
  // All of the depth only within the trapezoid's slope, cos(pitch) tan(FOVx / 2).
  EXPECT_NEAR(wholeHalfAngle(eye), std::atan(std::cos(degToRad(25)) * std::tan(degToRad(30))), degToRad(2));
  eye = camera(0.5, 40);
  EXPECT_NEAR(asLidar(eye).max_range_m, 0.5 / std::tan(degToRad(17.5)), 1e-12) << "the far edge";
}

TEST(FloorCameras, OfTheDocumentSeeAWedgeWithoutAFarEdge) {
  auto eye = camera(0.5, 40);
  eye.view.area = "original";
  EXPECT_EQ(asLidar(eye).max_range_m, 4);
  EXPECT_NEAR(-lidar::firstAngle(asLidar(eye)), degToRad(30), degToRad(0.5) + 1e-9) << "Xm = y tan(FOVx / 2)";
  EXPECT_NEAR(wholeHalfAngle(eye), -lidar::firstAngle(asLidar(eye)), 1e-12);
}

TEST(FloorCameras, ThatCannotWorkAreRefusedInOneLineThatNamesTheKey) {
  EXPECT_EQ(errorOf(camera()), "");
  EXPECT_EQ(
      errorOf(camera(0.5, -30)),
      "section [camera], key 'pitch_deg': found '-30', expected more than -22.5: the camera looks above the "
      "horizon and sees no floor");
  auto eye = camera();
  eye.scan.reach_m = 0.4;
  EXPECT_EQ(
      errorOf(eye),
      "section [camera_scan], key 'reach_m': found '0.4', expected more than Ymin = 0.458166 m, where the "
      "visible floor begins");
  EXPECT_THAT(errorOf(camera(0.5, -22.4)), testing::HasSubstr("'reach_m'")) << "286 m away";
  eye = camera(0.5, 25, 0.2);
  EXPECT_THAT(errorOf(eye),
              testing::StartsWith("section [camera_scan], key 'beams_per_circle': found '720'"));
}

TEST(FloorCameras, TellFreeFloorFromObstaclesAndFromWhatTheyCannotSee) {
  auto eye = camera();
  eye.scan.edge_sigma_rad = 0;
  const auto lidar = asLidar(eye);
  const auto middle = static_cast<size_t>(lidar.beams / 2);
  core::RandomStream random(1, "camera");
  const auto reading = [&](size_t beam, double exact_m) {
    std::vector<float> ranges_m(static_cast<size_t>(lidar.beams), static_cast<float>(exact_m));
    applyCameraErrors(eye, random, ranges_m);
    return ranges_m[beam];
  };
  EXPECT_NEAR(reading(middle, 2), 2, 1e-6);
  EXPECT_EQ(reading(middle, kInfinity), lidar::kNoReturn);
  EXPECT_EQ(reading(middle, 4.001), lidar::kNoReturn) << "beyond the reach";
  EXPECT_TRUE(std::isnan(reading(middle, 0.458))) << "in the dead zone";
  EXPECT_NEAR(reading(middle, 0.459), 0.459, 1e-6);
  EXPECT_TRUE(std::isnan(reading(0, kInfinity))) << "the picture's side ends the floor";
  EXPECT_TRUE(std::isnan(reading(0, 2)));
  const auto span = bearingSpan(eye, lidar::firstAngle(lidar));
  EXPECT_NEAR(reading(0, (span.begin_m + span.end_m) / 2), (span.begin_m + span.end_m) / 2, 1e-6);
}

TEST(FloorCameras, ErrWithTheSquareOfTheDistance) {
  auto eye = camera();
  eye.scan.edge_sigma_rad = degToRad(0.05);
  // By the derivative of r = H / tan(angle), numerically.
  const double angle_rad = std::atan2(0.5, 3.0);
  const double slope = (0.5 / std::tan(angle_rad - 1e-6) - 0.5 / std::tan(angle_rad + 1e-6)) / 2e-6;
  EXPECT_NEAR(edgeSigma(eye, 3), slope * degToRad(0.05), 1e-8);
  EXPECT_EQ(lidar::statedSigma(asLidar(eye)), edgeSigma(eye, 3));

  core::RandomStream random(7, "camera");
  const auto lidar = asLidar(eye);
  double sum = 0, squares = 0;
  constexpr int kScans = 4000;
  for (int i = 0; i < kScans; ++i) {
    std::vector<float> ranges_m(static_cast<size_t>(lidar.beams), 2.0F);
    applyCameraErrors(eye, random, ranges_m);
    const double error = ranges_m[static_cast<size_t>(lidar.beams / 2)] - 2.0;
    sum += error, squares += error * error;
  }
  // Five standard errors: sigma / sqrt(n), and 1 / sqrt(2 n) of sigma.
  EXPECT_NEAR(sum / kScans, 0, 5 * edgeSigma(eye, 2) / std::sqrt(kScans));
  EXPECT_NEAR(std::sqrt(squares / kScans) / edgeSigma(eye, 2), 1, 5 / std::sqrt(2.0 * kScans));
}

}  // namespace
}  // namespace slam::robot

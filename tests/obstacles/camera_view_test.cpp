#include "libslam/obstacles/camera_view.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>

#include "libslam/core/error.h"
#include "libslam/core/random.h"

namespace slam::obstacles {
namespace {

using core::kInfinity;
constexpr double kRounding = 1e-9;  // coordinates of metres, lengthened by flat lines of sight

CameraOptions camera(double pitch_deg, double fov_x_deg = 60, double fov_y_deg = 45) {
  CameraOptions options;
  options.x_m = 0.2, options.y_m = -0.1, options.height_m = 0.6;
  options.pitch_rad = core::degToRad(pitch_deg);
  options.fov_x_rad = core::degToRad(fov_x_deg), options.fov_y_rad = core::degToRad(fov_y_deg);
  return options;
}

/// A pinhole camera in three dimensions with a picture of 640 x 480 pixels, as a computer vision text has it:
/// rotate into the camera's axes (right, down, forward), divide by the depth, scale.
class Pinhole {
 public:
  explicit Pinhole(const CameraOptions& o) : eye_{o.x_m, o.y_m, o.height_m} {
    const double c = std::cos(o.pitch_rad), s = std::sin(o.pitch_rad);
    forward_ = {c, 0, -s};
    right_ = {0, -1, 0};
    down_ = {forward_[1] * right_[2] - forward_[2] * right_[1],  // forward x right
             forward_[2] * right_[0] - forward_[0] * right_[2],
             forward_[0] * right_[1] - forward_[1] * right_[0]};
    focal_x_ = 320 / std::tan(o.fov_x_rad / 2), focal_y_ = 240 / std::tan(o.fov_y_rad / 2);
  }

  /// Pixel of a floor point; nullopt behind the camera.
  std::optional<core::Point2> project(const core::Point2& p) const {
    const std::array<double, 3> ray{p.x - eye_[0], p.y - eye_[1], -eye_[2]};
    const double depth = dot(ray, forward_);
    if (depth <= 0) return std::nullopt;
    return core::Point2{320 + focal_x_ * dot(ray, right_) / depth, 240 + focal_y_ * dot(ray, down_) / depth};
  }
  bool sees(const core::Point2& p) const {
    const auto pixel = project(p);
    return pixel && pixel->x > 0 && pixel->x < 640 && pixel->y > 0 && pixel->y < 480;
  }

 private:
  using Vector = std::array<double, 3>;
  static double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
  Vector eye_, forward_, right_, down_;
  double focal_x_, focal_y_;
};

TEST(CameraView, SeesTheFloorThatAPinholeCameraProjectsIntoItsPicture) {
  core::RandomStream random(3, "camera");
  for (const double pitch_deg : {-30.0, -10.0, 0.0, 5.0, 22.5, 40.0, 67.5, 80.0, 90.0})
    for (const double fov_y_deg : {20.0, 45.0, 120.0}) {
      const auto options = camera(pitch_deg, 70, fov_y_deg);
      const CameraView view(options);
      const Pinhole pinhole(options);
      int seen = 0;
      for (int i = 0; i < 20000; ++i) {
        // Half of the points near the camera's foot, where steep cameras look.
        const double reach = i % 2 ? 1.5 : 12;
        const core::Point2 p{random.uniform(-reach, reach), random.uniform(-reach, reach)};
        ASSERT_EQ(view.contains(p), pinhole.sees(p))
            << "pitch " << pitch_deg << ", fov " << fov_y_deg << " at " << p.x << ", " << p.y;
        seen += view.contains(p);
      }
      EXPECT_EQ(seen > 0, pitch_deg + fov_y_deg / 2 > 0);
    }
}

TEST(CameraView, ItsCornersAreTheCornersOfThePicture) {
  for (const double pitch_deg : {25.0, 40.0, 80.0}) {  // all of the picture shows floor
    const auto options = camera(pitch_deg);
    const auto corners = CameraView(options).outline(1000);
    ASSERT_EQ(corners.size(), 4U);
    // From the right of the near edge round by the far edge.
    const std::array<core::Point2, 4> pixels{{{640, 480}, {640, 0}, {0, 0}, {0, 480}}};
    for (size_t i = 0; i < 4; ++i) {
      const auto pixel = Pinhole(options).project(corners[i]);
      ASSERT_TRUE(pixel);
      EXPECT_NEAR(pixel->x, pixels[i].x, 1e-6);  // pixels: rounding times the focal length over the depth
      EXPECT_NEAR(pixel->y, pixels[i].y, 1e-6);
    }
  }
}

TEST(CameraView, TheDeadZoneEndsWhereTheLowestLineOfSightMeetsTheFloor) {
  // 0.6 m high, pitch 22.5 and half of 45 degrees: the lowest line falls by 45 degrees.
  const CameraView view(camera(22.5));
  EXPECT_NEAR(view.nearest_m(), 0.2 + 0.6, kRounding);
  EXPECT_EQ(view.farthest_m(), kInfinity);  // the highest line is level
  EXPECT_FALSE(view.contains({0.79, -0.1}));
  EXPECT_TRUE(view.contains({0.81, -0.1}));
  EXPECT_TRUE(view.contains({1e6, -0.1}));
  // Pitch 52.5: the highest line falls by 30 degrees, the lowest by 75.
  const CameraView steep(camera(52.5));
  EXPECT_NEAR(steep.farthest_m(), 0.2 + 0.6 * std::sqrt(3.0), kRounding);
  EXPECT_NEAR(steep.nearest_m(), 0.2 + 0.6 * (2 - std::sqrt(3.0)), kRounding);
  EXPECT_FALSE(steep.contains({steep.farthest_m() + 0.01, -0.1}));
  // Looking up: no floor at all.
  EXPECT_FALSE(CameraView(camera(-30)).contains({3, 0}));
  EXPECT_TRUE(CameraView(camera(-30)).outline(10).empty());
}

TEST(CameraView, TheOriginalsWedgeIsTheExactOneOnlyForALevelCamera) {
  auto level = camera(0);
  const CameraView exact_level(level);
  level.area = "original";
  const CameraView original_level(level);
  for (const double x : {0.9, 2.0, 7.0})
    EXPECT_NEAR(original_level.halfWidth_m(x), exact_level.halfWidth_m(x), kRounding);
  EXPECT_NEAR(original_level.nearest_m(), exact_level.nearest_m(), kRounding);

  auto tilted = camera(30);
  const CameraView exact(tilted);
  tilted.area = "original";
  const CameraView original(tilted);
  EXPECT_EQ(original.nearest_m(), exact.nearest_m());
  EXPECT_EQ(original.farthest_m(), kInfinity);
  EXPECT_LT(exact.farthest_m(), kInfinity);
  // They cross at height / tan(pitch / 2) ahead of the foot; nearer the exact one is wider.
  const double crossing_m = 0.2 + 0.6 / std::tan(core::degToRad(15));
  EXPECT_NEAR(exact.halfWidth_m(crossing_m), original.halfWidth_m(crossing_m), kRounding);
  const double near_m = crossing_m - 1, far_m = crossing_m + 1;
  const core::Point2 near_left{near_m,
                               -0.1 + 0.5 * (exact.halfWidth_m(near_m) + original.halfWidth_m(near_m))};
  EXPECT_TRUE(exact.contains(near_left));
  EXPECT_FALSE(original.contains(near_left));
  const core::Point2 far_right{far_m, -0.1 - 0.5 * (exact.halfWidth_m(far_m) + original.halfWidth_m(far_m))};
  EXPECT_FALSE(exact.contains(far_right));
  EXPECT_TRUE(original.contains(far_right));
}

TEST(CameraView, TheOriginalIsItsDocumentsTestInItsOwnFrame) {
  auto options = camera(35);
  options.area = "original";
  const CameraView view(options);
  const double xc = 0.1, yc = 0.2, zc = 0.6;  // to the right, ahead, up
  const double y_min = yc + zc / std::tan(core::degToRad(35 + 22.5));
  core::RandomStream random(4, "original");
  for (int i = 0; i < 20000; ++i) {
    const double x = random.uniform(-4, 4), y = random.uniform(-2, 6);
    const bool visible = y > y_min && std::abs(x - xc) < (y - yc) * std::tan(core::degToRad(30));
    ASSERT_EQ(view.contains(fromOriginalFrame({x, y})), visible) << x << ", " << y;
  }
}

TEST(OriginalFrame, HasYAheadAndXToTheRight) {
  const auto p = fromOriginalFrame({1, 2});  // 1 to the right, 2 ahead
  EXPECT_EQ(p.x, 2);
  EXPECT_EQ(p.y, -1);
  const auto back = toOriginalFrame(p);
  EXPECT_EQ(back.x, 1);
  EXPECT_EQ(back.y, 2);
  // A quarter turn from "right" to "ahead" is one from "ahead" to "left" in neither frame's disfavour:
  const auto right = fromOriginalFrame({1, 0}), ahead = fromOriginalFrame({0, 1});
  EXPECT_GT(right.x * ahead.y - right.y * ahead.x, 0);  // counter-clockwise in both
}

TEST(CameraView, NothingIsVisibleAtAPointThatIsNotFinite) {
  const CameraView view(camera(22.5));
  for (const core::Point2 p :
       {core::Point2{std::nan(""), 0}, {2, std::nan("")}, {kInfinity, 0}, {2, kInfinity}})
    EXPECT_FALSE(view.contains(p));
}

TEST(CameraOptions, RefusesAnglesThatNoCameraHas) {
  CameraOptions options;
  const auto ini = files::IniFile::parse("[camera]\nfov_x_deg = 180\n", "robot.ini");
  try {
    files::readParameters(ini, CameraOptions::table(), options);
    FAIL();
  } catch (const core::InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "robot.ini:2: section [camera], key 'fov_x_deg': found '180', expected a number from 0.1 to 179");
  }
}

}  // namespace
}  // namespace slam::obstacles

#include "libslam/lidar/beam.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slam::lidar {
namespace {

using core::degToRad;
constexpr double kNothing = std::numeric_limits<double>::infinity();

TEST(RayOffset, SpansTheConeSymmetrically) {
  LidarOptions options;
  options.beam_width_rad = 0.01;
  EXPECT_DOUBLE_EQ(rayOffset(options, 0), -0.005);
  EXPECT_DOUBLE_EQ(rayOffset(options, kRaysPerBeam / 2), 0);
  EXPECT_DOUBLE_EQ(rayOffset(options, kRaysPerBeam - 1), 0.005);
}

TEST(BeamRange, OnOneSurfaceIsTheMeanWhateverIsDrawn) {
  const std::vector<double> flat = {2.00, 2.01, 2.02, 2.03, 2.04};
  EXPECT_DOUBLE_EQ(beamRange(flat, false, 0.7), 2.02);
  EXPECT_DOUBLE_EQ(beamRange(flat, true, 0.7), 2.02);
}

TEST(BeamRange, OnASlantedWallIsNoEdge) {
  // A wall that the beam grazes: neighbours 0.3 m apart and more, but evenly so.
  const double incidence_rad = degToRad(87);
  std::vector<double> ranges_m;
  for (const double offset_deg : {-0.3, -0.15, 0.0, 0.15, 0.3})
    ranges_m.push_back(10 * std::cos(incidence_rad) / std::cos(incidence_rad + degToRad(offset_deg)));
  ASSERT_GT(ranges_m[4] - ranges_m[3], 0.3);
  EXPECT_EQ(beamRange(ranges_m, false, 0), beamRange(ranges_m, true, 1));
}

TEST(BeamRange, AtAnEdgeIsTheNearerSideOrAMixture) {
  const std::vector<double> edge = {5.0, 2.0, 5.2, 2.1, 5.1};  // in any order
  EXPECT_DOUBLE_EQ(beamRange(edge, false, 0.5), 2.05);
  EXPECT_DOUBLE_EQ(beamRange(edge, true, 0), 2.05);
  EXPECT_DOUBLE_EQ(beamRange(edge, true, 1), 5.1);
  EXPECT_DOUBLE_EQ(beamRange(edge, true, 0.25), 2.05 + 0.25 * 3.05);
}

TEST(BeamRange, TakesNothingForNothing) {
  EXPECT_EQ(beamRange({kNothing, kNothing}, true, 0.5), kNothing);
  EXPECT_EQ(beamRange({kNothing, 3.0, kNothing}, true, 0.5), 3.0);  // no mixture with nothing
  EXPECT_EQ(beamRange({3.0}, true, 0.5), 3.0);
  EXPECT_EQ(beamRange({0.0, 0.0}, true, 0.5), 0.0);
}

TEST(BeamRange, DoesNotDependOnTheOrderOfRays) {
  std::vector<double> ranges_m = {1.0, 1.3, 4.0, 4.05, kNothing};
  const double first = beamRange(ranges_m, true, 0.3);
  while (std::next_permutation(ranges_m.begin(), ranges_m.end()))
    ASSERT_EQ(beamRange(ranges_m, true, 0.3), first);
}

TEST(Glass, AnswersHeadOnAndHalfAsOftenAtTheStatedIncidence) {
  LidarOptions options;
  options.glass_echo = 0.9, options.glass_echo_rad = degToRad(4);
  EXPECT_EQ(glassEcho(options, 0), 0.9);
  EXPECT_DOUBLE_EQ(glassEcho(options, degToRad(4)), 0.45);
  EXPECT_DOUBLE_EQ(glassEcho(options, degToRad(8)), 0.9 / 16);
  EXPECT_LT(glassEcho(options, degToRad(40)), 1e-20);
}

TEST(Glass, MirrorsMoreAndMoreUpToAllAtGrazingIncidence) {
  LidarOptions options;
  EXPECT_NEAR(glassReflectance(options, 0), options.glass_reflectance, 1e-15);
  EXPECT_NEAR(glassReflectance(options, core::kPi / 2), 1, 1e-12);
  double before = 0;
  for (int deg = 0; deg <= 90; deg += 5) {
    const double now = glassReflectance(options, degToRad(deg));
    EXPECT_GE(now, before);
    before = now;
  }
}

TEST(Glass, HasTheReflectanceOfTextbooks) {
  LidarOptions options;
  options.glass_reflectance = 2 * 0.04 / 1.04;  // index 1.5
  // At Brewster's angle, atan(1.5), one polarisation passes whole; the other reflects ((n^2-1)/(n^2+1))^2.
  const double face = 0.5 * std::pow(1.25 / 3.25, 2);
  EXPECT_NEAR(glassReflectance(options, std::atan(1.5)), 2 * face / (1 + face), 1e-12);
}

TEST(Glass, CanBeNothingOrAMirror) {
  LidarOptions nothing, mirror;
  nothing.glass_reflectance = 0, mirror.glass_reflectance = 1;
  for (const double incidence_deg : {0.0, 45.0, 89.0}) {
    EXPECT_NEAR(glassReflectance(nothing, degToRad(incidence_deg)), 0, 1e-15);
    EXPECT_EQ(glassReflectance(mirror, degToRad(incidence_deg)), 1);
  }
}

}  // namespace
}  // namespace slam::lidar

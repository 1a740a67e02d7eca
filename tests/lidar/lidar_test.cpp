#include "libslam/lidar/lidar.h"

#include <gmock/gmock.h>

#include <cmath>

#include "libslam/core/error.h"
#include "libslam/files/ini.h"
#include "libslam/testing/error_of.h"

namespace slam::lidar {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Bounds are five standard errors of the estimator: by chance a right program fails once in a million.
constexpr double kSigmas = 5;
constexpr int kDraws = 40000;

LidarOptions exactLidar() {
  LidarOptions options;
  options.sigma_m = 0, options.min_range_m = 0, options.max_range_m = 0;
  return options;
}

std::vector<float> read(const LidarOptions& options, double range_m, int count = kDraws) {
  core::RandomStream random(1, "lidar");
  std::vector<float> ranges_m(static_cast<size_t>(count), static_cast<float>(range_m));
  applyLidarErrors(options, random, ranges_m);
  return ranges_m;
}

double standardDeviation(const std::vector<float>& values, double mean) {
  double squares = 0;
  for (const float value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

TEST(RangeNoise, IsTheLargerOfAFixedSizeAndAShareOfTheRange) {
  LidarOptions options;
  options.sigma_m = 0.01, options.sigma_share = 0.01;  // 10 mm, and 1 % beyond 1 m
  EXPECT_EQ(rangeSigma(options, 0.2), 0.01);
  EXPECT_EQ(rangeSigma(options, 1), 0.01);
  EXPECT_DOUBLE_EQ(rangeSigma(options, 4), 0.04);
  EXPECT_DOUBLE_EQ(statedSigma(options), 0.03);
  EXPECT_EQ(statedSigma(LidarOptions()), LidarOptions().sigma_m);
}

TEST(RangeNoise, HasThatStandardDeviationAtEveryRange) {
  LidarOptions options = exactLidar();
  options.sigma_m = 0.01, options.sigma_share = 0.02;
  for (const double range_m : {0.3, 2.0, 10.0}) {
    const double sigma_m = rangeSigma(options, range_m);
    EXPECT_NEAR(standardDeviation(read(options, range_m), range_m), sigma_m,
                kSigmas * sigma_m / std::sqrt(2.0 * kDraws))
        << range_m;
  }
}

TEST(RangeNoise, ThatGrowsOnlyScalesTheSameDraws) {
  LidarOptions fixed = exactLidar(), growing = exactLidar();
  fixed.sigma_m = 0.05;
  growing.sigma_share = 0.01;
  EXPECT_EQ(read(fixed, 5, 100), read(growing, 5, 100));
}

TEST(Quantum, MakesReadingsItsMultiples) {
  LidarOptions options = exactLidar();
  options.sigma_m = 0.02, options.quantum_m = 0.01;
  for (const float reading_m : read(options, 3.1415, 1000))
    EXPECT_EQ(reading_m, static_cast<float>(std::round(reading_m / 0.01) * 0.01));
  // Without noise the nearest one, 3.14.
  options.sigma_m = 0;
  EXPECT_EQ(read(options, 3.1415, 1)[0], 3.14F);
  EXPECT_EQ(read(options, 3.1451, 1)[0], 3.15F);
}

TEST(Quantum, AddsTheVarianceOfAUniformError) {
  LidarOptions options = exactLidar();
  options.sigma_m = 0.02, options.quantum_m = 0.05;
  // Sheppard: quantum^2 / 12 more; noise of 0.4 quanta leaves exp(-2 pi^2 0.16) = 4 % of ripple, so no mean
  // of an odd place is meant: halfway between two multiples the ripple of the mean is 0.
  const double expected_m = std::hypot(0.02, 0.05 / std::sqrt(12.0));
  const double ripple_m = 0.05 * std::exp(-2 * core::kPi * core::kPi * 0.16);
  EXPECT_NEAR(standardDeviation(read(options, 3.025), 3.025), expected_m,
              ripple_m + kSigmas * expected_m / std::sqrt(2.0 * kDraws));
}

TEST(Quantum, NeverReachesTheMaximumRangeNorZero) {
  LidarOptions options = exactLidar();
  options.max_range_m = 8, options.quantum_m = 0.5;
  EXPECT_EQ(read(options, 7.9, 1)[0], 7.5F);  // not 8, which would be no return
  EXPECT_EQ(read(options, 7.6, 1)[0], 7.5F);
  EXPECT_TRUE(std::isnan(read(options, 0.2, 1)[0]));
  EXPECT_EQ(read(options, 8.1, 1)[0], kNoReturn);
}

TEST(Sweep, SharesOutItsTimeEvenlyAmongTheBeams) {
  LidarOptions options;
  options.beams = 4, options.rate_hz = 5;
  for (int beam = 0; beam < 4; ++beam) EXPECT_EQ(secondsBeforeLastBeam(options, beam), 0);
  options.sweep = 1;
  for (int beam = 0; beam < 4; ++beam)
    EXPECT_DOUBLE_EQ(secondsBeforeLastBeam(options, beam), 0.05 * (3 - beam)) << beam;
  // Without a gap: a beam after the last one is the first of the next scan, 0.2 s later.
  EXPECT_DOUBLE_EQ(secondsBeforeLastBeam(options, 0) + 0.05, 1 / options.rate_hz);
  options.sweep = 0.5, options.sweep_clockwise = true;
  for (int beam = 0; beam < 4; ++beam) EXPECT_DOUBLE_EQ(secondsBeforeLastBeam(options, beam), 0.025 * beam);
}

TEST(Mounting, ErrorMovesTheDeviceAndNotWhatItStates) {
  LidarOptions options;
  options.mount_x_m = 0.2, options.mount_yaw_rad = 0.5;
  options.mount_error_x_m = 0.01, options.mount_error_y_m = -0.02, options.mount_error_yaw_rad = 0.03;
  const core::Pose2 stated = mountingPose(options), truly = trueMountingPose(options);
  EXPECT_EQ(stated.x, 0.2);
  EXPECT_EQ(stated.y, 0);
  EXPECT_EQ(stated.phi, 0.5);
  EXPECT_DOUBLE_EQ(truly.x, 0.21);
  EXPECT_DOUBLE_EQ(truly.y, -0.02);
  EXPECT_DOUBLE_EQ(truly.phi, 0.53);
}

TEST(LidarOptionsCheck, RefusesLimitsThatContradictEachOther) {
  LidarOptions options;
  EXPECT_NO_THROW(requireSensible(options));
  options.min_range_m = 30;
  EXPECT_EQ(testing::errorOf([&] { requireSensible(options); }),
            "section [lidar], key 'min_range_m': found '30', expected less than max_range_m = 30");
  options.max_range_m = 0;  // no limit
  EXPECT_NO_THROW(requireSensible(options));
  options.max_range_m = 0.5, options.min_range_m = 0, options.quantum_m = 1;
  EXPECT_THAT(testing::errorOf([&] { requireSensible(options); }), HasSubstr("'quantum_m': found '1'"));
}

TEST(LidarOptionsCheck, RefusesEveryNumberOutOfBounds) {
  for (const auto& [key, value] :
       std::vector<std::pair<std::string, std::string>>{{"fov_deg", "361"},
                                                        {"fov_deg", "0"},
                                                        {"fov_deg", "nan"},
                                                        {"beams", "0"},
                                                        {"beams", "1"},
                                                        {"beams", "-5"},
                                                        {"beams", "2.5"},
                                                        {"max_range_m", "-1"},
                                                        {"max_range_m", "inf"},
                                                        {"sigma_m", "-0.01"},
                                                        {"sigma_share", "-0.1"},
                                                        {"sigma_share", "1.5"},
                                                        {"quantum_m", "-0.01"},
                                                        {"beam_width_deg", "-1"},
                                                        {"mixed_pixels", "2"},
                                                        {"sweep", "1.1"},
                                                        {"sweep", "nan"},
                                                        {"sweep_clockwise", "left"},
                                                        {"latency_s", "-0.1"},
                                                        {"dark_range_m", "-1"},
                                                        {"glass_echo", "2"},
                                                        {"glass_echo_deg", "0"},
                                                        {"rate_hz", "0"},
                                                        {"drop_out", "1.01"},
                                                        {"glass_reflectance", "-1"},
                                                        {"mount_error_yaw_deg", "200"}}) {
    files::IniFile ini;
    ini.set("lidar", key, value, "test.ini:1");
    LidarOptions options;
    EXPECT_THAT(testing::errorOf([&] { files::readParameters(ini, LidarOptions::table(), options); }),
                AllOf(HasSubstr("test.ini:1: section [lidar], key '" + key), HasSubstr("': found '" + value),
                      HasSubstr("', expected ")));
  }
}

}  // namespace
}  // namespace slam::lidar

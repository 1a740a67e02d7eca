#include <gmock/gmock.h>

#include <filesystem>

#include "libslam/files/ini.h"
#include "libslam/lidar/lidar.h"
#include "libslam/resources/ini_yaml.h"

namespace slam::robot {
namespace {

const std::string kFolder = RASTERSLAM_SOURCE_DIR "/configs/lidars/";

lidar::LidarOptions load(const std::string& name) {
  const auto ini = resources::readConfigFile(kFolder + name + ".ini");
  files::rejectUnknownSections(ini, {"lidar"});
  lidar::LidarOptions options;
  files::readParameters(ini, lidar::LidarOptions::table(), options);
  return options;
}

TEST(LidarPresets, AllLoadStrictlyAndGiveEveryParameter) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    ASSERT_EQ(entry.path().extension(), ".ini") << entry.path();
    names.push_back(entry.path().stem());
    EXPECT_NO_THROW(load(names.back())) << entry.path();
    // A preset that leaves a parameter to the built-in default would change with it.
    const auto ini = resources::readConfigFile(entry.path());
    for (const auto& row : lidar::LidarOptions::table().rows())
      EXPECT_TRUE(ini.find("lidar", row.info.key)) << entry.path() << " lacks " << row.info.key;
  }
  EXPECT_THAT(names, testing::UnorderedElementsAre("thesis_360", "thesis_360_pixels", "lms291", "lms511",
                                                   "tim571", "utm30lx", "urg04lx", "rplidar_a1", "rplidar_a2",
                                                   "lds01", "lds02"));
}

TEST(LidarPresets, HaveTheBeamStepOfTheDataSheet) {
  // The presets give field of view and count; the step follows. URG-04LX: 360/1024 deg within 0.1 %.
  EXPECT_NEAR(core::radToDeg(lidar::beamStep(load("thesis_360"))), 1.0, 1e-12);
  EXPECT_NEAR(core::radToDeg(lidar::beamStep(load("lms291"))), 0.5, 1e-12);
  EXPECT_NEAR(core::radToDeg(lidar::beamStep(load("lms511"))), 0.5, 1e-12);
  EXPECT_NEAR(core::radToDeg(lidar::beamStep(load("tim571"))), 1.0 / 3, 1e-12);
  EXPECT_NEAR(core::radToDeg(lidar::beamStep(load("utm30lx"))), 0.25, 1e-12);
  EXPECT_NEAR(core::radToDeg(lidar::beamStep(load("urg04lx"))), 360.0 / 1024, 0.001 * 360.0 / 1024);
  EXPECT_NEAR(core::radToDeg(lidar::beamStep(load("rplidar_a1"))), 1.0, 1e-12);
  EXPECT_NEAR(core::radToDeg(lidar::beamStep(load("rplidar_a2"))), 0.45, 1e-12);
}

TEST(LidarPresets, HaveTheNoiseOfTheDataSheet) {
  const auto sigmaAt = [](const std::string& name, double range_m) {
    return lidar::rangeSigma(load(name), range_m);
  };
  EXPECT_EQ(sigmaAt("lms291", 20), 0.01);
  EXPECT_EQ(sigmaAt("lms511", 10), 0.006);
  EXPECT_NEAR(sigmaAt("lms511", 30), 0.014, 0.0002);
  EXPECT_EQ(sigmaAt("tim571", 8), 0.02);
  EXPECT_DOUBLE_EQ(sigmaAt("utm30lx", 10), 0.01);
  EXPECT_DOUBLE_EQ(sigmaAt("utm30lx", 30), 0.03);
  EXPECT_EQ(sigmaAt("urg04lx", 0.5), 0.01);
  EXPECT_DOUBLE_EQ(sigmaAt("urg04lx", 4), 0.04);
  EXPECT_DOUBLE_EQ(sigmaAt("rplidar_a1", 6), 0.06);
  EXPECT_EQ(sigmaAt("lds01", 0.2), 0.005);
  EXPECT_DOUBLE_EQ(sigmaAt("lds01", 2), 0.035);
  EXPECT_DOUBLE_EQ(sigmaAt("lds02", 4), 0.06);
  EXPECT_DOUBLE_EQ(sigmaAt("rplidar_a2", 6), 0.06);
}

TEST(LidarPresets, HaveTheOriginalsLidarToTheLetter) {
  for (const std::string name : {"thesis_360", "thesis_360_pixels"}) {
    const auto lidar = load(name);
    EXPECT_EQ(lidar.beams, 360) << name;
    EXPECT_NEAR(core::radToDeg(lidar.fov_rad), 360, 1e-9) << name;
    EXPECT_EQ(lidar.max_range_m, 0) << name << ": no limit";
    EXPECT_EQ(lidar.min_range_m, 0) << name;
    EXPECT_EQ(lidar.sigma_m + lidar.sigma_share + lidar.drop_out, 0) << name;
    EXPECT_EQ(lidar.ray, name == "thesis_360" ? "exact" : "original");
  }
}

}  // namespace
}  // namespace slam::robot

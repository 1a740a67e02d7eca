#include "libslam/mapping/method_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/mapping/map_builder.h"

namespace slam::mapping {
namespace {

const std::string kMethods = std::string(RASTERSLAM_SOURCE_DIR) + "/configs/methods";

std::string inputError(const std::string& text) {
  try {
    readMethodConfig(files::IniFile::parse(text, "m.ini"));
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "(no error)";
}

TEST(MethodConfig, EveryShippedMethodIsMade) {
  const auto names = methodNames(kMethods);
  EXPECT_THAT(names,
              ::testing::ElementsAre("graph", "icp", "icp_exact", "naive", "naive_blind", "naive_correlation",
                                     "naive_flow", "naive_wheel", "particles", "rbpf", "rbpf_exact"));
  for (const auto& name : names) {
    const auto method = makeMapBuilder(loadMethodConfig(kMethods, name), name, 1);
    EXPECT_TRUE(method.method) << name;
    EXPECT_EQ(method.name, name);
    EXPECT_EQ(method.type, name.substr(0, name.find('_')));
    EXPECT_FALSE(method.parameters.empty());
  }
}

TEST(MethodConfig, TheExactFilterDiffersFromTheStockOneInItsGridAlone) {
  auto exact = loadMethodConfig(kMethods, "rbpf_exact");
  exact.set("mapping", "grid", "stock", "test");
  EXPECT_EQ(toMrptConfig(exact, "rbpf"), toMrptConfig(loadMethodConfig(kMethods, "rbpf"), "rbpf"));
}

TEST(MethodConfig, TheCommittedMrptFilesAreWhatTheMethodsGenerate) {
  const std::map<std::string, std::string> files = {
      {"icp-slam.ini", "icp"}, {"rbpf-slam.ini", "rbpf"}, {"rbpf-slam_exact.ini", "rbpf_exact"}};
  const std::string fresh_folder = std::string(RASTERSLAM_BINARY_DIR) + "/configs-mrpt";
  for (const auto& [file, name] : files) {
    const std::string generated = toMrptConfig(loadMethodConfig(kMethods, name), name);
    const std::string committed = std::string(RASTERSLAM_SOURCE_DIR) + "/configs/mrpt/" + file;
    if (std::filesystem::exists(committed) && files::readTextFile(committed) == generated) continue;
    std::filesystem::create_directories(fresh_folder);
    files::writeFileAtomically(fresh_folder + "/" + file, generated);
    ADD_FAILURE() << committed << " is out of date: cp " << fresh_folder << "/" << file << " " << committed;
  }
}

TEST(MethodConfig, AMistakeIsOneLineThatSaysWhere) {
  EXPECT_EQ(inputError("[method]\ntype = icq\n"),
            "m.ini:2: section [method], key 'type': found 'icq', expected one of naive, icp, rbpf, "
            "particles, graph; did you mean 'icp'?");
  EXPECT_EQ(inputError("[method]\ntype = icp\n[mapping]\nresolution = 0.1\n"),
            "m.ini:4: section [mapping], unknown key 'resolution'; did you mean 'resolution_m'?");
  EXPECT_EQ(
      inputError("[mapping]\nresolution_m = -0.05\n"),
      "m.ini:2: section [mapping], key 'resolution_m': found '-0.05', expected a number from 0.005 to 1");
  EXPECT_EQ(inputError("[method]\ntype = icp\n[icpp]\nshrink = 0.5\n"),
            "m.ini:4: unknown section [icpp]; did you mean 'icp'?");
}

TEST(MethodConfig, KeysThatTheTypeDoesNotUseAreMistakes) {
  EXPECT_EQ(inputError("[method]\ntype = naive\n[particles]\ncount = 5\n"),
            "m.ini:4: unknown section [particles]");
  EXPECT_THAT(inputError("[method]\ntype = naive\n[mapping]\nlocalize_distance_m = 1\n"),
              ::testing::HasSubstr("unknown key 'localize_distance_m'"));
  EXPECT_THAT(inputError("[method]\ntype = icp\n[mapping]\ndraw = dots\n"),
              ::testing::HasSubstr("unknown key 'draw'"));
  EXPECT_THAT(inputError("[method]\ntype = rbpf\n[icp]\npoint_spacing_m = 0.1\n"),
              ::testing::HasSubstr("unknown key 'point_spacing_m'"));
  EXPECT_THAT(inputError("[method]\ntype = particles\n[mapping]\ngrid = exact\n"),
              ::testing::HasSubstr("unknown key 'grid'"));
  EXPECT_THAT(inputError("[method]\ntype = particles\n[particles]\nlikelihood_cache = true\n"),
              ::testing::HasSubstr("unknown key 'likelihood_cache'"));
  EXPECT_EQ(inputError("[method]\ntype = particles\n[icp]\nshrink = 0.5\n"),
            "m.ini:4: unknown section [icp]");
}

TEST(MethodConfig, ContradictionsAreMistakes) {
  EXPECT_EQ(inputError("[method]\ntype = rbpf\n[icp]\nalgorithm = levenberg_marquardt\n"),
            "m.ini:4: section [icp], key 'algorithm': found 'levenberg_marquardt', expected classic for type "
            "rbpf, which matches to grids");
  EXPECT_EQ(inputError("[method]\nodometry = argmax\n[scan_odometry]\nmethod = correlation\n"),
            "m.ini:4: section [scan_odometry], key 'method': found 'correlation', expected 'argmax' as in "
            "[method] odometry");
  EXPECT_EQ(inputError("[method]\ntype = particles\n[particles]\nmost_count = 5\n"),
            "m.ini:4: section [particles], key 'most_count': found '5', expected at least least_count, 10");
  EXPECT_EQ(
      inputError("[method]\ntype = particles\n[particles]\nleast_count = 200\n"),
      "m.ini:4: section [particles], key 'most_count': found '100', expected at least least_count, 200");
}

TEST(MethodConfig, NoMrptProgramRunsOurOwnMethods) {
  for (const std::string name : {"naive", "particles"}) {
    try {
      toMrptConfig(loadMethodConfig(kMethods, name), name);
      FAIL();
    } catch (const core::InputError& error) {
      EXPECT_THAT(error.what(),
                  ::testing::HasSubstr("key 'type': found '" + name + "', expected icp or rbpf"));
    }
  }
}

TEST(MethodConfig, AnUnknownMethodNamesTheNearestOne) {
  try {
    loadMethodConfig(kMethods, "rbpf_exakt");
    FAIL();
  } catch (const core::InputError& error) {
    EXPECT_STREQ(error.what(), "unknown method 'rbpf_exakt'; did you mean 'rbpf_exact'?");
  }
  EXPECT_THROW(loadMethodConfig(kMethods, "./nowhere.ini"), core::InputError);
  EXPECT_THROW(methodNames("/nowhere"), core::InputError);
}

TEST(MethodConfig, AnglesReachMrptInDegrees) {
  auto ini = loadMethodConfig(kMethods, "icp");
  ini.set("mapping", "localize_angle_deg", "7.3", "test");
  EXPECT_THAT(toMrptConfig(ini, "icp"), ::testing::HasSubstr("localizationAngDistance = 7.3\n"));
}

}  // namespace
}  // namespace slam::mapping

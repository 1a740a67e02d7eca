// What every registered method has to do, whichever it is: a new line in methodTypes() is tested by these
// without another one here.
#include "libslam/mapping/method_types.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <filesystem>
#include <ostream>
#include <set>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/testing/temp_folder.h"
#include "tests/mapping/small_room.h"

namespace slam::mapping {

// NOLINTNEXTLINE(readability-identifier-naming): as GoogleTest calls it
void PrintTo(const methods::MethodType& type, std::ostream* out) {
  *out << type.name;
}

namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kSteps = 8;

files::IniFile configOf(const std::string& type, const std::string& more = "") {
  return files::IniFile::parse("[method]\ntype = " + type + "\n" + more, "m.ini");
}

std::string errorOf(const std::string& type, const std::string& more) {
  try {
    readMethodConfig(configOf(type, more));
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "(no error)";
}

class EveryType : public ::testing::TestWithParam<methods::MethodType> {
 protected:
  MapBuilder make(std::uint64_t seed = 3) const {
    return makeMapBuilder(configOf(GetParam().name), "m", seed);
  }
  core::Trajectory run(MapBuilder& method, int first = 0) const {
    const auto drive = test::driveThroughRoom(first + kSteps);
    core::Trajectory path;
    for (size_t i = static_cast<size_t>(first); i < drive.entries.size(); ++i)
      path.push_back({drive.entries[i].scan.time_s,
                      processScan(method, drive.entries[i].scan, drive.entries[i].T_previous_robot, true)});
    return path;
  }
  std::string bytes(const core::Trajectory& path) const {
    return {reinterpret_cast<const char*>(path.data()), path.size() * sizeof(path[0])};
  }
};

TEST_P(EveryType, IsMadeByItsName) {
  EXPECT_TRUE(GetParam().continues_maps || !GetParam().finds_itself);
  auto method = make();
  EXPECT_EQ(method.type, GetParam().name);
}

TEST_P(EveryType, GivesAFinitePoseForEveryScanAndOneInTheEnd) {
  auto method = make();
  const auto online = run(method);
  ASSERT_EQ(online.size(), static_cast<size_t>(kSteps));
  for (const auto& stamped : online) EXPECT_TRUE(core::isFinite(stamped.pose));
  // It moved about as far as it was driven: 0.06 m a step.
  EXPECT_NEAR(core::distance(online.front().pose, online.back().pose), 0.06 * (kSteps - 1), 0.15);
  finishMap(method);
  const auto path = finalPath(method, online);
  if (!path) return;
  ASSERT_EQ(path->size(), online.size());
  for (size_t i = 0; i < online.size(); ++i) {
    EXPECT_TRUE(core::isFinite((*path)[i].pose));
    EXPECT_EQ((*path)[i].time_s, online[i].time_s);
  }
  const auto covariances = finalCovariances(method);
  EXPECT_TRUE(covariances.empty() || covariances.size() == online.size());
  EXPECT_THROW(finalPath(method, {}), core::ContractError);
}

TEST_P(EveryType, IsOfItsPoseAsUncertainAsACovarianceMaySay) {
  auto method = make();
  run(method);
  const auto covariance = poseCovariance(method);
  if (!covariance) return;
  EXPECT_TRUE(covariance->allFinite());
  EXPECT_TRUE(covariance->isApprox(covariance->transpose()));
  // Rounding may leave an eigenvalue below zero by 1e-9 m^2, (30 um)^2.
  EXPECT_GE(covariance->selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), -1e-9);
}

TEST_P(EveryType, DoesTheSameTwice) {
  const testing::TempFolder first_folder, second_folder;
  auto first = make(), second = make();
  EXPECT_EQ(bytes(run(first)), bytes(run(second)));
  finishMap(first), finishMap(second);
  saveMaps(first, first_folder.path()), saveMaps(second, second_folder.path());
  std::set<std::string> files;
  for (const auto& file : std::filesystem::directory_iterator(first_folder.path())) {
    const std::string name = file.path().filename().string();
    files.insert(name);
    EXPECT_EQ(files::readTextFile(first_folder / name), files::readTextFile(second_folder / name)) << name;
  }
  for (const char* name : {"map.yaml", "map.png", "map.gridmap.gz", "map.simplemap"})
    EXPECT_TRUE(files.count(name)) << name;
}

TEST_P(EveryType, SeesTheRoom) {
  auto method = make();
  run(method);
  const auto map = currentMap(method);
  EXPECT_EQ(map.resolution_m, 0.05);
  int occupied = 0;
  for (const float cell : map.occupancy) occupied += cell > gridmap::kOccupiedAbove;
  // Its walls are 28 m and some more, of which it sees a half: 280 cells of 5 cm.
  EXPECT_GT(occupied, 140);
  EXPECT_LT(occupied, 2000);
}

TEST_P(EveryType, GoesOnInItsOwnMapOrSaysThatItCannot) {
  const testing::TempFolder folder;
  auto first = make();
  const auto before = run(first);
  finishMap(first);
  saveMaps(first, folder.path());
  for (const bool keep_map : {false, true}) {
    auto second = make();
    if (!GetParam().continues_maps) {
      EXPECT_THROW(continueMap(second, folder / "map.simplemap", before.back().pose, keep_map),
                   core::InputError);
      continue;
    }
    const auto drive = test::driveThroughRoom(kSteps);
    // The drive is taken up where it ended.
    continueMap(second, folder / "map.simplemap", before.back().pose, keep_map);
    const auto pose = processScan(second, drive.entries.back().scan, {}, true);
    EXPECT_LT(core::distance(core::position(pose), core::position(before.back().pose)), 0.1);
    EXPECT_LT(std::abs(core::angleDifference(pose.phi, before.back().pose.phi)), 0.05);
  }
  auto lost = make();
  if (!GetParam().finds_itself) {
    EXPECT_THROW(continueMap(lost, folder / "map.simplemap", std::nullopt, true), core::InputError);
  }
  EXPECT_THROW(continueMap(lost, folder / "map.simplemap", std::nullopt, false), core::InputError);
  EXPECT_THROW(continueMap(lost, folder / "map.yaml", before.back().pose, false), core::InputError);
}

TEST_P(EveryType, RefusesAWrongKeyInOneLineThatNamesIt) {
  const auto& name = GetParam().name;
  for (const std::string& section : methodSections(name)) {
    if (section == "method") continue;
    const auto error = errorOf(name, "[" + section + "]\nno_such_key = 1\n");
    EXPECT_THAT(error, HasSubstr("m.ini:4: section [" + section + "]")) << name;
    EXPECT_THAT(error, HasSubstr("no_such_key"));
    EXPECT_THAT(error, Not(HasSubstr("\n")));
  }
  EXPECT_THAT(errorOf(name, "[no_such_section]\na = 1\n"), HasSubstr("no_such_section"));
  EXPECT_THAT(errorOf(name, "[mapping]\nresolution_m = thick\n"), HasSubstr("thick"));
}

TEST_P(EveryType, ReportsAllKeysOfItsSectionsOnce) {
  const auto config = readMethodConfig(configOf(GetParam().name));
  std::set<std::string> sections, keys;
  for (const auto& row : config.report) {
    sections.insert(row.section);
    EXPECT_TRUE(keys.insert(row.section + "." + row.info.key).second) << row.section << "." << row.info.key;
    EXPECT_FALSE(row.info.doc.empty()) << row.info.key;
  }
  const auto known = methodSections(GetParam().name);
  EXPECT_EQ(sections, std::set<std::string>(known.begin(), known.end()));
}

TEST_P(EveryType, DoesWithoutAMotionOnlyWhereItSaysSo) {
  const auto error = errorOf(GetParam().name, "odometry = none\n");
  EXPECT_EQ(error == "(no error)", GetParam().goes_on_alone) << error;
}

TEST_P(EveryType, IsWrittenForMrptsProgramOrSaysThatNoneRunsIt) {
  const auto config = configOf(GetParam().name);
  if (!GetParam().mrpt_config) {
    EXPECT_THROW(toMrptConfig(config, "m"), core::InputError);
    return;
  }
  EXPECT_THAT(toMrptConfig(config, "m"), HasSubstr("[MappingApplication]"));
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryType, ::testing::ValuesIn(methodTypes()),
                         [](const auto& type) { return type.param.name; });

TEST(MethodTypes, HaveDifferentNames) {
  std::set<std::string> names;
  for (const auto& type : methodTypes()) EXPECT_TRUE(names.insert(type.name).second) << type.name;
  EXPECT_THROW(methodType("icq"), core::ContractError);
}

TEST(MethodTypes, AreListedInASentence) {
  EXPECT_EQ(methodTypesWhich([](const methods::MethodType&) { return false; }), "");
  EXPECT_EQ(methodTypesWhich([](const methods::MethodType& type) { return type.name == "icp"; }), "icp");
  EXPECT_EQ(methodTypesWhich(
                [](const methods::MethodType& type) { return type.name != "naive" && type.name != "graph"; }),
            "icp, rbpf or particles");
}

}  // namespace
}  // namespace slam::mapping

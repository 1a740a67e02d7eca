#include "libslam/results/relative_covariances.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::results {
namespace {

using Kind = RelativeCovariance::Kind;
using slam::testing::errorOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

/// A pose per second and half a metre.
core::Trajectory straight(int poses) {
  core::Trajectory path;
  for (int i = 0; i < poses; ++i) path.push_back({static_cast<double>(i), {0.5 * i, 0, 0}});
  return path;
}

TEST(RelativeCovariances, PairsAreAMetreApart) {
  EXPECT_THAT(pairsApart(straight(6), 1), ElementsAre(Pair(0, 2), Pair(2, 4)));
  EXPECT_THAT(pairsApart(straight(6), 10), IsEmpty());
  EXPECT_THAT(pairsApart({}, 1), IsEmpty());
  // Who stands begins no metre.
  auto path = straight(3);
  path.insert(path.begin(), 5, path.front());
  EXPECT_THAT(pairsApart(path, 1), ElementsAre(Pair(0, 7)));
  EXPECT_EQ(pairsApart(straight(5000), 1).size(), kMostPairs);
}

TEST(RelativeCovariances, LoopsThatWereAcceptedHaveEnds) {
  const auto entry = [](core::JournalEvent event, int scan, int other) {
    core::JournalEntry one{};
    one.event = event, one.scan = scan, one.other_scan = other;
    return one;
  };
  EXPECT_THAT(
      loopEnds({entry(core::JournalEvent::kAccepted, 90, 10), entry(core::JournalEvent::kFound, 91, 11),
                entry(core::JournalEvent::kAccepted, 95, -1), entry(core::JournalEvent::kAccepted, 120, 10)},
               100),
      ElementsAre(Pair(10, 90)));
}

Eigen::Matrix3d full() {
  Eigen::Matrix3d c;
  c << 4e-4, 1e-4, -3e-5, 1e-4, 9e-4, 2e-5, -3e-5, 2e-5, 1e-5;
  return c;
}

TEST(RelativeCovariances, ReadWhatTheyWrite) {
  const testing::TempFolder folder;
  writeRelativeCovariances({{Kind::kMetre, 1.5e9 + 0.25, 1.5e9 + 2, full()},
                            {Kind::kLoop, 3, 4, 2 * full()},
                            {Kind::kRelation, 4, 3, full()}},
                           folder / "r.csv");
  const auto read = readRelativeCovariances(folder / "r.csv");
  ASSERT_EQ(read.size(), 3U);
  EXPECT_EQ(read[2].kind, Kind::kRelation);
  EXPECT_EQ(read[0].kind, Kind::kMetre);
  EXPECT_EQ(read[0].first_s, 1.5e9 + 0.25);
  EXPECT_LT((read[0].covariance - full()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(read[1].kind, Kind::kLoop);
  EXPECT_EQ(read[1].second_s, 4);
  std::ofstream(folder / "b.csv") << "kind,first_s,second_s,xx,xy,xphi,yy,yphi,phiphi\n2m,0,1,1,0,0,1,0,1\n";
  EXPECT_THAT(
      errorOf([&] { readRelativeCovariances(folder / "b.csv"); }),
      HasSubstr("b.csv:2: found '2m,0,1,1,0,0,1,0,1', expected 1m, 10m, loop or relation and 8 numbers"));
  std::ofstream(folder / "c.csv") << "1m,0,1,1,0,0,1,0,6.728546";
  EXPECT_THAT(errorOf([&] { readRelativeCovariances(folder / "c.csv"); }),
              HasSubstr("c.csv: ends amid a line"));
  std::ofstream(folder / "n.csv") << "1m,0,1,1,0,0,one,0,1\n";
  EXPECT_THAT(errorOf([&] { readRelativeCovariances(folder / "n.csv"); }), HasSubstr("n.csv:1: found 'one'"));
}

TEST(RelativeCovariances, AreHeldAgainstTheTrueMotionWhateverTheFrames) {
  const core::Trajectory truth = straight(4);
  core::Trajectory estimate = truth;
  // All of it elsewhere and turned; and the last pose 0.2 m farther on, as the one before sees it.
  for (auto& stamped : estimate) stamped.pose = core::Pose2{7, -3, 2} * stamped.pose;
  estimate.back().pose = estimate.back().pose * core::Pose2{0.2, 0, 0};
  const Eigen::Matrix3d sigmas = Eigen::Vector3d(0.01, 0.25, 0.25).asDiagonal();  // 0.1 m, 0.5 m, 0.5 rad
  const std::vector<RelativeCovariance> told = {{Kind::kMetre, 0, 2, sigmas},
                                                {Kind::kMetre, 1, 3, sigmas},
                                                {Kind::kLoop, 1, 3, Eigen::Matrix3d::Zero()},
                                                {Kind::kMetre, 1, 99, sigmas}};
  const auto nees = relativeNees(truth, estimate, told, Kind::kMetre);
  ASSERT_EQ(nees.size(), 2U);
  EXPECT_NEAR(nees[0], 0, 1e-12);
  EXPECT_NEAR(nees[1], 4, 1e-9);
  EXPECT_THAT(relativeNees(truth, estimate, told, Kind::kLoop), ElementsAre(HUGE_VAL));
  EXPECT_THAT(relativeNees(truth, estimate, told, Kind::kTenMetres), IsEmpty());
}

TEST(RelativeCovariances, AreAskedOfRelationsByTheirStamps) {
  const auto path = straight(4);
  const core::Relations relations = {{3, 1, {}}, {0, 2.0000004, {}}, {0, 2.5, {}}, {-1, 2, {}}, {1, 9, {}}};
  EXPECT_THAT(pairsOf(relations, path), ElementsAre(Pair(3, 1), Pair(0, 2)));
  core::Trajectory twice = path;
  twice.insert(twice.begin() + 1, {0, {5, 5, 5}});  // of equal stamps the first
  EXPECT_THAT(pairsOf({{0, 1, {}}}, twice), ElementsAre(Pair(0, 2)));
}

TEST(RelativeCovariances, AreHeldAgainstWhatRelationsSay) {
  core::Trajectory estimate = straight(4);
  for (auto& stamped : estimate) stamped.pose = core::Pose2{7, -3, 2} * stamped.pose;
  const Eigen::Matrix3d sigmas = Eigen::Vector3d(0.01, 0.25, 0.25).asDiagonal();  // 0.1 m, 0.5 m, 0.5 rad
  const std::vector<RelativeCovariance> told = {{Kind::kRelation, 0, 2, sigmas},
                                                {Kind::kRelation, 3, 1, sigmas},
                                                {Kind::kMetre, 1, 3, sigmas},
                                                {Kind::kRelation, 1, 2, Eigen::Matrix3d::Zero()}};
  const core::Pose2 T_0_2 = core::between(estimate[0].pose, estimate[2].pose),
                    T_3_1 = core::between(estimate[3].pose, estimate[1].pose);
  const auto nees = relationNees({{0, 2, T_0_2 * core::Pose2{0.2, 0, 0}},
                                  {3, 1, {T_3_1.x, T_3_1.y - 0.5, T_3_1.phi}},
                                  {1, 3, {}},
                                  {1, 2, {}}},
                                 estimate, told);
  ASSERT_EQ(nees.size(), 3U);  // of the third no covariance is of a relation
  EXPECT_NEAR(nees[0], 4, 1e-9);
  EXPECT_NEAR(nees[1], 1, 1e-9);
  EXPECT_EQ(nees[2], HUGE_VAL);
}

}  // namespace
}  // namespace slam::results

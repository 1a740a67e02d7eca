#include "libslam/scanmatch/information.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/pose2.h"

namespace slam::scanmatch {
namespace {

TEST(Information, OfAPoseIsOneOverTheSquaresOfItsStandardDeviations) {
  const Eigen::Matrix3d information = poseInformation(0.5, 0.1);
  EXPECT_TRUE(information.isApprox(Eigen::Matrix3d(Eigen::Vector3d(4, 4, 100).asDiagonal()), 1e-12));
}

// A wall ahead along the map's x holds x; of a robot that looks along y that is what lies to its right.
TEST(Information, OfAnEdgeStandsInTheBodysAxes) {
  const Eigen::Matrix3d wall = Eigen::Vector3d(900, 1, 50).asDiagonal();
  const Eigen::Matrix3d ahead = edgeInformation(wall, core::kPi / 2);
  EXPECT_NEAR(ahead(0, 0), 1, 1e-5);
  EXPECT_NEAR(ahead(1, 1), 900, 1e-5);
  EXPECT_NEAR(ahead(2, 2), 50, 1e-5);
  // Turned by less than that: an error along the map's y, as the body has it, costs what it does in the map.
  for (const double phi : {0.4, -1.1, 2.5}) {
    const Eigen::Matrix3d body = edgeInformation(wall, phi);
    const Eigen::Vector3d along_y(std::sin(phi), std::cos(phi), 0), along_x(std::cos(phi), -std::sin(phi), 0);
    EXPECT_NEAR(along_y.dot(body * along_y), 1, 1e-5) << phi;
    EXPECT_NEAR(along_x.dot(body * along_x), 900, 1e-5) << phi;
  }
}

TEST(Information, OfARotatedPositionKeepsItsTieToTheHeading) {
  Eigen::Matrix3d information;
  information << 9, 1, 2, 1, 4, -3, 2, -3, 20;
  const double phi = 0.7, c = std::cos(phi), s = std::sin(phi);
  Eigen::Matrix3d R;
  R << c, -s, 0, s, c, 0, 0, 0, 1;
  const Eigen::Matrix3d body = edgeInformation(information, phi);
  const Eigen::Vector3d error(0.3, -0.2, 0.1);
  EXPECT_NEAR(error.dot(body * error), (R * error).dot(information * (R * error)), 1e-9);
}

TEST(Information, WithoutNegativesChangesNothingElse) {
  Eigen::Matrix3d sure;
  sure << 9, 1, 2, 1, 4, -3, 2, -3, 20;
  EXPECT_TRUE(withoutNegatives(sure, 1e-9, 0).isApprox(sure, 1e-12));
  const Eigen::Matrix3d raised = withoutNegatives(Eigen::Vector3d(100, -5, 0).asDiagonal(), 0.01, 0.5);
  EXPECT_TRUE(raised.isApprox(Eigen::Matrix3d(Eigen::Vector3d(100, 1, 1).asDiagonal()), 1e-12)) << raised;
}

TEST(ToldShares, AreOfTheWayAndOfTheHeading) {
  const Eigen::Matrix3d scan = Eigen::Vector3d(3, 1, 0.5).asDiagonal(),
                        both = scan + Eigen::Matrix3d::Identity();
  const auto along_x = toldShares(scan, both, {0.7, 0, 0.1}, 0),
             along_y = toldShares(scan, both, {0.7, 0, 0.1}, core::kPi / 2),
             standing = toldShares(scan, both, {0, 0, 0.1}, 0);
  EXPECT_NEAR(along_x.way, 3.0 / 4, 1e-12);
  EXPECT_NEAR(along_y.way, 1.0 / 2, 1e-12);
  EXPECT_EQ(standing.way, 1);
  for (const auto& told : {along_x, along_y, standing}) EXPECT_NEAR(told.turn, 1.0 / 3, 1e-12);
}

}  // namespace
}  // namespace slam::scanmatch

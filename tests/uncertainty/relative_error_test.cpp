#include "libslam/uncertainty/relative_error.h"

#include <gtest/gtest.h>

#include "libslam/uncertainty/error_flow.h"
#include "tests/keyframes/drawn_map.h"

namespace slam::uncertainty {
namespace {

using Eigen::Matrix3d;
using keyframes::test_maps::diagonal;

/// Three keyframes a metre apart; odometry of 10 cm and 10 mrad, and matches that err by a centimetre.
keyframes::KeyframeMap row() {
  keyframes::KeyframeMap map{keyframes::GraphOptions{}};
  keyframes::test_maps::addRow(map, 3);
  for (auto& keyframe : map.keyframes()) keyframe.noise = diagonal(1e-4, 1e-4, 1e-6);
  for (int k = 1; k < 3; ++k)
    map.keyframes()[static_cast<size_t>(k)].inherited.own = diagonal(0.01, 0.01, 1e-4);
  return map;
}

TEST(RelativeError, OfScansOnOneKeyframeIsThatOfTheirOwnMatches) {
  const auto map = row();
  const HungScan a{1, {0, 0, 0}, Matrix3d::Zero()}, b{1, {0.2, 0, 0}, diagonal(1e-4, 0, 0)};
  const Matrix3d covariance = RelativeError(map, Poses::kTracked).covariance(a, b);
  EXPECT_NEAR(covariance(0, 0), 3e-4, 1e-12) << "both matches, and what was driven since";
  EXPECT_NEAR(covariance(1, 1), 2e-4 + 0.2 * 0.2 * 1e-6, 1e-12) << "the first one's turn shows at the second";
  EXPECT_NEAR(covariance(2, 2), 2e-6, 1e-12);
}

TEST(RelativeError, OfScansOnTwoKeyframesIsTheKeyframesAndWhatWasDrivenSince) {
  const auto map = row();
  const HungScan a{0, {0, 0, 0}, Matrix3d::Zero()}, b{2, {0, 0, 0}, diagonal(1e-3, 0, 0)};
  const Matrix3d covariance = RelativeError(map, Poses::kTracked).covariance(a, b),
                 keyframes = ErrorFlow(map, Poses::kTracked).relative(0, 2);
  EXPECT_NEAR(covariance(0, 0), keyframes(0, 0) + 1e-3, 1e-12);
  EXPECT_NEAR(covariance(1, 1), keyframes(1, 1), 1e-12);
  EXPECT_NEAR(keyframes(1, 1), 2 * 0.01 + 1e-4, 1e-12) << "two steps, and the first one's turn a metre on";
}

}  // namespace
}  // namespace slam::uncertainty

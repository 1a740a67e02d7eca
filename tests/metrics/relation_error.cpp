#include "libslam/metrics/relation_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/core/random.h"

namespace slam::metrics {
namespace {

using core::kPi;

core::Trajectory straight() {
  return {{10, {0, 0, 0}}, {11, {1, 0, 0}}, {12, {2, 0, 0}}, {13, {2, 0, kPi / 2}}, {14, {2, 1, kPi / 2}}};
}

TEST(RelationError, IsTheLengthAndTheAngleOfWhatIsLeftOfTheRelation) {
  // Annotated: a metre ahead; driven: a metre ahead, twice as far as said, and a turn that was said to be a
  // bit less.
  const core::Relations relations = {{10, 11, {1, 0, 0}},
                                     {10, 12, {1.9, 0, 0}},
                                     {12, 13, {0, 0, kPi / 2 - 0.1}},
                                     {14, 12, {-1, 0, -kPi / 2}}};
  const auto error = relationError(relations, straight());
  EXPECT_EQ(error.scored, 4U);
  EXPECT_EQ(error.interpolated, 0U);
  EXPECT_EQ(error.unmatched, 0U);
  EXPECT_NEAR(error.translation_m.mean, 0.1 / 4, 1e-12);
  EXPECT_NEAR(error.translation_m.max, 0.1, 1e-12);
  EXPECT_NEAR(error.translation_m.median, 0, 1e-12);
  // Sample deviation of 0, 0, 0, 0.1, by hand: sqrt((3 * 0.025^2 + 0.075^2) / 3).
  EXPECT_NEAR(error.translation_m.deviation, 0.05, 1e-12);
  EXPECT_NEAR(error.translation_m.mean_square, 0.01 / 4, 1e-12);
  EXPECT_NEAR(error.translation_m.square_deviation, 0.005, 1e-12);
  EXPECT_NEAR(error.rotation_rad.mean, 0.1 / 4, 1e-12);
  ASSERT_FALSE(error.worst.empty());
  EXPECT_EQ(error.worst[0].index, 1U);
}

TEST(RelationError, DoesNotCareWhereTheMapLies) {
  const core::Relations relations = {{10, 12, {1.9, 0.1, 0.02}}, {11, 14, {1, 1, kPi / 2}}};
  core::Trajectory moved = straight();
  for (auto& [time_s, pose] : moved) pose = core::Pose2{5, -7, 2.3} * pose;
  const auto a = relationError(relations, straight()), b = relationError(relations, moved);
  EXPECT_NEAR(a.translation_m.mean, b.translation_m.mean, 1e-12);
  EXPECT_NEAR(a.rotation_rad.mean, b.rotation_rad.mean, 1e-12);
}

TEST(RelationError, CountsWhatItInterpolatesAndWhatItCannotScore) {
  const core::Relations relations = {{10.5, 11, {0.5, 0, 0}}, {9, 11, {1, 0, 0}}, {10, 14.1, {2, 1, 0}}};
  const auto error = relationError(relations, straight());
  EXPECT_EQ(error.scored, 1U);
  EXPECT_EQ(error.interpolated, 1U);
  EXPECT_EQ(error.unmatched, 2U);
  EXPECT_NEAR(error.translation_m.mean, 0, 1e-12);
  const auto nothing = relationError(relations, {});
  EXPECT_EQ(nothing.unmatched, 3U);
  EXPECT_TRUE(std::isnan(nothing.translation_m.mean));
  EXPECT_TRUE(nothing.worst.empty());
}

TEST(RelationError, TakesTheSameStampToAMicrosecondAndElseTheStraightLineBetween) {
  const core::Trajectory path = {{10, {0, 0, 3}}, {11, {1, 0, -3}}, {11, {7, 7, 0}}, {12, {1, 2, -3}}};
  const auto errorOf = [&](double from_s, double to_s, const core::Pose2& T) {
    return relationError({{from_s, to_s, T}}, path);
  };
  // Of two poses with one stamp the first.
  const auto same = core::between(path[0].pose, path[1].pose);
  EXPECT_EQ(errorOf(10, 11, same).interpolated, 0U);
  EXPECT_NEAR(errorOf(10, 11, same).translation_m.max, 0, 1e-12);
  EXPECT_EQ(errorOf(10, 11 - 0.9e-6, same).interpolated, 0U);
  EXPECT_NEAR(errorOf(10, 11 - 0.9e-6, same).translation_m.max, 0, 1e-12);
  // A quarter of the way, and of the turn from 3 over pi to -3 radians.
  const core::Pose2 quarter{0.25, 0, 3 + (2 * kPi - 6) / 4};
  const auto between = errorOf(10, 10.25, core::between(path[0].pose, quarter));
  EXPECT_EQ(between.interpolated, 1U);
  EXPECT_NEAR(between.translation_m.max, 0, 1e-12);
  EXPECT_NEAR(between.rotation_rad.max, 0, 1e-12);
  EXPECT_EQ(errorOf(10, 11 - 1.1e-6, same).interpolated, 1U);
  // The first and the last stamp belong to the path, the moments before and after do not.
  EXPECT_EQ(errorOf(10, 12, same).scored, 1U);
  EXPECT_EQ(errorOf(10, 12 + 1.1e-6, same).unmatched, 1U);
  EXPECT_EQ(errorOf(10 - 1.1e-6, 12, same).unmatched, 1U);
}

TEST(RelationError, SaysOfTheWorstWhatThePathHas) {
  const core::Relations relations = {{10, 11, {1, 0, 0}}, {12, 14, {0.5, 0, kPi / 2}}};
  const auto error = relationError(relations, straight(), 1);
  ASSERT_EQ(error.worst.size(), 1U);
  EXPECT_EQ(error.worst[0].index, 1U);
  EXPECT_NEAR(error.worst[0].T_from_to.x, 0, 1e-12);
  EXPECT_NEAR(error.worst[0].T_from_to.y, 1, 1e-12);
  EXPECT_NEAR(error.worst[0].T_from_to.phi, kPi / 2, 1e-12);
  EXPECT_NEAR(error.worst[0].translation_m, std::hypot(0.5, 1), 1e-12);
}

// The Intel log has 631 scans whose stamp runs back: file order must not matter.
TEST(RelationError, MatchesByStampWhateverTheOrder) {
  const core::Relations relations = {{10, 12, {1.9, 0, 0}}, {13, 14, {1, 0.2, 0}}};
  core::Trajectory shuffled = straight();
  std::swap(shuffled[0], shuffled[3]);
  std::swap(shuffled[1], shuffled[2]);
  EXPECT_EQ(relationError(relations, shuffled).translation_m.mean,
            relationError(relations, straight()).translation_m.mean);
}

TEST(RelationsOf, ATruthHaveNoErrorAgainstItAndCloseItsLoops) {
  core::Trajectory circle;
  for (int i = 0; i <= 200; ++i) {
    const double angle_rad = 4 * kPi * i / 200;  // two rounds
    circle.push_back({100.0 + i, {5 * std::cos(angle_rad), 5 * std::sin(angle_rad), angle_rad + kPi / 2}});
  }
  const auto relations = relationsOf(circle, 1, 0.5, 30);
  const auto steps = std::count_if(relations.begin(), relations.end(),
                                   [](const auto& r) { return r.to_time_s - r.from_time_s < 30; });
  EXPECT_NEAR(static_cast<double>(steps), 50, 2);  // of 63 m, every fourth pose of 0.31 m
  EXPECT_GT(static_cast<long>(relations.size()) - steps, 20);
  const auto error = relationError(relations, circle);
  EXPECT_EQ(error.scored, relations.size());
  EXPECT_LT(error.translation_m.max, 1e-12);
  EXPECT_THROW(relationsOf(circle, 0, 1, 1), core::ContractError);
  EXPECT_TRUE(relationsOf({}, 1, 1, 1).empty());
}

/// Relations between every two of `stamps` poses, each with errors of its own.
core::Relations allBetween(int stamps, double sigma_m, double sigma_rad) {
  core::RandomStream random(7, "annotation");
  core::Relations relations;
  for (int a = 0; a < stamps; ++a)
    for (int b = a + 1; b < stamps; ++b) {
      const core::Pose2 right = core::between({0.1 * a, 0, 0.2 * a}, {0.1 * b, 0, 0.2 * b});
      const core::Pose2 error{random.normal(sigma_m), random.normal(sigma_m), random.normal(sigma_rad)};
      const core::Pose2 says = right * error;
      if ((a + b) % 2 == 0)
        relations.push_back({1.0 * a, 1.0 * b, says});
      else
        relations.push_back({1.0 * b, 1.0 * a, core::inverse(says)});
    }
  return relations;
}

TEST(AnnotationError, IsWhatTheGapsOfTrianglesTellOfOneRelation) {
  const auto error = annotationError(allBetween(40, 0.02, 0.004));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->triangles, 40U * 39 * 38 / 6);
  EXPECT_NEAR(error->sigma_xy_m, 0.02, 0.001);
  EXPECT_NEAR(error->sigma_turn_rad, 0.004, 0.0003);
}

TEST(AnnotationError, OfExactRelationsIsNone) {
  const auto error = annotationError(allBetween(8, 0, 0));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->triangles, 56U);
  EXPECT_NEAR(error->sigma_xy_m, 0, 1e-9);
  EXPECT_NEAR(error->sigma_turn_rad, 0, 1e-9);
}

TEST(AnnotationError, IsNotKnownFromAFewTriangles) {
  EXPECT_FALSE(annotationError({}));
  EXPECT_FALSE(annotationError(allBetween(6, 0.02, 0.004))) << "20 triangles";
  core::Relations chain;
  for (int i = 0; i < 200; ++i) chain.push_back({1.0 * i, 1.0 * i + 1, {1, 0, 0}});
  EXPECT_FALSE(annotationError(chain));
}

TEST(AnnotationError, CountsTheFirstOfTwoRelationsThatSayTheSame) {
  core::Relations relations = allBetween(8, 0, 0);
  relations.push_back({relations[3].to_time_s, relations[3].from_time_s, {5, 5, 5}});
  relations.push_back({2, 2, {3, 3, 3}});
  EXPECT_EQ(annotationError(relations)->triangles, 56U);
  EXPECT_NEAR(annotationError(relations)->sigma_xy_m, 0, 1e-9);
}

}  // namespace
}  // namespace slam::metrics

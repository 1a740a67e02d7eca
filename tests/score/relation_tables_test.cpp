#include "libslam/score/relation_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "libslam/core/random.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/metrics/relation_error.h"
#include "libslam/testing/temp_folder.h"

namespace slam::score {
namespace {
using ::testing::HasSubstr;

results::RunFolder runWith(const core::Trajectory& online) {
  results::RunFolder run;
  run.method = "rbpf";
  run.estimate = online;
  return run;
}

const core::Relations kTwo = {{1, 2, {1, 0, 0}}, {1, 3, {1.9, 0, 0.1}}};
const core::Trajectory kPath = {{1, {0, 0, 0}}, {2, {1, 0, 0}}, {3, {2, 0, 0}}};

TEST(RelationTables, HaveARowForWhatWasGivenOnlineAndOneForTheFinalPath) {
  auto run = runWith(kPath);
  ASSERT_EQ(scoreByRelations(run, kTwo).size(), 1U);
  EXPECT_EQ(scoreByRelations(run, kTwo)[0].path, "rbpf");
  run.final_estimate = core::Trajectory{{1, {0, 0, 0}}, {2, {1, 0, 0}}, {3, {1.9, 0, 0.1}}};
  const auto scores = scoreByRelations(run, kTwo);
  ASSERT_EQ(scores.size(), 2U);
  EXPECT_EQ(scores[0].path, "rbpf final");
  EXPECT_EQ(scores[1].path, "rbpf online");
  EXPECT_NEAR(scores[0].error.translation_m.max, 0, 1e-12);
  EXPECT_NEAR(scores[1].error.translation_m.max, 0.1, 1e-12);
}

TEST(RelationTables, ShowTheFiguresAndTheRuleByWhichPosesWereFound) {
  const auto scores = scoreByRelations(runWith(kPath), kTwo);
  const auto table = relationTable(scores, Detail::kShort);
  EXPECT_EQ(table.caption, "Error against 2 relations");
  ASSERT_EQ(table.rows.size(), 1U);
  std::map<std::string, double> row;
  for (size_t i = 1; i < table.columns.size(); ++i)
    row[table.columns[i].key] = std::get<double>(table.rows[0][i]);
  EXPECT_NEAR(row.at("translation_mean_m"), 0.05, 1e-12);
  EXPECT_NEAR(row.at("translation_deviation_m"), 0.1 / std::sqrt(2), 1e-12);
  EXPECT_NEAR(row.at("translation_max_m"), 0.1, 1e-12);
  EXPECT_NEAR(row.at("rotation_mean_deg"), core::radToDeg(0.05), 1e-9);
  EXPECT_EQ(row.at("scored"), 2);
  EXPECT_EQ(row.at("interpolated"), 0);
  EXPECT_THAT(table.notes.at(0), HasSubstr("interpolated between the neighbours in time"));
  EXPECT_GT(relationTable(scores, Detail::kFull).columns.size(), table.columns.size());
}

TEST(RelationTables, HoldTheRelationsAgainstTheCovariancesThatTheMethodClaims) {
  auto run = runWith({{1, {0, 0, 0}}, {2, {5, 0, 0}}, {3, {9, 0, 0}}});
  run.final_estimate = kPath;  // 0.1 m and 0.1 rad off in the second relation
  EXPECT_EQ(relationTable(scoreByRelations(run, kTwo), Detail::kShort).columns.back().key, "interpolated");
  using Kind = results::RelativeCovariance::Kind;
  const Eigen::Matrix3d sigmas = Eigen::Vector3d(0.0025, 1, 0.0025).asDiagonal();  // 0.05 m, 1 m, 0.05 rad
  run.relative_covariances = {{Kind::kRelation, 1, 2, sigmas}, {Kind::kRelation, 1, 3, sigmas}};
  const auto scores = scoreByRelations(run, kTwo);
  EXPECT_NEAR(scores[0].anees.value(), (0 + 4 + 4) / 2.0 / 3, 1e-9);
  EXPECT_EQ(scores[0].within_95_share, 0.5);  // 8 is beyond 7.81
  EXPECT_FALSE(scores[1].anees);
  const auto table = relationTable(scores, Detail::kShort);
  EXPECT_EQ(table.columns.back().key, "within_95_share");
  EXPECT_EQ(std::get<double>(table.rows[0].back()), 0.5);
  EXPECT_EQ(std::get<std::string>(table.rows[1].back()), "");
  EXPECT_THAT(table.notes.at(1), HasSubstr("95 % region that the method claims"));
  EXPECT_EQ(relationTable(scores, Detail::kFull).columns.end()[-2].key, "anees");
}

// Every triangle of the relations has a gap of 0.3 m along x: one relation's variance is 0.3^2 / 6 along x
// and y.
TEST(RelationTables, HoldTheClaimsAgainstRelationsThatErrThemselves) {
  core::Relations relations;
  core::Trajectory path;
  for (int corner = 0; corner < 40; ++corner) {
    const double t = 10.0 * corner;
    relations.insert(relations.end(),
                     {{t, t + 1, {1.3, 0, 0}}, {t + 1, t + 2, {1, 0, 0}}, {t, t + 2, {2, 0, 0}}});
    for (int i = 0; i < 3; ++i) path.push_back({t + i, {1.0 * i, 0, 0}});
  }
  auto run = runWith(path);
  run.final_estimate = path;
  for (const auto& relation : relations)
    run.relative_covariances.push_back({results::RelativeCovariance::Kind::kRelation, relation.from_time_s,
                                        relation.to_time_s, 1e-4 * Eigen::Matrix3d::Identity()});
  const auto scores = scoreByRelations(run, relations);
  ASSERT_TRUE(scores[0].annotation);
  EXPECT_EQ(scores[0].annotation->triangles, 40U);
  EXPECT_NEAR(scores[0].annotation->sigma_xy_m, 0.3 / std::sqrt(6), 1e-9);
  EXPECT_NEAR(scores[0].within_95_share.value(), 2.0 / 3, 1e-9) << "of three one is 30 sigma off";
  EXPECT_NEAR(scores[0].within_95_share_annotated.value(), 1, 1e-9);
  EXPECT_NEAR(scores[0].anees_annotated.value(), 0.09 / (0.09 / 6 + 1e-4) / 9, 1e-6);
  const auto table = relationTable(scores, Detail::kShort);
  EXPECT_EQ(table.columns.back().key, "within_95_share_annotated");
  EXPECT_THAT(table.notes.at(1), HasSubstr("added to what the method claims"));
  EXPECT_THAT(table.notes.at(2), HasSubstr("err by 0.1732 m and 0.000 deg themselves"));
  EXPECT_EQ(relationTable(scores, Detail::kFull).columns.end()[-2].key, "anees_annotated");
  // Whatever the first path of a table says of itself.
  auto silent = scoreByRelations(runWith(path), relations);
  ASSERT_EQ(silent.size(), 1U);
  EXPECT_THAT(relationTable(silent, Detail::kShort).notes.at(1), HasSubstr("err by 0.1732 m"));
  silent.insert(silent.end(), scores.begin(), scores.end());
  EXPECT_EQ(relationTable(silent, Detail::kShort).columns.back().key, "within_95_share_annotated");
}

TEST(RelationTables, SayOfTheWorstWhenWhatAndHowFarOff) {
  const auto scores = scoreByRelations(runWith(kPath), kTwo);
  const auto table = worstRelationsTable(kTwo, scores, Detail::kShort);
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(std::get<double>(table.rows[0][2]), 2);  // seconds apart: the second relation is the worse one
  EXPECT_EQ(std::get<std::string>(table.rows[0][3]), "1.90 0.00 5.7");
  EXPECT_EQ(std::get<std::string>(table.rows[0][4]), "2.00 0.00 0.0");
  EXPECT_NEAR(std::get<double>(table.rows[0][5]), 0.1, 1e-12);
  EXPECT_EQ(worstRelationsTable(kTwo, scores, Detail::kFull).columns.size(), 11U);
}

/// Errors that have exactly this mean and sample deviation: as many above as below, and one in the middle
/// when odd.
std::vector<core::Pose2> errorsWith(size_t count, double mean_m, double deviation_m) {
  const double n = static_cast<double>(count);
  const double off_m = count % 2 == 1 ? deviation_m : deviation_m * std::sqrt((n - 1) / n);
  std::vector<core::Pose2> errors;
  for (size_t i = 0; i < count; ++i) {
    const bool middle = count % 2 == 1 && i + 1 == count;
    const double length_m = middle ? mean_m : mean_m + (i % 2 == 0 ? off_m : -off_m);
    const double direction_rad = 2.4 * static_cast<double>(i);  // all directions, in no order
    errors.push_back({length_m * std::cos(direction_rad), length_m * std::sin(direction_rad),
                      0.01 * std::sin(static_cast<double>(i))});
  }
  return errors;
}

struct Reference {
  const char* log;
  double mean_m, deviation_m;
};

/// The annotated logs of the benchmark, with what the literature's particle filter reaches on them. Its path
/// files are not published with the relations; these tests build paths and relations whose error is known to
/// be that.
class ReferenceFigures : public ::testing::TestWithParam<Reference> {
 protected:
  void SetUp() override {
    const std::string data = testing::realDataFolder(RASTERSLAM_SOURCE_DIR);
    if (data.empty()) GTEST_SKIP() << "the folder of real data is not there (RASTERSLAM_REAL_DATA)";
    const std::string log = GetParam().log;
    relations_ = logs::readRelations(data + "/logs/" + log + "/" + log + ".relations");
  }
  void expectReference(const metrics::RelationError& error, size_t relations) const {
    EXPECT_EQ(error.scored, relations);
    EXPECT_EQ(error.interpolated, 0U);
    // Poses of hundreds of metres and stamps of 1e9 s in doubles.
    EXPECT_NEAR(error.translation_m.mean, GetParam().mean_m, 1e-9);
    EXPECT_NEAR(error.translation_m.deviation, GetParam().deviation_m, 1e-9);
  }
  /// Some pose at every stamp that a relation names.
  core::Trajectory somePath() const {
    std::map<double, core::Pose2> poses;
    for (const auto& relation : relations_) poses[relation.from_time_s], poses[relation.to_time_s];
    core::RandomStream random(5, "path");
    core::Pose2 pose;
    core::Trajectory path;
    for (const auto& stamped : poses) {
      pose = pose * core::Pose2{random.uniform(0, 1), random.normal(0.1), random.normal(0.3)};
      path.push_back({stamped.first, pose});
    }
    return path;
  }

  core::Relations relations_;
};

// What it proves: pairing by stamp on the benchmark's own stamps, and the statistics. The motions are ours.
TEST_P(ReferenceFigures, AreWhatRelationsOfThatErrorAtTheBenchmarksStampsScore) {
  const auto path = somePath();
  const auto errors = errorsWith(relations_.size(), GetParam().mean_m, GetParam().deviation_m);
  const auto poseAt = [&](double time_s) {
    return std::lower_bound(path.begin(), path.end(), time_s,
                            [](const auto& stamped, double t) { return stamped.time_s < t; })
        ->pose;
  };
  for (size_t i = 0; i < relations_.size(); ++i)
    relations_[i].T_from_to =
        core::between(poseAt(relations_[i].from_time_s), poseAt(relations_[i].to_time_s)) *
        core::inverse(errors[i]);
  expectReference(metrics::relationError(relations_, path), relations_.size());
  // And through the file, which has six decimals.
  const testing::TempFolder folder;
  logs::writeRelations(relations_, folder / "a.relations");
  const auto read = metrics::relationError(logs::readRelations(folder / "a.relations"), path);
  EXPECT_NEAR(read.translation_m.mean, GetParam().mean_m, 2e-6);
  EXPECT_NEAR(read.translation_m.deviation, GetParam().deviation_m, 2e-6);
}

// What it proves: the same for the benchmark's own motions, as far as one path can have chosen errors against
// them: along a spanning forest of the relations. The others close loops and cannot be chosen too.
TEST_P(ReferenceFigures, AreWhatAPathOfThatErrorAlongTheBenchmarksOwnRelationsScores) {
  std::map<double, size_t> index_of;
  for (const auto& relation : relations_)
    for (const double time_s : {relation.from_time_s, relation.to_time_s})
      index_of.emplace(time_s, index_of.size());
  std::vector<size_t> parent(index_of.size());
  std::iota(parent.begin(), parent.end(), size_t{0});
  const auto rootOf = [&](size_t i) {
    while (parent[i] != i) i = parent[i];
    return i;
  };
  core::Relations forest;
  for (const auto& relation : relations_) {
    const size_t a = rootOf(index_of[relation.from_time_s]), b = rootOf(index_of[relation.to_time_s]);
    if (a == b) continue;
    parent[a] = b;
    forest.push_back(relation);
  }
  ASSERT_GT(forest.size(), 900U);  // of 989 and 1791 stamps
  const auto errors = errorsWith(forest.size(), GetParam().mean_m, GetParam().deviation_m);
  std::map<double, std::vector<std::pair<size_t, bool>>>
      edges_of;  // relation, and whether the stamp is its start
  for (size_t i = 0; i < forest.size(); ++i) {
    edges_of[forest[i].from_time_s].push_back({i, true});
    edges_of[forest[i].to_time_s].push_back({i, false});
  }
  std::map<double, core::Pose2> poses;
  for (const auto& stamp : index_of) {
    if (poses.count(stamp.first)) continue;
    poses[stamp.first] = {3, -4, 0.5};
    std::vector<double> open = {stamp.first};
    while (!open.empty()) {
      const double time_s = open.back();
      open.pop_back();
      for (const auto& [i, is_start] : edges_of[time_s]) {
        const core::Pose2 T = forest[i].T_from_to * errors[i];
        const double other_s = is_start ? forest[i].to_time_s : forest[i].from_time_s;
        if (poses.count(other_s)) continue;
        poses[other_s] = poses[time_s] * (is_start ? T : core::inverse(T));
        open.push_back(other_s);
      }
    }
  }
  core::Trajectory path;
  for (const auto& [time_s, pose] : poses) path.push_back({time_s, pose});
  expectReference(metrics::relationError(forest, path), forest.size());
}

/// The same by matrices instead of angles, in more digits.
class Matrix {
 public:
  explicit Matrix(const core::Pose2& T)
      : r_{std::cos(static_cast<long double>(T.phi)), -std::sin(static_cast<long double>(T.phi)),
           std::sin(static_cast<long double>(T.phi)), std::cos(static_cast<long double>(T.phi))},
        t_{T.x, T.y} {}
  Matrix inverseTimes(const Matrix& other) const {
    Matrix result = other;
    const long double dx = other.t_[0] - t_[0], dy = other.t_[1] - t_[1];
    result.t_ = {r_[0] * dx + r_[2] * dy, r_[1] * dx + r_[3] * dy};
    result.r_ = {r_[0] * other.r_[0] + r_[2] * other.r_[2], r_[0] * other.r_[1] + r_[2] * other.r_[3],
                 r_[1] * other.r_[0] + r_[3] * other.r_[2], r_[1] * other.r_[1] + r_[3] * other.r_[3]};
    return result;
  }
  double length() const { return static_cast<double>(std::hypot(t_[0], t_[1])); }
  double angle() const { return static_cast<double>(std::abs(std::atan2(r_[2], r_[0]))); }

 private:
  std::array<long double, 4> r_;
  std::array<long double, 2> t_;
};

TEST_P(ReferenceFigures, OfEveryRelationAreThoseOfAnotherArithmetic) {
  const auto path = somePath();
  std::map<double, core::Pose2> pose_at;
  for (const auto& [time_s, pose] : path) pose_at[time_s] = pose;
  const auto error = metrics::relationError(relations_, path, relations_.size());
  ASSERT_EQ(error.worst.size(), relations_.size());
  double sum_m = 0;
  for (const auto& scored : error.worst) {
    const auto& relation = relations_[scored.index];
    const Matrix motion =
        Matrix(pose_at[relation.from_time_s]).inverseTimes(Matrix(pose_at[relation.to_time_s]));
    const Matrix left = Matrix(relation.T_from_to).inverseTimes(motion);
    EXPECT_NEAR(scored.translation_m, left.length(), 1e-9);
    EXPECT_NEAR(scored.rotation_rad, left.angle(), 1e-9);
    sum_m += left.length();
  }
  EXPECT_NEAR(error.translation_m.mean, sum_m / static_cast<double>(relations_.size()), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Logs, ReferenceFigures,
                         ::testing::Values(Reference{"intel", 0.036, 0.027},
                                           Reference{"fr079", 0.058, 0.042}),
                         [](const auto& reference) { return std::string(reference.param.log); });

}  // namespace
}  // namespace slam::score

#include "libslam/logs/trajectory_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/testing/temp_folder.h"

namespace slam::logs {
namespace {

std::string errorFor(const std::string& text) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "a.relations", text);
  try {
    readRelations(folder / "a.relations");
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "(no error)";
}

TEST(Relations, AreReadFromTheBenchmarksLines) {
  const testing::TempFolder folder;
  files::writeFileAtomically(
      folder / "a.relations",
      "976052905.167303 976052911.885496 -0.056990 -0.128430 0.000000 0.000000 0.000000 -1.682210\n"
      "# a comment\n\n"
      "2 1 3 4 9 9 9 0.5\r\n");
  const auto relations = readRelations(folder / "a.relations");
  ASSERT_EQ(relations.size(), 2U);
  EXPECT_EQ(relations[0].from_time_s, 976052905.167303);
  EXPECT_EQ(relations[0].to_time_s, 976052911.885496);
  EXPECT_EQ(relations[0].T_from_to.x, -0.05699);
  EXPECT_EQ(relations[0].T_from_to.y, -0.12843);
  EXPECT_EQ(relations[0].T_from_to.phi, -1.68221);
  EXPECT_EQ(relations[1].T_from_to.phi, 0.5);
}

TEST(Relations, ComeBackFromTheirFile) {
  const testing::TempFolder folder;
  const core::Relations written = {{1.25, 1e9 + 0.123456, {1.5, -2.25, 0.125}}, {3, 2, {0, 0, -3}}};
  writeRelations(written, folder / "b.relations");
  const auto read = readRelations(folder / "b.relations");
  ASSERT_EQ(read.size(), written.size());
  for (size_t i = 0; i < read.size(); ++i) {
    EXPECT_NEAR(read[i].from_time_s, written[i].from_time_s, 1e-6);
    EXPECT_NEAR(read[i].to_time_s, written[i].to_time_s, 1e-6);
    EXPECT_EQ(read[i].T_from_to.x, written[i].T_from_to.x);
    EXPECT_EQ(read[i].T_from_to.y, written[i].T_from_to.y);
    EXPECT_EQ(read[i].T_from_to.phi, written[i].T_from_to.phi);
  }
  EXPECT_THROW(writeRelations({}, folder / "c.relations"), core::ContractError);
}

TEST(Relations, BadLinesAreNamed) {
  EXPECT_THAT(errorFor("1 2 3 4 5 6 7 8\n1 2 3\n"),
              ::testing::HasSubstr("a.relations:2: found 3 numbers, expected 8"));
  EXPECT_THAT(errorFor("1 2 3 4 5 6 7 x\n"),
              ::testing::HasSubstr("a.relations:1: found 'x', expected a finite number"));
  EXPECT_THAT(errorFor("1 2 3 nan 5 6 7 8\n"), ::testing::HasSubstr("found 'nan'"));
  EXPECT_THAT(errorFor("# nothing\n"), ::testing::HasSubstr("holds no relation"));
}

}  // namespace
}  // namespace slam::logs

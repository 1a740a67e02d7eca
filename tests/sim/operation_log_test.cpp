#include "libslam/sim/operation_log.h"

#include <gmock/gmock.h>

#include "libslam/core/error.h"

namespace slam::sim {
namespace {

std::string errorOf(const std::string& text) {
  try {
    parseOperations(text, "run.ops");
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(OperationLog, WritesOneLinePerCommand) {
  EXPECT_EQ(formatOperations({{'m', 0.5, 0.49}, {'t', -0.25}}), "m 0.5 0.49\nt -0.25\n");
  EXPECT_EQ(formatOperations({}), "");
}

TEST(OperationLog, ReadsBackTheSameNumbers) {
  const std::vector<Operation> written = {{'t', 0.1 + 0.2}, {'m', -1.0 / 3, 1e-17}, {'t', 0}, {'m', 1e6, 0}};
  const auto read = parseOperations(formatOperations(written), "run.ops");
  ASSERT_EQ(read.size(), written.size());
  for (size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].kind, written[i].kind);
    EXPECT_EQ(read[i].first, written[i].first);
    EXPECT_EQ(read[i].second, written[i].second);
  }
}

TEST(OperationLog, ReadsAnEmptyLog) {
  EXPECT_TRUE(parseOperations("", "run.ops").empty());
}

TEST(OperationLog, NamesFileAndLineOfWhatItCannotRead) {
  const std::string expected = ", expected 'm REAR FRONT' in metres or 't ANGLE' in radians";
  EXPECT_EQ(errorOf("m 1 1\nx 3\n"), "run.ops:2: found 'x 3'" + expected);
  EXPECT_EQ(errorOf("m 1\n"), "run.ops:1: found 'm 1'" + expected);
  EXPECT_EQ(errorOf("m 1 2 3\n"), "run.ops:1: found 'm 1 2 3'" + expected);
  EXPECT_EQ(errorOf("t 1 2\n"), "run.ops:1: found 't 1 2'" + expected);
  EXPECT_EQ(errorOf("t\n"), "run.ops:1: found 't'" + expected);
  EXPECT_EQ(errorOf("t nan\n"), "run.ops:1: found 't nan'" + expected);
  EXPECT_EQ(errorOf("t 0.5x\n"), "run.ops:1: found 't 0.5x'" + expected);
  EXPECT_EQ(errorOf("t 1\n\nt 1\n"), "run.ops:2: found ''" + expected);
  EXPECT_EQ(errorOf("mm 1 1\n"), "run.ops:1: found 'mm 1 1'" + expected);
}

TEST(OperationLog, NoticesALogThatIsCutShort) {
  EXPECT_EQ(errorOf("t 1\nm 0.5 0.4"),
            "run.ops:2: the last line has no line end, expected a log that is not cut short");
}

TEST(OperationLog, RefusesToWriteWhatItCouldNotReadBack) {
  EXPECT_THROW(formatOperations({{'x', 0, 0}}), core::ContractError);
  EXPECT_THROW(formatOperations({{'t', std::nan(""), 0}}), core::ContractError);
}

}  // namespace
}  // namespace slam::sim

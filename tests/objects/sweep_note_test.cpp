#include "libslam/objects/sweep_note.h"

#include <gtest/gtest.h>

#include "libslam/core/error.h"

namespace slam::objects {
namespace {

TEST(SweepNote, ReadsBackWhatItWrote) {
  const SweepNote note{"front/scan", {0.0497, true, 0.25}};
  const auto read = parseSweepNote(formatSweepNote(note));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->label, note.label);
  EXPECT_EQ(read->sweep.duration_s, note.sweep.duration_s);
  EXPECT_EQ(read->sweep.clockwise, note.sweep.clockwise);
  EXPECT_EQ(read->sweep.stamped_share, note.sweep.stamped_share);
}

TEST(SweepNote, OtherCommentsAreNone) {
  for (const char* text : {"", "turned the corner", "[sweep", "label = LASER\n"})
    EXPECT_FALSE(parseSweepNote(text)) << text;
}

TEST(SweepNote, ABrokenOneSaysWhatIsWrong) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      parseSweepNote(text);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("[sweep]\nlabel = LASER\n"), "sweep note: key 'duration_s' is missing");
  EXPECT_NE(refusal("[sweep]\nlabel = LASER\nduration_s = -1\n"), "");
  EXPECT_NE(refusal("[sweep]\nlabel = LASER\nduration_s = nan\n"), "");
  EXPECT_NE(refusal("[sweep]\nlabel = LASER\nduration_s = 0.1\nstamped_share = 2\n"), "");
}

}  // namespace
}  // namespace slam::objects

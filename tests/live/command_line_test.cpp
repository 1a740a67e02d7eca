#include "libslam/live/command_line.h"

#include <gtest/gtest.h>

namespace slam::live {
namespace {

void typeAll(CommandLine& line, const std::string& text) {
  for (const char letter : text) line.type(static_cast<unsigned>(letter));
}

TEST(CommandLine, GivesTheCommandThatWasTypedAndCloses) {
  CommandLine line;
  EXPECT_EQ(line.text(), "");
  line.open();
  typeAll(line, "turn 29");
  line.erase();
  typeAll(line, "5");
  EXPECT_EQ(line.text(), "> turn 25_");
  const auto command = line.enter();
  ASSERT_TRUE(command);
  EXPECT_EQ(command->kind, robot::UserCommand::kTurn);
  EXPECT_DOUBLE_EQ(command->amount, core::degToRad(25));
  EXPECT_FALSE(line.isOpen());
}

TEST(CommandLine, KeepsALineThatIsNoneToBeMended) {
  CommandLine line;
  line.open();
  typeAll(line, "mvoe 1");
  EXPECT_FALSE(line.enter());
  EXPECT_TRUE(line.isOpen());
  EXPECT_NE(line.refusal(), "");
  EXPECT_EQ(line.text(), "> mvoe 1_");
  line.erase();
  EXPECT_EQ(line.refusal(), "");
}

TEST(CommandLine, AnEmptyLineOnlyCloses) {
  CommandLine line;
  line.open();
  EXPECT_FALSE(line.enter());
  EXPECT_FALSE(line.isOpen());
}

TEST(CommandLine, TakesNothingWhileClosedAndNothingStrange) {
  CommandLine line;
  line.type('m');
  line.open();
  line.type(7), line.type(0x20AC);
  EXPECT_EQ(line.text(), "> _");
  for (int i = 0; i < 1000; ++i) line.type('1');
  EXPECT_EQ(line.text().size(), 63U);
  line.close();
  line.open();
  EXPECT_EQ(line.text(), "> _");  // and begins anew
}

}  // namespace
}  // namespace slam::live

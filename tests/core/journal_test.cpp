#include "libslam/core/journal.h"

#include <gtest/gtest.h>

#include <set>

namespace slam::core {
namespace {

TEST(JournalEvents, StandInTheTableAtTheirOwnPlaceUnderAWordOfTheirOwn) {
  std::set<std::string> words;
  for (size_t i = 0; i < journalEventInfos().size(); ++i) {
    const auto& info = journalEventInfos()[i];
    EXPECT_EQ(static_cast<size_t>(info.event), i) << info.word;
    EXPECT_TRUE(words.insert(info.word).second) << info.word;
    EXPECT_EQ(journalEventOf(wordOf(info.event)), info.event);
  }
  EXPECT_EQ(journalEventInfos().back().event, JournalEvent::kInterrupted);  // none is missing
}

TEST(JournalEvents, AWordThatIsNoneIsSaid) {
  EXPECT_FALSE(journalEventOf("sneezed").has_value());
  EXPECT_FALSE(journalEventOf("").has_value());
  EXPECT_FALSE(journalEventOf("Lost").has_value());
}

}  // namespace
}  // namespace slam::core

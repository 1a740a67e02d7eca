#include "libslam/results/journal_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libslam/files/files.h"
#include "libslam/results/stopped_run.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::results {
namespace {
using slam::testing::errorOf;
using ::testing::HasSubstr;

std::vector<core::JournalLine> someJournal() {
  const core::Trajectory path = {{10, {0, 0, 0}}, {11, {1, 0, 0}}, {12, {1, 2, 0}}};
  return placedJournal({{1, core::JournalEvent::kPoor, 0.25, -1, ""},
                        {2, core::JournalEvent::kAccepted, 3, 0, ""},
                        {3, core::JournalEvent::kOptimised, 12.5, -1, "refinement"}},
                       {10, 11, 12}, path);
}

std::vector<core::JournalLine> eventsOf(const std::vector<std::string>& events) {
  std::vector<core::JournalLine> journal;
  for (const auto& event : events) {
    core::JournalLine line;
    line.scan = static_cast<int>(journal.size());
    line.time_s = 0.5 * line.scan;
    line.event = core::journalEventOf(event).value();
    journal.push_back(line);
  }
  return journal;
}

TEST(Journal, SaysWhenAndWhere) {
  const auto journal = someJournal();
  ASSERT_EQ(journal.size(), 3U);
  EXPECT_EQ(journal[0].time_s, 1);
  EXPECT_EQ(journal[0].place.x, 1);
  EXPECT_TRUE(std::isnan(journal[0].other_place.x));
  EXPECT_EQ(journal[1].place.y, 2);
  EXPECT_EQ(journal[1].other_place.x, 0);
  // What happens in the end is the last scan's.
  EXPECT_EQ(journal[2].scan, 2);
  EXPECT_EQ(journal[2].time_s, 2);
}

TEST(Journal, AFailuresOddWordsStayInTheirField) {
  const testing::TempFolder folder;
  Stop stop;
  stop.why = "\"map\", three\nlines";
  files::writeFileAtomically(folder / "journal.csv", journalCsv({stopLine(stop, {})}));
  const auto journal = readJournal(folder / "journal.csv");
  ASSERT_EQ(journal.size(), 1U);
  EXPECT_EQ(journal[0].event, core::JournalEvent::kFailed);
  EXPECT_EQ(journal[0].detail, "'map'; three lines");
}

TEST(Journal, AWordThatIsNoEventIsRefusedWithItsLine) {
  const testing::TempFolder folder;
  std::string csv = journalCsv(someJournal());
  csv.replace(csv.find("accepted"), 8, "sneezed");
  files::writeFileAtomically(folder / "journal.csv", csv);
  EXPECT_THAT(errorOf([&] { readJournal(folder / "journal.csv"); }),
              HasSubstr("journal.csv:3: event: found 'sneezed'"));
}

TEST(Journal, ComesBackAsItWasWritten) {
  const testing::TempFolder folder;
  const std::string csv = journalCsv(someJournal());
  files::writeFileAtomically(folder / "journal.csv", csv);
  const auto journal = readJournal(folder / "journal.csv");
  ASSERT_EQ(journal.size(), 3U);
  EXPECT_EQ(journal[0].other_scan, -1);
  EXPECT_EQ(journal[1].other_scan, 0);
  EXPECT_EQ(journal[2].detail, "refinement");
  EXPECT_EQ(journalCsv(journal), csv);
}

TEST(Journal, ABrokenFileIsOneClearLine) {
  const testing::TempFolder folder;
  const std::string path = folder / "journal.csv";
  files::writeFileAtomically(path, "scan,time_s,event,value,other_scan,detail\n");
  EXPECT_THAT(errorOf([&] { readJournal(path); }), HasSubstr(path + ":1: the column 'x_m' is missing"));
  std::string csv = journalCsv(someJournal());
  files::writeFileAtomically(path, csv + "4,5\n");
  EXPECT_THAT(errorOf([&] { readJournal(path); }), HasSubstr(path + ":5: found 2 fields, expected 10"));
  csv.replace(csv.find("0.25"), 4, "many");
  files::writeFileAtomically(path, csv);
  EXPECT_THAT(errorOf([&] { readJournal(path); }),
              HasSubstr(path + ":2: value: found 'many', expected a number"));
}

TEST(Journal, ReadsWellInAlignedColumns) {
  EXPECT_EQ(journalText(someJournal()),
            "   scan    time s  event          value      x m      y m  refers to\n"
            "      1       1.0  poor            0.25     1.00     0.00\n"
            "      2       2.0  accepted           3     1.00     2.00  scan 0 at 0.00, 0.00\n"
            "      2       2.0  optimised       12.5     1.00     2.00  refinement\n");
}

TEST(Journal, ARobotIsLostUntilItIsFoundAgain) {
  EXPECT_FALSE(lostInTheEnd(eventsOf({"poor", "optimised"})).has_value());
  EXPECT_FALSE(lostInTheEnd(eventsOf({"lost", "lost", "recovered", "poor"})).has_value());
  const auto lost = lostInTheEnd(eventsOf({"lost", "recovered", "lost", "lost", "optimised"}));
  ASSERT_TRUE(lost.has_value());
  EXPECT_EQ(lostText(*lost), "lost at scan 2 (1.0 s)");
}

}  // namespace
}  // namespace slam::results

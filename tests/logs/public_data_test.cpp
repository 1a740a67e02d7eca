#include "libslam/logs/public_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "libslam/files/files.h"
#include "libslam/resources/resources.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::logs {
namespace {
using slam::testing::errorOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(PublicData, TheTableThatComesWithTheProgramIsComplete) {
  const auto table = readPublicData(resources::publicDataFile());
  EXPECT_THAT(table.note, HasSubstr("not stated"));
  std::set<std::string> names;
  for (const auto& data : table.data) {
    SCOPED_TRACE(data.name);
    names.insert(data.name);
    for (const auto& text : {data.name, data.what, data.by, data.licence, data.format, data.truth})
      EXPECT_NE(text, "");
    EXPECT_THAT(data.page, StartsWith("http"));
    // Nobody's word for a licence, no licence.
    EXPECT_EQ(data.licence == "not stated", data.licence_source.empty());
    EXPECT_FALSE(data.odd.empty());
    EXPECT_FALSE(data.fetch.empty());
    for (const auto& line : data.convert) EXPECT_THAT(line, StartsWith("rasterslam "));
    for (const auto& path : data.installed) EXPECT_THAT(path, StartsWith("/usr/share/mrpt/datasets/"));
  }
  for (const char* name :
       {"intel", "fr079", "mit-killian", "aces", "mit-csail", "fhw", "radish", "stata", "deutsches-museum"})
    EXPECT_EQ(names.count(name), 1U) << name;
}

std::string entryWith(const std::string& name, const std::string& more) {
  return "{\"name\": \"" + name +
         "\", \"what\": \"a\", \"by\": \"b\", \"page\": \"http://c\", \"licence\": \"d\", "
         "\"licence_source\": \"e\", \"format\": \"f\", \"truth\": \"g\", \"odd\": [\"h\"], \"fetch\": "
         "[\"i\"], "
         "\"convert\": []" +
         more + "}";
}

TEST(PublicData, FindsWhatIsOnThisMachine) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "there.rawlog", "x");
  files::writeFileAtomically(
      folder / "data.json",
      "{\"note\": \"n\", \"data\": [" +
          entryWith("one", ", \"kind\": \"log\", \"size_mb\": 1.5, \"installed\": [\"" +
                               (folder / "there.rawlog") + "\", \"" + (folder / "not_there.rawlog") + "\"]") +
          ", " + entryWith("two", ", \"kind\": \"plan\", \"size_mb\": null") + "]}");
  const auto table = readPublicData(folder / "data.json");
  ASSERT_EQ(table.data.size(), 2U);
  EXPECT_EQ(table.data[0].here, std::vector<std::string>{folder / "there.rawlog"});
  EXPECT_EQ(table.data[0].size_mb, 1.5);
  EXPECT_TRUE(table.data[1].here.empty());
  EXPECT_TRUE(std::isnan(table.data[1].size_mb));
}

TEST(PublicData, SaysWhichEntryIsWrong) {
  const testing::TempFolder folder;
  const auto errorWith = [&](const std::string& text) {
    files::writeFileAtomically(folder / "data.json", text);
    return errorOf([&] { readPublicData(folder / "data.json"); });
  };
  const auto list = [](const std::string& entries) {
    return "{\"note\": \"n\", \"data\": [" + entries + "]}";
  };
  const std::string good = ", \"kind\": \"log\", \"size_mb\": 1";
  EXPECT_THAT(errorWith("["), HasSubstr("expected an object with a text 'note' and a list 'data'"));
  EXPECT_THAT(errorWith("{\"note\": \"n\"}"), HasSubstr("'data'"));
  EXPECT_THAT(errorWith(list("3")), HasSubstr("data.json: entry 1: expected an object"));
  EXPECT_THAT(errorWith(list(entryWith("a", good) + ", " + entryWith("b", ", \"kind\": \"log\""))),
              HasSubstr("entry 2: key 'size_mb' is missing"));
  EXPECT_THAT(errorWith(list(entryWith("a", ", \"kind\": \"song\", \"size_mb\": 1"))),
              HasSubstr("found 'song', expected log, plan, collection or pose graph"));
  EXPECT_THAT(errorWith(list(entryWith("a", ", \"kind\": 3, \"size_mb\": 1"))),
              HasSubstr("'kind': found 3, expected a text"));
  EXPECT_THAT(errorWith(list(entryWith("a", ", \"kind\": \"log\", \"size_mb\": -1"))),
              HasSubstr("above 0 or null"));
  EXPECT_THAT(errorWith(list(entryWith("a", good + ", \"installed\": [1]"))), HasSubstr("a list of texts"));
  EXPECT_THAT(errorWith(list(entryWith("a", good + ", \"colour\": 1"))), HasSubstr("unknown key 'colour'"));
  EXPECT_THAT(errorWith(list(entryWith("a", good) + ", " + entryWith("a", good))),
              HasSubstr("name 'a' is used twice"));
}

}  // namespace
}  // namespace slam::logs

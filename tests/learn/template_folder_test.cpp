#include "libslam/learn/template_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::learn {
namespace {
namespace fs = std::filesystem;
using slam::testing::errorOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Templates, AreOfFourKinds) {
  std::vector<std::string> names;
  for (const auto& kind : templateKinds()) names.push_back(kind.name);
  EXPECT_THAT(names, ElementsAre("method", "navigator", "plugin", "strategy"));
}

TEST(Templates, OfEveryKindAndLanguageLeaveNoMarkAndSayWhatToEdit) {
  const testing::TempFolder folder;
  for (const auto& kind : templateKinds())
    for (const auto& language : kind.languages) {
      const std::string path = folder / (kind.name + "_" + language);
      const auto made = makeFromTemplate({kind.name, language, "wall_hugger", path, "/opt/library"});
      EXPECT_EQ(made.path, path);
      EXPECT_THAT(made.files, Contains("README.md"));
      EXPECT_FALSE(made.next.empty());
      for (const auto& line : made.next) EXPECT_EQ(line.find('@'), std::string::npos) << line;
      for (const auto& file : made.files) {
        const std::string text = files::readTextFile(path + "/" + file);
        EXPECT_EQ(file.find('@'), std::string::npos) << file;
        for (const char* mark : {"@name@", "@Name@", "@rasterslam@", "@version@"})
          EXPECT_EQ(text.find(mark), std::string::npos) << path << "/" << file;
      }
      EXPECT_THAT(files::readTextFile(path + "/README.md"), HasSubstr("next**")) << path;
      const bool is_test_there =
          std::any_of(made.files.begin(), made.files.end(),
                      [](const std::string& file) { return file.find("test") != std::string::npos; });
      EXPECT_TRUE(is_test_there) << path;
      if (language == "cpp") {
        EXPECT_THAT(files::readTextFile(path + "/find_rasterslam.cmake"),
                    HasSubstr("RASTERSLAM \"/opt/library\""));
      }
    }
}

TEST(Templates, TakeTheUsualLanguage) {
  const testing::TempFolder folder;
  EXPECT_THAT(makeFromTemplate({"method", "", "mine", folder / "mine", ""}).files, Contains("mine.py"));
}

TEST(Templates, RefuseWhatCannotBe) {
  const testing::TempFolder folder;
  const auto error = [&](const std::string& kind, const std::string& name, const std::string& language = "") {
    return errorOf([&] { makeFromTemplate({kind, language, name, folder / "x", ""}); });
  };
  EXPECT_THAT(error("strategie", "mine"), HasSubstr("did you mean 'strategy'?"));
  EXPECT_EQ(error("strategy", "mine", "python"), "--language: found 'python', expected for a strategy: cpp");
  for (const char* name : {"", "Mine", "1st", "my-method", "a b", "../x", "_a"})
    EXPECT_THAT(error("method", name), HasSubstr("expected small letters")) << name;
  EXPECT_THAT(error("method", std::string(41, 'a')), HasSubstr("40 at most"));
  EXPECT_THAT(error("method", "class"), HasSubstr("a reserved word"));
  EXPECT_THAT(error("method", "graph"), HasSubstr("the name of a built-in method"));
  EXPECT_THAT(error("plugin", "icp"), HasSubstr("the name of a built-in plugin"));
  EXPECT_THAT(error("strategy", "quadrant"), HasSubstr("the name of a built-in strategy"));
  EXPECT_THAT(error("navigator", "bug2"), HasSubstr("the name of a built-in navigator"));
  EXPECT_FALSE(fs::exists(folder / "x"));
}

TEST(Templates, NeverReplaceAFolder) {
  const testing::TempFolder folder;
  makeFromTemplate({"method", "", "mine", folder / "mine", ""});
  std::ofstream(folder / "mine/mine.py") << "my work\n";
  EXPECT_THAT(errorOf([&] {
                makeFromTemplate({"method", "", "mine", folder / "mine", ""});
              }),
              HasSubstr("somebody's work"));
  EXPECT_EQ(files::readTextFile(folder / "mine/mine.py"), "my work\n");
}

TEST(ClassName, JoinsTheWords) {
  EXPECT_EQ(className("wall_hugger"), "WallHugger");
  EXPECT_EQ(className("a1__b"), "A1B");
}

TEST(LibraryFolder, IsTheBuildFolderOfAProgramInIt) {
  EXPECT_EQ(libraryFolder({"", "/src/build/release/apps/rasterslam", "/src/build/release", "/src", ""}),
            "/src/build/release");
  EXPECT_EQ(libraryFolder({"", "/usr/bin/rasterslam", "/src/build/release", "/src", ""}), "/usr");
}

}  // namespace
}  // namespace slam::learn

#include "libslam/learn/lesson.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/learn/recipes.h"
#include "libslam/learn/student_folder.h"
#include "libslam/resources/resources.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::learn {
namespace {
namespace fs = std::filesystem;
using slam::testing::errorOf;
using ::testing::HasSubstr;

TEST(Lessons, AreTenAndEachHasAPageWithThreeExercisesAndTwoPictures) {
  const auto lessons = readLessons();
  ASSERT_EQ(lessons.size(), 10U);
  for (const auto& lesson : lessons) {
    const std::string page = files::readTextFile(pagesFolder() + "/" + lesson.name + ".md");
    EXPECT_THAT(page, HasSubstr("# Lesson " + std::to_string(lesson.options.number) + ": ")) << lesson.name;
    EXPECT_THAT(page, HasSubstr("\n## Exercises\n\n1. ")) << lesson.name;
    EXPECT_THAT(page, HasSubstr("\n3. ")) << lesson.name;
    const std::string number = lesson.name.substr(0, 2);
    for (const char* when : {"-before.png", "-after.png"}) {
      EXPECT_THAT(page, HasSubstr("](pictures/" + number + when + ")")) << lesson.name;
      EXPECT_TRUE(fs::exists(pagesFolder() + "/pictures/" + number + when)) << lesson.name << when;
    }
    EXPECT_GE(lesson.hints.size(), 5U) << lesson.name;
    EXPECT_NO_THROW(recipeOf(lesson.options.recipe)) << lesson.name;
  }
}

// The figures of every recipe, and what the files hold: the same each time, another student's are others.
TEST(Lessons, HandOutTheSameMaterialTwiceAndAnotherToTheNextStudent) {
  for (const auto& lesson : readLessons()) {
    const testing::TempFolder first, second, other;
    const auto make = recipeOf(lesson.options.recipe);
    const auto figures = make({lesson, 5, first.path(), core::silentProgress()});
    EXPECT_EQ(make({lesson, 5, second.path(), core::silentProgress()}), figures) << lesson.name;
    EXPECT_EQ(materialHashes(first.path()), materialHashes(second.path())) << lesson.name;
    make({lesson, 6, other.path(), core::silentProgress()});
    EXPECT_NE(materialHashes(first.path()), materialHashes(other.path())) << lesson.name;
    for (const auto& hint : lesson.hints)
      if (!hint.figure.empty()) {
        EXPECT_TRUE(figures.count(hint.figure)) << lesson.name << " [hint " << hint.name << "]";
      }
    EXPECT_EQ(questionText(lesson, figures).find('{'), std::string::npos) << lesson.name;
    EXPECT_EQ(figures.count("answer"), lesson.options.answer == "number" ? 1U : 0U) << lesson.name;
  }
}

class LessonFiles : public ::testing::Test {
 protected:
  std::string errorWith(const std::string& text) {
    files::writeFileAtomically(folder_ / "01-one.ini", text);
    return errorOf([&] { readLessons(folder_.path()); });
  }
  testing::TempFolder folder_;
};

TEST_F(LessonFiles, AreRefusedWhereSomethingIsWrong) {
  EXPECT_EQ(errorWith("[lesson]\nnumber = 1\n[hint a]\nof = x\ntimes = -1\nsay = Why.\n"), "no error");
  EXPECT_THAT(errorWith("[lesson]\nnumber = 2\n"), HasSubstr("found lesson number 2, expected 1"));
  EXPECT_THAT(errorWith("[lesson]\nnumbre = 1\n"), HasSubstr("did you mean 'number'?"));
  EXPECT_THAT(errorWith("[lesson]\nnumber = 1\nanswer = essay\n"), HasSubstr("01-one.ini:3"));
  EXPECT_THAT(errorWith("[lesson]\nnumber = 1\n[hint a]\ntimes = much\nsay = Why.\n"),
              HasSubstr("times = much"));
  EXPECT_THAT(errorWith("[lesson]\nnumber = 1\n[hint a]\nof = x\n"), HasSubstr("key 'say' is missing"));
}

TEST(FindLesson, TakesANumberOrAName) {
  const auto lessons = readLessons();
  EXPECT_EQ(findLesson(lessons, "3").options.number, 3);
  EXPECT_EQ(findLesson(lessons, "04-icp").options.number, 4);
  EXPECT_EQ(errorOf([&] { findLesson(lessons, "11"); }),
            "lesson: found '11', expected a number from 1 to 10; 'rasterslam learn' lists them");
}

TEST(StudentNumbers, AreWholeAndFromOne) {
  EXPECT_EQ(parseStudent("17", "--student"), 17U);
  for (const char* word : {"0", "-3", "1.5", "seventeen", "", "1000001", "99999999999999999999"})
    EXPECT_THAT(errorOf([&] { parseStudent(word, "--student"); }), HasSubstr("--student: found")) << word;
}

TEST(StudentFolders, AreNeverReplaced) {
  const testing::TempFolder folder;
  const auto lessons = readLessons();
  startLesson(lessons[8], 3, folder / "mine", core::silentProgress());
  EXPECT_EQ(readStudentFolder(folder / "mine")->student, 3U);
  EXPECT_EQ(readStudentFolder(folder / "mine")->lesson, 9);
  EXPECT_TRUE(readStudentFolder(folder / "mine")->files.count("plan.png"));
  EXPECT_THAT(errorOf([&] { startLesson(lessons[8], 3, folder / "mine", core::silentProgress()); }),
              HasSubstr("may hold an answer"));
  EXPECT_FALSE(readStudentFolder(folder.path()));
}

}  // namespace
}  // namespace slam::learn

#include "libslam/learn/check_answer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/learn/grade.h"
#include "libslam/learn/student_folder.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::learn {
namespace {
using slam::testing::errorOf;
using ::testing::HasSubstr;

/// A question whose right answer is 2, with some wrong ones.
Lesson drawn() {
  Lesson lesson;
  lesson.name = "01-drawn";
  lesson.options.number = 1;
  lesson.options.tolerance = 0.01;
  lesson.options.wrong = "Look again.";
  lesson.hints = {{"centimetres", "", 100, "cm"},
                  {"sign", "", -1, "sign"},
                  {"total", "total", 1, "total"},
                  {"near_total", "near_total", 1, "near"},
                  {"absent", "nowhere", 1, "absent"}};
  return lesson;
}

std::string kindOf(double found) {
  return judgeNumber(drawn(), found, {{"answer", 2}, {"total", 7}, {"near_total", 7.015}}).kind;
}

TEST(JudgeNumber, TakesWhatIsWithinTheTolerance) {
  EXPECT_EQ(kindOf(2), "right");
  EXPECT_EQ(kindOf(2.0099), "right");
  EXPECT_EQ(kindOf(1.9901), "right");
  EXPECT_EQ(kindOf(2.011), "wrong");
}

TEST(JudgeNumber, NamesTheWrongWayThatLeadsThere) {
  EXPECT_EQ(kindOf(200.5), "centimetres");  // the tolerance is in centimetres, too
  EXPECT_EQ(kindOf(-2), "sign");
  EXPECT_EQ(kindOf(7.002), "total");
  EXPECT_EQ(kindOf(7.012), "near_total");  // of two the nearer
  EXPECT_EQ(kindOf(123), "wrong");
  EXPECT_EQ(kindOf(std::nan("")), "wrong");
}

TEST(JudgeNumber, ARightNumberIsRightHoweverItWasFound) {
  EXPECT_EQ(judgeNumber(drawn(), 2, {{"answer", 2}, {"total", 2}}).finding, Finding::kRight);
}

TEST(JudgeNumber, NeverSaysTheRightOne) {
  for (const double found : {200.0, -2.0, 7.0, 99.0})
    EXPECT_EQ(judgeNumber(drawn(), found, {{"answer", 2}, {"total", 7}}).said.find('2'), std::string::npos);
}

class Answers : public ::testing::Test {
 protected:
  /// Lesson 5, the quickest with a number.
  static void SetUpTestSuite() {
    shared_folder = new testing::TempFolder;
    startLesson(lesson(), 4, *shared_folder / "mine", core::silentProgress());
    const testing::TempFolder scratch;
    right_answer =
        recipeOf(lesson().options.recipe)({lesson(), 4, scratch.path(), core::silentProgress()}).at("answer");
  }
  static void TearDownTestSuite() { delete shared_folder; }
  static const Lesson& lesson() {
    static const auto lessons = readLessons();
    return lessons[4];
  }
  static Verdict check(const std::string& answer, std::uint64_t student = 0) {
    AnswerRequest request;
    request.answer = answer;
    request.student = student;
    return checkAnswer(lesson(), request, core::silentProgress());
  }
  static Verdict checkText(const std::string& text) {
    files::writeFileAtomically(*shared_folder / "mine/answer.txt", text);
    return check(*shared_folder / "mine");
  }
  inline static testing::TempFolder* shared_folder = nullptr;
  inline static double right_answer = 0;
};

TEST_F(Answers, AreReadFromTheFolderOrTaken) {
  EXPECT_EQ(checkText(files::formatNumber(right_answer) + "\n").finding, Finding::kRight);
  EXPECT_EQ(check(files::formatNumber(right_answer), 4).finding, Finding::kRight);
  EXPECT_THAT(errorOf([&] { check("0.5"); }), HasSubstr("expected --student NUMBER"));
}

TEST_F(Answers, ThatAreNoNumberSayWhy) {
  EXPECT_THAT(checkText("").said, HasSubstr("empty"));
  EXPECT_THAT(checkText("0,75").said, HasSubstr("with a point"));
  EXPECT_THAT(checkText("0.75 metres").said, HasSubstr("without a unit"));
  EXPECT_THAT(checkText("nan").said, HasSubstr("0 / 0"));
  EXPECT_THAT(checkText("many").said, HasSubstr("not a number"));
  EXPECT_THAT(checkText("\x1b[31m").found, HasSubstr("\\x1b[31m"));
}

TEST_F(Answers, OfAnotherStudentOrLessonAreNamed) {
  EXPECT_EQ(check(*shared_folder / "mine", 5).kind, "other_student");
  const testing::TempFolder scratch;
  const double neighbours =
      recipeOf(lesson().options.recipe)({lesson(), 5, scratch.path(), core::silentProgress()}).at("answer");
  EXPECT_EQ(check(files::formatNumber(neighbours), 4).kind, "other_student");
  AnswerRequest request;
  request.answer = *shared_folder / "mine";
  EXPECT_EQ(checkAnswer(readLessons()[0], request, core::silentProgress()).kind, "other_lesson");
  EXPECT_EQ(check(*shared_folder / "nowhere").kind, "missing");
  EXPECT_THAT(errorOf([&] { check(shared_folder->path()); }), HasSubstr("holds no lesson.ini"));
}

TEST_F(Answers, AreGradedFolderByFolder) {
  const testing::TempFolder room;
  startLesson(lesson(), 7, room / "a/deep", core::silentProgress());
  startLesson(lesson(), 8, room / "b", core::silentProgress());
  files::writeFileAtomically(room / "b/answer.txt", "-1\n");
  startLesson(lesson(), 8, room / "c", core::silentProgress());
  files::writeFileAtomically(room / "c/lesson.ini", "[lesson]\nnumber = 5\nstudent = nobody\nversion = 0\n");
  const auto lessons = readLessons();
  const auto folders = studentFolders({room.path()});
  ASSERT_EQ(folders.size(), 3U);
  const auto grades = grade(lessons, folders, core::silentProgress());
  EXPECT_EQ(grades[0].verdict.kind, "missing");
  EXPECT_EQ(grades[1].verdict.finding, Finding::kWrong);
  EXPECT_EQ(grades[2].verdict.kind, "broken");
  const auto table = gradeTable(lessons, grades);
  EXPECT_EQ(table.rows.size(), 3U);
  EXPECT_EQ(classTable(lessons, grades).rows.size(), 3U);  // students 7, 8 and the unknown one
  EXPECT_THAT(errorOf([&] { studentFolders({room / "a/deep/nothing"}); }), HasSubstr("no such folder"));
  const testing::TempFolder empty;
  EXPECT_THAT(errorOf([&] { studentFolders({empty.path()}); }), HasSubstr("found no lesson.ini"));
}

}  // namespace
}  // namespace slam::learn

#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/learn/lesson.h"
#include "libslam/learn/recipes.h"

namespace slam::learn {

/// What became of an answer.
enum class Finding {
  kRight,
  kWrong,     ///< an answer, and not the right one
  kUnusable,  ///< none that could be right or wrong: missing, not a number, another student's
  kCrashed    ///< a program of the student's ended with an error
};
/// "right", "wrong", "unusable", "crashed".
std::string findingName(Finding finding);

struct Verdict {
  Finding finding = Finding::kUnusable;
  std::string
      kind;  ///< which: "right", "missing", "not_a_number", "other_student", the name of a hint, "wrong"
  std::string found;  ///< the answer, for people
  std::string said;   ///< why, and what to do next; never the right answer
};

/// What is to be checked.
struct AnswerRequest {
  std::string answer;         ///< a student's folder, or a number
  std::uint64_t student = 0;  ///< 0: as the folder says
  std::string program;        ///< rasterslam, for hints
};

/// Checks an answer by making the student's material anew: so the folder can change nothing but the answer.
/// Number: the word, or answer.txt of the folder, to the lesson's tolerance; of a wrong one the nearest hint,
/// else whether it is a neighbour's. Method: the folder's external method on a drive in the student's
/// building that the student does not have. Strategy: the program of the folder in another building of that
/// kind. Sweep: the folder `fair` and the word in answer.txt. Whatever is wrong with the answer is a Verdict.
/// Errors: InputError where it is not known whose answer it is (a number without a student, a folder that
/// startLesson() did not make); IoError; Interrupted.
Verdict checkAnswer(const Lesson& lesson, const AnswerRequest& request, core::Progress& progress);

/// Of a number, against figures: no file is read. `others` are the figures of other students.
Verdict judgeNumber(const Lesson& lesson, double found, const Figures& figures);

// The kinds of answer that are folders; `folder` is the student's.
Verdict checkMethod(const Lesson& lesson, std::uint64_t student, const std::string& folder,
                    core::Progress& progress);
Verdict checkStrategy(const Lesson& lesson, std::uint64_t student, const std::string& folder,
                      core::Progress& progress);
Verdict checkSweep(const Lesson& lesson, std::uint64_t student, const std::string& folder,
                   core::Progress& progress);

/// A verdict by a hint of the lesson.
Verdict hinted(const Lesson& lesson, Finding finding, const std::string& hint, const std::string& found = "");

}  // namespace slam::learn

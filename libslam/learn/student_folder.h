#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "libslam/core/progress.h"
#include "libslam/learn/lesson.h"
#include "libslam/learn/recipes.h"

namespace slam::learn {

/// Files of a student's folder.
inline constexpr const char* kLessonFile = "lesson.ini";  ///< whose it is, and of which lesson
inline constexpr const char* kTaskFile = "TASK.md";
inline constexpr const char* kAnswerFile = "answer.txt";

/// Makes the student's own folder for a lesson: the material (recipe), TASK.md with the question, lesson.ini.
/// It appears whole or not at all; what is there is never replaced, as it may hold an answer. Errors:
/// InputError for a folder that exists.
void startLesson(const Lesson& lesson, std::uint64_t student, const std::string& output,
                 core::Progress& progress);

/// The question with the student's figures put in.
std::string questionText(const Lesson& lesson, const Figures& figures);

/// What lesson.ini of a student's folder says.
struct StudentFolder {
  int lesson = 0;
  std::uint64_t student = 0;
  std::string version;                       ///< of the program that made it
  std::map<std::string, std::string> files;  ///< of the material: name -> SHA-256 when it was made
};
/// nullopt where the folder has no lesson.ini. Errors: InputError for a broken one.
std::optional<StudentFolder> readStudentFolder(const std::string& folder);

/// SHA-256 of every file of a material that is the same whenever it is made.
std::map<std::string, std::string> materialHashes(const std::string& folder);

}  // namespace slam::learn

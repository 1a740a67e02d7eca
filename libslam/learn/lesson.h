#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"

namespace slam::learn {

/// Section [lesson] of configs/lessons/NAME.ini.
struct LessonOptions {
  int number, minutes;
  std::string title, needs, question, unit, recipe;
  std::string answer;         ///< number | method | strategy | sweep
  double tolerance;           ///< of a number, in its unit
  double relative_tolerance;  ///< the same as a share of the right number; the larger one counts
  std::string wrong;          ///< said of a wrong answer that no hint knows
  LessonOptions();
  static const files::ParameterTable<LessonOptions>& table();
};

/// A wrong answer that is known, of a section [hint NAME].
struct Hint {
  std::string name;    ///< "cells"
  std::string figure;  ///< of the student's material (see Figures), "" for what is found otherwise
  double times = 1;    ///< the wrong answer is so many times that figure
  std::string say;     ///< what is wrong with the way that leads there; never the right answer
};

/// One lesson: its page, its question, what each student gets, which wrong answers are known. Nothing of a
/// single lesson stands in the code but what makes its material (recipes.h).
struct Lesson {
  std::string name;  ///< "01-lidar": of its .ini, and of its page NAME.md in pagesFolder()
  LessonOptions options;
  std::vector<Hint> hints;
  files::IniFile ini;  ///< the rest is for the recipe
};

/// All lessons in the order of their numbers. Errors: InputError with file and line for what is wrong in one
/// of them; two of one number; numbers that do not count from 1 on.
std::vector<Lesson> readLessons(const std::string& folder);
/// Those that come with the program.
std::vector<Lesson> readLessons();
/// The folder of their pages: docs/learn, or learn/ of the data that comes with the program.
std::string pagesFolder();
/// By number, or by the name in full. Errors: InputError with what there is.
const Lesson& findLesson(const std::vector<Lesson>& lessons, const std::string& word);

/// The hint of that name; a ContractError where the lesson has none.
const Hint& hintOf(const Lesson& lesson, const std::string& name);

/// Each student's seed in each lesson: another building, another answer.
std::uint64_t seedOf(const Lesson& lesson, std::uint64_t student);
/// What a student's number may be. Errors: InputError where `word` is none.
std::uint64_t parseStudent(const std::string& word, const std::string& where);

}  // namespace slam::learn

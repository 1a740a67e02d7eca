#pragma once
#include <string>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/learn/check_answer.h"
#include "libslam/table/table.h"

namespace slam::learn {

/// One folder of a student, checked.
struct Grade {
  std::string folder;  ///< as given, or below one that was
  int lesson = 0;
  std::uint64_t student = 0;
  Verdict verdict;
};

/// Every folder of a student (lesson.ini) that is one of `folders` or lies in one, up to three deep, sorted
/// within each. Errors: InputError for a folder that is none, and for one in which there is no student's
/// folder.
std::vector<std::string> studentFolders(const std::vector<std::string>& folders);

/// Checks each of them. What is wrong with one, its lesson.ini included, is its row; the others go on. Two
/// rows of one student and lesson are both kept, and said so. Errors: Interrupted.
std::vector<Grade> grade(const std::vector<Lesson>& lessons, const std::vector<std::string>& folders,
                         core::Progress& progress);

/// One row per folder: student, lesson, title, finding, kind, found, said, folder.
table::Table gradeTable(const std::vector<Lesson>& lessons, const std::vector<Grade>& grades);
/// One row per student, one column per lesson ("right", the kind of what is wrong, or "-"), and how many are
/// right.
table::Table classTable(const std::vector<Lesson>& lessons, const std::vector<Grade>& grades);

}  // namespace slam::learn

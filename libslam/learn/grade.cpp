#include "libslam/learn/grade.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "libslam/core/error.h"
#include "libslam/learn/student_folder.h"

namespace slam::learn {
namespace fs = std::filesystem;
namespace {

constexpr int kDeepest = 3;

bool isStudents(const fs::path& folder) {
  return fs::exists(folder / kLessonFile);
}

void gather(const fs::path& folder, int depth, std::vector<std::string>& found) {
  if (isStudents(folder)) {
    found.push_back(folder.string());
    return;
  }
  if (depth == kDeepest) return;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_directory() && !entry.is_symlink()) gather(entry.path(), depth + 1, found);
}

Grade gradeOne(const std::vector<Lesson>& lessons, const std::string& folder, core::Progress& progress) {
  Grade grade;
  grade.folder = folder;
  try {
    const auto read = readStudentFolder(folder);
    grade.lesson = read->lesson, grade.student = read->student;
    AnswerRequest request;
    request.answer = folder;
    grade.verdict = checkAnswer(findLesson(lessons, std::to_string(read->lesson)), request, progress);
  } catch (const core::InputError& error) {
    grade.verdict = {Finding::kUnusable, "broken", "", error.what()};
  }
  return grade;
}

}  // namespace

std::vector<std::string> studentFolders(const std::vector<std::string>& folders) {
  std::vector<std::string> all;
  for (const auto& folder : folders) {
    if (!fs::is_directory(folder)) throw core::InputError(folder + ": no such folder");
    std::vector<std::string> found;
    gather(fs::path(folder).lexically_normal(), 0, found);
    if (found.empty())
      throw core::InputError(folder + ": found no " + kLessonFile +
                             " in it, expected folders that 'rasterslam learn start' made");
    std::sort(found.begin(), found.end());
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

std::vector<Grade> grade(const std::vector<Lesson>& lessons, const std::vector<std::string>& folders,
                         core::Progress& progress) {
  std::vector<Grade> grades;
  std::map<std::pair<std::uint64_t, int>, int> times;
  progress.begin("grading");
  for (const auto& folder : folders) {
    progress.update(static_cast<double>(grades.size()) / static_cast<double>(folders.size()), 0);
    grades.push_back(gradeOne(lessons, folder, core::silentProgress()));
    ++times[{grades.back().student, grades.back().lesson}];
  }
  progress.end();
  for (auto& one : grades)
    if (one.student != 0 && times[{one.student, one.lesson}] > 1)
      one.verdict.said +=
          (one.verdict.said.empty() ? "" : " ") + std::string("(Two folders of this student and lesson.)");
  return grades;
}

table::Table gradeTable(const std::vector<Lesson>& lessons, const std::vector<Grade>& grades) {
  table::Table table;
  table.columns = {{"student", "student", 0}, {"lesson", "lesson", 0}, {"title", "title"},
                   {"finding", "finding"},    {"kind", "kind"},        {"found", "found"},
                   {"said", "hint"},          {"folder", "folder"}};
  for (const auto& one : grades) {
    const bool is_known = one.lesson >= 1 && one.lesson <= static_cast<int>(lessons.size());
    table.rows.push_back({static_cast<double>(one.student), static_cast<double>(one.lesson),
                          is_known ? lessons[static_cast<std::size_t>(one.lesson - 1)].options.title : "",
                          findingName(one.verdict.finding), one.verdict.kind, one.verdict.found,
                          one.verdict.said, one.folder});
  }
  return table;
}

table::Table classTable(const std::vector<Lesson>& lessons, const std::vector<Grade>& grades) {
  table::Table table;
  table.caption = "Lessons by student";
  table.columns = {{"student", "student", 0}, {"right", "right", 0}};
  for (const auto& lesson : lessons)
    table.columns.push_back({lesson.name, std::to_string(lesson.options.number)});
  std::map<std::uint64_t, std::map<int, std::string>> by_student;
  for (const auto& one : grades) {
    auto& cell = by_student[one.student][one.lesson];
    if (cell != "right") cell = one.verdict.kind;
  }
  for (const auto& [student, cells] : by_student) {
    double right = 0;
    std::vector<table::CellValue> row = {static_cast<double>(student), 0.0};
    for (const auto& lesson : lessons) {
      const auto cell = cells.find(lesson.options.number);
      row.emplace_back(cell == cells.end() ? std::string("-") : cell->second);
      right += cell != cells.end() && cell->second == "right";
    }
    row[1] = right;
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace slam::learn

#include "libslam/learn/check_answer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/learn/student_folder.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/manifest.h"

namespace slam::learn {
namespace fs = std::filesystem;
namespace {

constexpr double kHintReach = 0.01;  // as a share: a wrong way is recognised where its number is rounded, too

double reachOf(const Lesson& lesson, double value, double times) {
  return std::max(lesson.options.tolerance * std::abs(times),
                  lesson.options.relative_tolerance * std::abs(value));
}

Figures figuresOf(const Lesson& lesson, std::uint64_t student, core::Progress& progress) {
  const files::ScratchFolder scratch;
  return recipeOf(lesson.options.recipe)({lesson, student, scratch.path(), progress});
}

bool isRight(const Lesson& lesson, double found, const Figures& figures) {
  const double answer = figures.at("answer");
  return std::abs(found - answer) <= reachOf(lesson, answer, 1);
}

Verdict unusable(const std::string& kind, const std::string& found, const std::string& said) {
  return {Finding::kUnusable, kind, found, said};
}

/// Why a word is no number, for the commonest reasons.
Verdict notANumber(const Lesson& lesson, const std::string& word) {
  std::string lower = word;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  const bool is_nan = lower.find("nan") != std::string::npos || lower.find("inf") != std::string::npos;
  const std::string shown = core::oneLine(word, 60);
  for (const auto& hint : lesson.hints)
    if (is_nan && hint.name == "underflow") return unusable("underflow", shown, hint.say);
  if (word.empty())
    return unusable("not_a_number", "",
                    std::string("The answer is empty. Write one number into ") + kAnswerFile + ".");
  std::string dotted = word;
  std::replace(dotted.begin(), dotted.end(), ',', '.');
  double number = 0;
  if (files::parseNumber(dotted, number))
    return unusable("not_a_number", shown, "Write the number with a point, not with a comma.");
  if (is_nan)
    return unusable("not_a_number", shown, "That is what a computer says to 0 / 0: look where you divide.");
  if (files::parseNumber(files::trimmed(word.substr(0, word.find_first_of(" \t"))), number))
    return unusable("not_a_number", shown, "Write the number alone, without a unit and without words.");
  return unusable("not_a_number", shown, "That is not a number. Write one number, such as 1.25.");
}

/// The files of the folder against those that this student gets; "" when they are the same.
std::optional<Verdict> judgeFiles(const StudentFolder& folder, const std::string& path,
                                  const std::string& made) {
  for (const auto& [name, hash] : materialHashes(made)) {
    const std::string file = path + "/" + name;
    if (fs::exists(file) && resources::fileSha256(file) == hash) continue;
    if (folder.version != resources::versionText())
      return unusable("other_version", name,
                      "The folder was made by rasterslam " + folder.version +
                          "; begin anew by 'rasterslam learn start'.");
    const auto given = folder.files.find(name);
    if (!fs::exists(file))
      return unusable("missing_material", name,
                      name + " is no longer in the folder; begin anew by 'rasterslam learn start'.");
    if (given == folder.files.end() || given->second != hash)
      return unusable("other_student", name,
                      "The material is not that of student " + std::to_string(folder.student) +
                          ": every student has another building. Begin with your own number.");
    return unusable("changed_material", name,
                    name +
                        " is not as it was handed out: changed, or another student's. Begin anew by "
                        "'rasterslam learn start'.");
  }
  return std::nullopt;
}

Verdict checkNumber(const Lesson& lesson, std::uint64_t student, const std::string& word,
                    const Figures& figures, core::Progress& progress) {
  double found = 0;
  if (!files::parseNumber(word, found)) return notANumber(lesson, word);
  auto verdict = judgeNumber(lesson, found, figures);
  if (verdict.kind != "wrong" || lesson.options.relative_tolerance + lesson.options.tolerance >= 0.1)
    return verdict;
  for (const std::uint64_t other : {student - 1, student + 1})
    if (other > 0 && isRight(lesson, found, figuresOf(lesson, other, progress)))
      return unusable("other_student", word,
                      "That is the number of student " + std::to_string(other) +
                          "'s building, not of student " + std::to_string(student) +
                          "'s: every student has another one.");
  return verdict;
}

/// Whose answer it is. Errors: InputError.
std::optional<Verdict> findStudent(const Lesson& lesson, const AnswerRequest& request,
                                   const StudentFolder& folder) {
  if (folder.lesson != lesson.options.number)
    return unusable("other_lesson", request.answer,
                    "The folder is of lesson " + std::to_string(folder.lesson) + ", not of lesson " +
                        std::to_string(lesson.options.number) + ".");
  if (request.student != 0 && request.student != folder.student)
    return unusable("other_student", request.answer,
                    "The folder is student " + std::to_string(folder.student) + "'s, not student " +
                        std::to_string(request.student) + "'s: every student has another building.");
  return std::nullopt;
}

Verdict checkFolder(const Lesson& lesson, const AnswerRequest& request, core::Progress& progress) {
  const auto folder = readStudentFolder(request.answer);
  if (!folder)
    throw core::InputError(request.answer + ": holds no " + kLessonFile +
                           ", expected a folder that 'rasterslam learn start " +
                           std::to_string(lesson.options.number) + " --student NUMBER -o FOLDER' made");
  if (const auto verdict = findStudent(lesson, request, *folder)) return *verdict;
  const files::ScratchFolder scratch;
  const auto figures = recipeOf(lesson.options.recipe)({lesson, folder->student, scratch.path(), progress});
  if (const auto verdict = judgeFiles(*folder, request.answer, scratch.path())) return *verdict;
  if (lesson.options.answer == "method")
    return checkMethod(lesson, folder->student, request.answer, progress);
  if (lesson.options.answer == "strategy")
    return checkStrategy(lesson, folder->student, request.answer, progress);
  if (lesson.options.answer == "sweep") return checkSweep(lesson, folder->student, request.answer, progress);
  const std::string path = request.answer + "/" + kAnswerFile;
  if (!fs::exists(path))
    return unusable("missing", "",
                    "There is no " + std::string(kAnswerFile) + " in " + request.answer +
                        ": write the number into it (the question stands in " + kTaskFile + ").");
  return checkNumber(lesson, folder->student, files::trimmed(files::readTextFile(path)), figures, progress);
}

}  // namespace

std::string findingName(Finding finding) {
  static constexpr const char* kNames[] = {"right", "wrong", "unusable", "crashed"};
  return kNames[static_cast<int>(finding)];
}

Verdict hinted(const Lesson& lesson, Finding finding, const std::string& hint, const std::string& found) {
  return {finding, hint, found, hintOf(lesson, hint).say};
}

Verdict judgeNumber(const Lesson& lesson, double found, const Figures& figures) {
  const std::string shown = files::formatNumber(found);
  if (isRight(lesson, found, figures)) return {Finding::kRight, "right", shown, ""};
  const Hint* nearest = nullptr;
  double least = 1;  // of the distance in reaches
  for (const auto& hint : lesson.hints) {
    const auto figure = figures.find(hint.figure.empty() ? "answer" : hint.figure);
    if (figure == figures.end()) continue;
    const double value = figure->second * hint.times;
    const double reach = std::max({reachOf(lesson, value, hint.times), kHintReach * std::abs(value), 1e-12});
    const double distance = std::abs(found - value) / reach;
    if (distance <= least && (!nearest || distance < least)) nearest = &hint, least = distance;
  }
  if (nearest) return {Finding::kWrong, nearest->name, shown, nearest->say};
  return {Finding::kWrong, "wrong", shown, lesson.options.wrong};
}

Verdict checkAnswer(const Lesson& lesson, const AnswerRequest& request, core::Progress& progress) {
  if (fs::is_directory(request.answer)) return checkFolder(lesson, request, progress);
  double number = 0;
  const bool is_number = files::parseNumber(request.answer, number);
  const bool is_path = request.answer.find('/') != std::string::npos || fs::exists(request.answer);
  if (lesson.options.answer != "number" || (!is_number && is_path))
    return unusable(
        "missing", request.answer,
        request.answer +
            ": no such folder; the answer is checked in the folder that 'rasterslam learn start " +
            std::to_string(lesson.options.number) + "' made.");
  AnswerRequest whose = request;
  if (whose.student == 0)
    if (const auto here = readStudentFolder("."); here && here->lesson == lesson.options.number)
      whose.student = here->student;
  if (whose.student == 0)
    throw core::InputError(
        "whose answer is it? Each student has another right one; expected --student NUMBER, or to be in the "
        "folder of 'learn start'");
  return checkNumber(lesson, whose.student, files::trimmed(request.answer),
                     figuresOf(lesson, whose.student, progress), progress);
}

}  // namespace slam::learn

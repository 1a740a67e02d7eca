#include "libslam/learn/student_folder.h"

#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/manifest.h"

namespace slam::learn {
namespace fs = std::filesystem;
namespace {

std::string taskText(const Lesson& lesson, std::uint64_t student, const Figures& figures,
                     const std::map<std::string, std::string>& files) {
  const std::string number = std::to_string(lesson.options.number);
  std::string text = "# Lesson " + number + ": " + lesson.options.title + "\n\nStudent " +
                     std::to_string(student) + "\n\n" + questionText(lesson, figures) + "\n\n";
  if (lesson.options.answer == "number")
    text += std::string("Write the number") +
            (lesson.options.unit.empty() ? "" : " (in " + lesson.options.unit + ", without the unit)") +
            " into " + kAnswerFile + " in this folder. ";
  text += "Then, from here: `rasterslam learn check " + number +
          " .`\n\nThe page of the lesson: `rasterslam learn " + number + "`\n\nYour files:";
  for (const auto& [name, hash] : files) text += " " + name;
  return text + "\n";
}

std::string lessonText(const Lesson& lesson, std::uint64_t student,
                       const std::map<std::string, std::string>& files) {
  std::string text = "# Whose folder this is; rasterslam learn check reads it.\n[lesson]\nnumber = " +
                     std::to_string(lesson.options.number) + "\nstudent = " + std::to_string(student) +
                     "\nversion = " + resources::versionText() + "\n\n[files]\n";
  for (const auto& [name, hash] : files) text += name + " = " + hash + "\n";
  return text;
}

}  // namespace

std::string questionText(const Lesson& lesson, const Figures& figures) {
  std::string text = lesson.options.question;
  for (const auto& [key, value] : figures) {
    if (key == "answer") continue;
    const std::string mark = "{" + key + "}";
    for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark))
      text.replace(at, mark.size(), files::formatNumber(value));
  }
  return text;
}

std::map<std::string, std::string> materialHashes(const std::string& folder) {
  std::map<std::string, std::string> hashes;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool has_times = name.find("manifest.json") != std::string::npos;
    if (entry.is_regular_file() && !has_times) hashes[name] = resources::fileSha256(entry.path().string());
  }
  return hashes;
}

void startLesson(const Lesson& lesson, std::uint64_t student, const std::string& output,
                 core::Progress& progress) {
  if (fs::exists(output))
    throw core::InputError(output + ": exists and may hold an answer, expected a new folder");
  files::PendingFolder folder(output, false);
  const auto figures = recipeOf(lesson.options.recipe)({lesson, student, folder.path(), progress});
  const auto files = materialHashes(folder.path());
  files::writeFileAtomically(folder.path() + "/" + kTaskFile, taskText(lesson, student, figures, files));
  files::writeFileAtomically(folder.path() + "/" + kLessonFile, lessonText(lesson, student, files));
  folder.commit();
}

std::optional<StudentFolder> readStudentFolder(const std::string& folder) {
  const std::string path = folder + "/" + kLessonFile;
  if (!fs::exists(path)) return std::nullopt;
  const auto ini = resources::readConfigFile(path);
  const auto value = [&](const std::string& key) {
    const auto* entry = ini.find("lesson", key);
    if (!entry) throw core::InputError(path + ": section [lesson]: key '" + key + "' is missing");
    return entry->value;
  };
  StudentFolder read;
  double number = 0;
  if (!files::parseNumber(value("number"), number))
    throw core::InputError(path + ": key 'number': found '" + value("number") +
                           "', expected a lesson's number");
  read.lesson = static_cast<int>(number);
  read.student = parseStudent(value("student"), path + ": key 'student'");
  read.version = value("version");
  if (const auto files = ini.sections().find("files"); files != ini.sections().end())
    for (const auto& [name, entry] : files->second) read.files[name] = entry.value;
  return read;
}

}  // namespace slam::learn

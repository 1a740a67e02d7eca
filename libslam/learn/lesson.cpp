#include "libslam/learn/lesson.h"

#include <algorithm>
#include <charconv>

#include "libslam/core/error.h"
#include "libslam/resources/data_folder.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/manifest.h"
#include "libslam/resources/resources.h"

namespace slam::learn {
namespace {

constexpr std::uint64_t kMostStudents = 1000000, kSeedsPerStudent = 100;
const std::string kHint = "hint ";

Hint readHint(const files::IniFile& ini, const std::string& section) {
  Hint hint;
  hint.name = section.substr(kHint.size());
  for (const auto& [key, entry] : ini.sections().at(section)) {
    const bool is_number = key == "times" && files::parseNumber(entry.value, hint.times);
    if (key == "of")
      hint.figure = entry.value;
    else if (key == "say")
      hint.say = entry.value;
    else if (!is_number)
      throw core::InputError(entry.origin + ": section [" + section + "]: found '" + key + " = " +
                             entry.value + "', expected of, times (a number) or say");
  }
  if (hint.say.empty()) throw core::InputError("section [" + section + "]: key 'say' is missing");
  return hint;
}

Lesson readLesson(const std::string& folder, const std::string& name) {
  Lesson lesson;
  lesson.name = name;
  lesson.ini = resources::readConfigFile(folder + "/" + name + ".ini");
  files::readParameters(lesson.ini, LessonOptions::table(), lesson.options);
  for (const auto& [section, entries] : lesson.ini.sections())
    if (section.compare(0, kHint.size(), kHint) == 0) lesson.hints.push_back(readHint(lesson.ini, section));
  return lesson;
}

}  // namespace

const files::ParameterTable<LessonOptions>& LessonOptions::table() {
  using O = LessonOptions;
  static const files::ParameterTable<O> rows(
      "lesson", {{"number", &O::number, 0, 0, 1000, "counts from 1"},
                 {"minutes", &O::minutes, 15, 1, 600, "for a student"},
                 {"title", &O::title, "", {}, "of the lesson"},
                 {"needs", &O::needs, "", {}, "what a student has to know before"},
                 {"question", &O::question, "", {}, "in one paragraph; {figure} is put in from the material"},
                 {"answer", &O::answer, "number", {"number", "method", "strategy", "sweep"}, "what it is"},
                 {"unit", &O::unit, "", {}, "of a number"},
                 {"recipe", &O::recipe, "", {}, "what makes the material"},
                 {"tolerance", &O::tolerance, 0.0, 0.0, 1e9, "of a number, in its unit"},
                 {"relative_tolerance", &O::relative_tolerance, 0.0, 0.0, 1.0, "as a share of the right one"},
                 {"wrong", &O::wrong, "", {}, "said where no hint fits"}});
  return rows;
}

LessonOptions::LessonOptions() {
  table().setDefaults(*this);
}

std::vector<Lesson> readLessons(const std::string& folder) {
  std::vector<Lesson> lessons;
  for (const auto& name : resources::namesInFolder(folder, ".ini"))
    lessons.push_back(readLesson(folder, name));
  std::sort(lessons.begin(), lessons.end(),
            [](const Lesson& a, const Lesson& b) { return a.options.number < b.options.number; });
  for (std::size_t i = 0; i < lessons.size(); ++i)
    if (lessons[i].options.number != static_cast<int>(i + 1))
      throw core::InputError(folder + "/" + lessons[i].name + ".ini: found lesson number " +
                             std::to_string(lessons[i].options.number) + ", expected " +
                             std::to_string(i + 1));
  return lessons;
}

std::vector<Lesson> readLessons() {
  return readLessons(resources::configsFolder() + "/lessons");
}

std::string pagesFolder() {
  return resources::findData(resources::dataPlaces(), resources::versionText()).lessons;
}

const Lesson& findLesson(const std::vector<Lesson>& lessons, const std::string& word) {
  for (const auto& lesson : lessons)
    if (word == std::to_string(lesson.options.number) || word == lesson.name) return lesson;
  throw core::InputError("lesson: found '" + word + "', expected a number from 1 to " +
                         std::to_string(lessons.size()) + "; 'rasterslam learn' lists them");
}

const Hint& hintOf(const Lesson& lesson, const std::string& name) {
  for (const auto& hint : lesson.hints)
    if (hint.name == name) return hint;
  throw core::ContractError("lesson " + lesson.name + " has no [hint " + name + "]");
}

std::uint64_t seedOf(const Lesson& lesson, std::uint64_t student) {
  return student * kSeedsPerStudent + static_cast<std::uint64_t>(lesson.options.number);
}

std::uint64_t parseStudent(const std::string& word, const std::string& where) {
  std::uint64_t student = 0;
  const auto read = std::from_chars(word.data(), word.data() + word.size(), student);
  if (read.ec != std::errc() || read.ptr != word.data() + word.size() || student < 1 ||
      student > kMostStudents)
    throw core::InputError(where + ": found '" + word + "', expected a student's number from 1 to " +
                           std::to_string(kMostStudents));
  return student;
}

}  // namespace slam::learn

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/console.h"
#include "apps/lessons.h"
#include "apps/quiet.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/learn/grade.h"
#include "libslam/learn/student_folder.h"
#include "libslam/learn/terminal_page.h"
#include "libslam/resources/resources.h"

namespace slam::apps {
namespace {

constexpr std::size_t kWidest = 80;

struct LearnArguments {
  std::string lesson, student, answer;
  std::vector<std::string> folders;
};

std::size_t pageWidth() {
  return std::min(terminalWidth(), kWidest);
}

int listLessons(const Context& context, const std::vector<learn::Lesson>& lessons) {
  if (context.json) {
    auto json = nlohmann::ordered_json::array();
    for (const auto& lesson : lessons)
      json.push_back({{"number", lesson.options.number},
                      {"name", lesson.name},
                      {"title", lesson.options.title},
                      {"minutes", lesson.options.minutes},
                      {"needs", lesson.options.needs},
                      {"answer", lesson.options.answer}});
    std::cout << json.dump(2) << "\n";
    return 0;
  }
  for (const auto& lesson : lessons)
    std::printf("%2d  %-46s %2d min  answer: a %s\n", lesson.options.number, lesson.options.title.c_str(),
                lesson.options.minutes, lesson.options.answer.c_str());
  std::printf("next: rasterslam learn 1; rasterslam learn start 1 --student NUMBER -o lesson1\n");
  return 0;
}

int showLesson(const Context& context, const learn::Lesson& lesson) {
  const std::string folder = learn::pagesFolder(), path = folder + "/" + lesson.name + ".md";
  const std::string markdown = files::readTextFile(path);
  if (context.json)
    std::cout << nlohmann::ordered_json{{"lesson", lesson.name}, {"file", path}, {"markdown", markdown}}.dump(
                     2)
              << "\n";
  else
    std::cout << learn::terminalPage(markdown, folder, pageWidth());
  return 0;
}

int learnLesson(const Context& context, const LearnArguments& arguments) {
  const auto lessons = learn::readLessons();
  if (arguments.lesson.empty()) return listLessons(context, lessons);
  return showLesson(context, learn::findLesson(lessons, arguments.lesson));
}

int startLesson(const Context& context, const LearnArguments& arguments) {
  const auto lessons = learn::readLessons();
  const auto& lesson = learn::findLesson(lessons, arguments.lesson);
  const auto student = learn::parseStudent(arguments.student, "--student");
  const std::string folder =
      context.output.empty() ? "lesson" + std::to_string(lesson.options.number) : context.output;
  learn::startLesson(lesson, student, folder, core::silentProgress());
  if (context.json)
    std::cout
        << nlohmann::ordered_json{{"folder", folder}, {"lesson", lesson.name}, {"student", student}}.dump(2)
        << "\n";
  else
    std::cout << learn::terminalPage(files::readTextFile(folder + "/" + learn::kTaskFile), folder,
                                     pageWidth());
  return 0;
}

core::ExitCode exitCode(learn::Finding finding) {
  switch (finding) {
    case learn::Finding::kRight:
      return core::ExitCode::kOk;
    case learn::Finding::kWrong:
      return core::ExitCode::kGotWorse;
    case learn::Finding::kCrashed:
      return core::ExitCode::kMethodFailed;
    default:
      return core::ExitCode::kBadInput;
  }
}

int checkLesson(const Context& context, const LearnArguments& arguments) {
  const auto lessons = learn::readLessons();
  const auto& lesson = learn::findLesson(lessons, arguments.lesson);
  learn::AnswerRequest request;
  request.answer = arguments.answer;
  if (!arguments.student.empty()) request.student = learn::parseStudent(arguments.student, "--student");
  ConsoleProgress progress(true);
  const auto verdict = learn::checkAnswer(lesson, request, progress);
  if (context.json) {
    std::cout << nlohmann::ordered_json{{"lesson", lesson.options.number},
                                        {"finding", learn::findingName(verdict.finding)},
                                        {"kind", verdict.kind},
                                        {"found", verdict.found},
                                        {"said", verdict.said}}
                     .dump(2)
              << "\n";
  } else {
    const bool is_right = verdict.finding == learn::Finding::kRight;
    std::printf("lesson %d: %s%s%s\n", lesson.options.number, is_right ? "right" : "not right",
                verdict.found.empty() ? "" : ": ", verdict.found.c_str());
    if (!is_right) std::cout << learn::wrappedText(verdict.said, pageWidth(), "", "");
  }
  return static_cast<int>(exitCode(verdict.finding));
}

int gradeFolders(const Context& context, const LearnArguments& arguments) {
  if (!context.output.empty()) files::refuseToOverwrite(context.output, context.overwrite);
  const auto lessons = learn::readLessons();
  const auto folders = learn::studentFolders(arguments.folders);
  ConsoleProgress progress(context.quiet);
  const auto grades = learn::grade(lessons, folders, progress);
  const auto table = learn::gradeTable(lessons, grades);
  if (!context.output.empty()) files::writeFileAtomically(context.output, table::toCsv(table));
  if (context.json)
    std::cout << table::toJson(table) << "\n";
  else
    std::cout << tableText(learn::classTable(lessons, grades));
  if (!context.json && !context.output.empty())
    std::printf("every answer, and why it is wrong: %s\n", context.output.c_str());
  return 0;
}

void addStudent(CLI::App* command, LearnArguments& arguments) {
  command->add_option("--student", arguments.student,
                      "the student's number, from 1: each has another building");
}

void addStart(CLI::App& learn, Context& context, const std::shared_ptr<LearnArguments>& arguments) {
  auto* command = learn.add_subcommand("start", "make a student's own folder for a lesson");
  command->add_option("lesson", arguments->lesson, "its number")->required();
  addStudent(command, *arguments);
  command->get_option("--student")->required();
  command->add_option("-o,--output", context.output, "folder to write (default lessonN)");
  addQuiet(command, context);
  addJson(command, context);
  command->footer(
      "The folder holds the material and the question (TASK.md). One that is there is never replaced.\n"
      "Example:\n  rasterslam learn start 3 --student 17 -o lesson3");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return startLesson(context, *arguments); };
  });
}

void addLessonCheck(CLI::App& learn, Context& context, const std::shared_ptr<LearnArguments>& arguments) {
  auto* command = learn.add_subcommand("check", "is an answer right, and if not, why?");
  command->add_option("lesson", arguments->lesson, "its number")->required();
  command
      ->add_option("answer", arguments->answer,
                   "the student's folder (with answer.txt, a method, ...), or a number")
      ->required();
  addStudent(command, *arguments);
  addJson(command, context);
  command->footer(
      "It makes the student's material anew, so that nothing in the folder but the answer counts. Programs "
      "of\n"
      "the student's are run as they are, under limits of time and memory, and not in a sandbox.\n"
      "Exit codes: 0 right; 3 no answer that could be right (missing, not a number, another student's);\n"
      "4 a program of the student's ended with an error; 5 wrong.\n"
      "Examples:\n"
      "  rasterslam learn check 3 lesson3\n"
      "  rasterslam learn check 1 2.47 --student 17\n"
      "  rasterslam learn check 2 --student 17 -- -1.5     # a negative number");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return checkLesson(context, *arguments); };
  });
}

void addGrade(CLI::App& learn, Context& context, const std::shared_ptr<LearnArguments>& arguments) {
  auto* command = learn.add_subcommand("grade", "check many students' folders: one table");
  command->add_option("folders", arguments->folders, "students' folders, or folders that hold some")
      ->required();
  addOutput(command, context, "the CSV to write: a row per folder");
  addJson(command, context);
  command->footer(
      "What is wrong with one folder is its row; the others go on. Exit code 0 when all were looked at.\n"
      "Example:\n  rasterslam learn grade handed_in -o grades.csv");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return gradeFolders(context, *arguments); };
  });
}

}  // namespace

void addLearn(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("learn", "ten lessons in mobile robotics that check the answer");
  auto arguments = std::make_shared<LearnArguments>();
  command->add_option("lesson", arguments->lesson, "its number: prints its page; without: the list");
  addJson(command, context);
  command->require_subcommand(0, 1);
  addStart(*command, context, arguments);
  addLessonCheck(*command, context, arguments);
  addGrade(*command, context, arguments);
  command->footer(
      "Each lesson is a page, a question whose answer is checked, and three exercises. A student's number\n"
      "gives each student another building and another right answer.\n"
      "Examples:\n"
      "  rasterslam learn                                  # the list\n"
      "  rasterslam learn 3                                # the page\n"
      "  rasterslam learn start 3 --student 17 -o lesson3  # the student's own material\n"
      "  rasterslam learn check 3 lesson3                  # right? if not, why?\n"
      "  rasterslam learn grade handed_in -o grades.csv    # for the teacher");
  command->callback([&context, command, arguments] {
    if (command->get_subcommands().empty())
      context.action = [&context, arguments] { return learnLesson(context, *arguments); };
  });
}

}  // namespace slam::apps

#include "apps/program.h"

#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <string>
#include <vector>

#include "apps/console.h"
#include "apps/printed_text.h"
#include "apps/quiet.h"
#include "apps/stream_output.h"
#include "libslam/core/error.h"
#include "libslam/process/exit_code.h"
#include "libslam/process/worker.h"
#include "libslam/resources/manifest.h"

namespace slam::apps {
namespace {

using core::ExitCode;

/// Started by another process of ours, which this one ends with.
bool is_worker = false;

int code(ExitCode exit_code) {
  return static_cast<int>(exit_code);
}

/// One line on standard error; with --json also an object on standard output, for the program that called us.
/// `is_machine`: a file could not be written, which no method is to blame for.
int report(const Context& context, const std::string& message, ExitCode exit_code, bool is_machine = false) {
  // Who started this one is interrupted with it, and says so.
  if (!is_worker || exit_code != ExitCode::kInterrupted)
    std::fprintf(stderr, "rasterslam: %s\n", message.c_str());
  if (context.json) {
    nlohmann::json said{{"error", message}, {"exit_code", code(exit_code)}};
    if (is_machine) said["machine"] = true;
    std::cout << said.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  }
  return code(exit_code);
}

/// The names of a command's own subcommands.
std::vector<std::string> subcommandNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const auto* subcommand : command.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(subcommand->get_name());
  return names;
}

/// The flags that a command takes, as they are typed.
std::vector<std::string> flagNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const auto* option : command.get_options()) {
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
    for (const auto& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

/// What is wrong with a command line that CLI11 refused, in one line: a word that is none of ours with the
/// nearest that is, or what CLI11 says.
std::string usageError(const CLI::App& app, const std::vector<std::string>& command_line,
                       const char* otherwise) {
  const CLI::App* command = &app;
  std::string said = std::filesystem::path(command_line.front()).filename().string();
  const auto line = [&](const std::string& what) { return what + " (see '" + said + " --help')"; };
  for (std::size_t i = 1; i < command_line.size() && command_line[i] != "--"; ++i) {
    const std::string& word = command_line[i];
    if (word.size() > 2 && word.compare(0, 2, "--") == 0) {
      const std::string flag = word.substr(0, word.find('='));
      const auto known = flagNames(*command);
      if (std::find(known.begin(), known.end(), flag) == known.end())
        return line("unknown option '" + flag + "'" + core::didYouMean(flag, known));
      continue;
    }
    const auto known = subcommandNames(*command);
    if (known.empty() || word.empty() || word[0] == '-') continue;
    if (std::find(known.begin(), known.end(), word) != known.end()) {
      command = command->get_subcommand(word);
      said += " " + word;
    } else if (command->get_require_subcommand_min() > 0) {
      return line("unknown command '" + word + "'" + core::didYouMean(word, known));
    }
  }
  return line(otherwise);
}

/// Whether words name a command, and a command of that, as far as there are words. What follows a command
/// that hands its words on (`view`) is for another program to judge.
bool isCommand(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* command = &app;
  for (const auto& word : words) {
    if (command->get_prefix_command()) return true;
    const auto known = subcommandNames(*command);
    if (std::find(known.begin(), known.end(), word) == known.end()) return false;
    command = command->get_subcommand(word);
  }
  return true;
}

/// `help COMMAND` is `COMMAND --help`.
std::vector<std::string> withoutHelpWord(std::vector<std::string> command_line) {
  if (command_line.size() < 2 || command_line[1] != "help") return command_line;
  command_line.erase(command_line.begin() + 1);
  command_line.emplace_back("--help");
  return command_line;
}

/// How to go on with what was interrupted; "" where the command cannot.
std::string resumeText(const CLI::App& app, const std::vector<std::string>& command_line) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  if (command->get_option_no_throw("--resume") == nullptr) return "";
  std::vector<std::string> words;
  for (const auto& word : command_line)
    if (word != "--overwrite" && word != "--resume") words.push_back(word);
  words.front() = std::filesystem::path(words.front()).filename().string();
  words.emplace_back("--resume");
  return "; go on with: " + resources::shellQuoted(words);
}

/// What was printed has to arrive: a full disk behind standard output is a failure like any other.
int flushed(int exit_code) {
  if (flushPrintedText()) return exit_code;
  std::fprintf(stderr, "rasterslam: standard output: cannot be written: %s\n", std::strerror(errno));
  return exit_code == 0 ? code(ExitCode::kFailed) : exit_code;
}

/// A process that another of ours started, and that measures this one, ends with it, whatever ends that.
void endWithParent() {
  const char* parent = std::getenv(process::kParentVariable);
  if (parent == nullptr) return;
  is_worker = true;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (std::to_string(getppid()) != parent) std::_Exit(code(ExitCode::kInterrupted));
  unsetenv(process::kParentVariable);
}

/// Where an exception cannot go on, as from a destructor of a library that finds no memory.
[[noreturn]] void endAtOnce() {
  std::string reason = "an exception that nobody can take";
  try {
    if (const auto exception = std::current_exception()) std::rethrow_exception(exception);
  } catch (const std::bad_alloc&) {
    reason = "out of memory";
  } catch (const std::exception& error) {
    reason = core::oneLine(error.what());
  } catch (...) {  // it says nothing
  }
  std::fprintf(stderr, "rasterslam: %s\n", reason.c_str());
  std::_Exit(code(ExitCode::kFailed));
}

int doCommand(CLI::App& app, Context& context, const std::vector<std::string>& command_line) {
  try {
    return withStreamedOutput(app, context);
  } catch (const std::bad_alloc&) {
    return report(context, "out of memory", ExitCode::kFailed);
  } catch (const core::Interrupted& error) {
    return report(context, error.what() + resumeText(app, command_line), ExitCode::kInterrupted);
  } catch (const core::IoError& error) {
    return report(context, core::oneLine(error.what()), ExitCode::kFailed, true);
  } catch (const std::exception& error) {
    return report(context, core::oneLine(error.what()), process::exitCodeOf(error));
  }
}

}  // namespace

int runProgram(CLI::App& app, Context& context) {
  const auto command_line = withoutHelpWord(context.command_line);
  const bool asks_help = command_line != context.command_line;
  if (asks_help && !isCommand(app, {command_line.begin() + 1, command_line.end() - 1}))
    return report(context, core::oneLine(usageError(app, command_line, "help: expected a command")),
                  ExitCode::kUsage);
  std::vector<const char*> argv;
  argv.reserve(command_line.size());
  for (const auto& word : command_line) argv.push_back(word.c_str());
  std::set_terminate(endAtOnce);
  printText();
  catchInterrupts();
  endWithParent();
  cv::setUseOptimized(false);  // which picks other instructions, and so other last bits, on other processors
  try {
    app.parse(static_cast<int>(argv.size()), argv.data());
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return flushed(app.exit(error));  // --help, --version
    return report(context, core::oneLine(usageError(app, command_line, error.what())), ExitCode::kUsage);
  }
  muteOutput(context);
  return flushed(doCommand(app, context, command_line));
}

}  // namespace slam::apps

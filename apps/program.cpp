#include "apps/program.h"

#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <nlohmann/json.hpp>

#include "apps/console.h"
#include "libslam/core/exit_code.h"

namespace slam::apps {
namespace {

using core::ExitCode;

int code(ExitCode exit_code) {
  return static_cast<int>(exit_code);
}

/// One line on standard error; with --json also an object on standard output, for the program that called us.
int report(const Context& context, const char* message, ExitCode exit_code) {
  std::fprintf(stderr, "rasterslam: %s\n", message);
  if (context.json)
    std::cout << nlohmann::json{{"error", message}, {"exit_code", code(exit_code)}}.dump(
                     -1, ' ', false, nlohmann::json::error_handler_t::replace)
              << "\n";
  return code(exit_code);
}

}  // namespace

int runProgram(CLI::App& app, Context& context) {
  std::vector<const char*> argv;
  for (const auto& word : context.command_line) argv.push_back(word.c_str());
  try {
    app.parse(static_cast<int>(argv.size()), argv.data());
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? code(ExitCode::kOk) : code(ExitCode::kUsage);
  }
  catchInterrupts();
  try {
    return context.action();
  } catch (const std::bad_alloc&) {
    return report(context, "out of memory", ExitCode::kFailed);
  } catch (const std::exception& error) {
    return report(context, error.what(), core::exitCodeOf(error));
  }
}

}  // namespace slam::apps

#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/help_text.h"
#include "apps/lessons.h"
#include "apps/quiet.h"
#include "libslam/learn/template_folder.h"

namespace slam::apps {
namespace {

int makeNew(const Context& context, learn::TemplateRequest& request) {
  request.output = context.output;
  request.library = learn::libraryFolder(resources::dataPlaces());
  const auto made = learn::makeFromTemplate(request);
  if (context.json) {
    std::cout
        << nlohmann::ordered_json{{"folder", made.path}, {"files", made.files}, {"next", made.next}}.dump(2)
        << "\n";
    return 0;
  }
  std::printf("%s:", made.path.c_str());
  for (const auto& file : made.files) std::printf(" %s", file.c_str());
  std::printf("\nnext:\n");
  for (const auto& line : made.next) std::printf("  %s\n", line.c_str());
  std::printf("what to edit: %s/README.md\n", made.path.c_str());
  return 0;
}

}  // namespace

void addNew(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("new", "a folder to begin a method, strategy, navigator or plugin from");
  auto request = std::make_shared<learn::TemplateRequest>();
  command->add_option("kind", request->kind, "method | strategy | navigator | plugin")
      ->required()
      ->check(oneOf({"method", "strategy", "navigator", "plugin"}));
  command->add_option("name", request->name, "its name: small letters, digits and _")->required();
  command->add_option(
      "--language", request->language,
      "python or cpp for a method, cpp for a strategy or navigator, sh or python for a plugin "
      "(default: the first)");
  command->add_option("-o,--output", context.output, "folder to write (default: the name)");
  addQuiet(command, context);
  addJson(command, context);
  command->footer(
      "The folder builds, runs and passes its own test as it is; README.md says what to edit next. What is\n"
      "in C++ builds against the library that came with this program: installed, or built by\n"
      "./bootstrap.sh build. A folder that is there is never replaced.\n"
      "  method      a log in, a pose per scan out: run, compare, bench and contest take its .ini\n"
      "  plugin      the same around a program that you have already\n"
      "  strategy    where to go next, from the map; a program with the closed loop in it\n"
      "  navigator   how to get to a goal; likewise\n"
      "Examples:\n"
      "  rasterslam new method my_slam\n"
      "  rasterslam new method my_slam --language cpp -o work/my_slam\n"
      "  rasterslam new strategy my_explorer");
  command->callback(
      [&context, request] { context.action = [&context, request] { return makeNew(context, *request); }; });
}

}  // namespace slam::apps

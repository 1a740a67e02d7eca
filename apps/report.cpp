#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/pages/report_data.h"
#include "libslam/report/html_report.h"

namespace slam::apps {
namespace {

int writeReport(const Context& context, const std::string& folder) {
  const std::string path = context.output.empty() ? "report.html" : context.output;
  const auto extension = std::filesystem::path(path).extension();
  if (extension != ".html" && extension != ".htm")
    throw core::InputError("--output: found '" + path +
                           "', expected a name that ends with .html: a report is one " +
                           "HTML page; 'rasterslam plot' writes figures as PDF");
  files::refuseToOverwrite(path, context.overwrite);
  ConsoleProgress progress(context.quiet);
  const auto page = pages::gatherReport(folder, progress);
  const auto html = report::toHtml(page);
  files::writeFileAtomically(path, html);
  if (context.json)
    std::cout << nlohmann::json{{"file", path}, {"bytes", html.size()}, {"runs", page.runs.size()}}.dump(2)
              << "\n";
  else
    std::cout << path << "\n";
  return 0;
}

}  // namespace

void addReport(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand(
      "report", "one HTML file of a result: verdict, tables, maps, errors, replay; opens anywhere");
  auto folder = std::make_shared<std::string>();
  command->add_option("folder", *folder, "what compare, run, explore, navigate, bench, stress or tune wrote")
      ->required();
  addOutput(command, context, "the file to write (default report.html)");
  addJson(command, context);
  command->footer(
      "Example:\n  rasterslam compare office_loop -o out\n  rasterslam report out -o report.html\n"
      "The address report.html#t=83.2 opens the replay 83.2 s after the first scan, #replay=2&t=83.2 the "
      "second "
      "of several.");
  command->callback(
      [&context, folder] { context.action = [&context, folder] { return writeReport(context, *folder); }; });
}

}  // namespace slam::apps

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/console.h"
#include "apps/lessons.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/pages/report_data.h"
#include "libslam/resources/resources.h"
#include "libslam/study/contest.h"
#include "libslam/summary/sweep_merge.h"
#include "libslam/sweep/sweep.h"

namespace slam::apps {
namespace {

struct ContestArguments {
  study::ContestRequest request;
  int jobs = 1;
  bool resume = false;
};

void writeStandings(const study::Standings& standings, const std::string& folder) {
  const auto write = [&](const std::string& suffix, const std::string& text) {
    files::writeFileAtomically(folder + "/standings." + suffix, text);
  };
  write("csv", table::toCsv(standings.full));
  write("json", table::toJson(standings.full));
  write("txt", table::toText(standings.table));
  write("md", table::toMarkdown(standings.table));
  auto manifest = resources::readManifest(folder + "/manifest.json");
  manifest.files["standings.txt"] = "who stands where; also .md, .csv, .json";
  manifest.files["report.html"] = "the contest as a page";
  resources::writeManifest(manifest, folder + "/manifest.json");
}

int hold(const Context& context, ContestArguments& arguments) {
  auto& request = arguments.request;
  request.seed = context.seed;
  if (request.suite_path.empty()) request.suite_path = resources::configsFolder() + "/suites/contest.ini";
  const auto sweep = sweep::planSweep(study::contestSuite(request));
  sweep::SweepRequest how;
  how.output = context.output;
  how.program = context.programPath();
  how.jobs = arguments.jobs;
  how.resume = arguments.resume;
  how.overwrite = context.overwrite;
  ConsoleProgress progress(context.quiet), cell_progress(true);
  how.cell_progress = &cell_progress;
  const auto outcome = sweep::sweep(sweep, how, context.manifest(), progress);
  for (const auto& line : outcome.lost) std::cerr << "rasterslam: " << line << "\n";
  summary::MergeRequest whole;
  whole.folders = {context.output};
  whole.output = context.output;
  const auto merged = summary::mergeSweep(whole, context.manifest(), core::silentProgress());
  const auto standings = study::standingsOf(merged.plan, merged.results);
  writeStandings(standings, context.output);
  const std::string page = context.output + "/report.html";
  files::writeFileAtomically(page,
                             report::toHtml(pages::gatherReport(context.output, core::silentProgress())));
  if (context.json) {
    std::cout << nlohmann::ordered_json{{"folder", context.output},
                                        {"page", page},
                                        {"verdict", standings.verdict},
                                        {"standings",
                                         nlohmann::ordered_json::parse(table::toJson(standings.full))},
                                        {"missing", merged.missing}}
                     .dump(2)
              << "\n";
  } else {
    std::cout << tableText(standings.table) << "\n";
    for (const auto& sentence : standings.verdict) printWrapped("", sentence);
    std::cout << "page: " << page << "; every run: " << context.output << "/results.csv\n";
  }
  // An entry that fails is a row of the standings; only runs that are not there are a failure of the contest.
  return static_cast<int>(merged.missing.empty() ? core::ExitCode::kOk : core::ExitCode::kCellsFailed);
}

}  // namespace

void addContest(CLI::App& app, Context& context) {
  auto* command =
      app.add_subcommand("contest", "rank methods and plug-ins in buildings that none of them has seen");
  auto arguments = std::make_shared<ContestArguments>();
  auto& request = arguments->request;
  command->add_option("entries", request.entries, "methods by name, or .ini files (rasterslam new method)")
      ->required();
  command->add_option(
      "--suite", request.suite_path,
      "the ground: a suite whose methods and seeds are replaced (default: configs/suites/contest.ini)");
  command->add_option("--seeds", request.seeds, "drives in each building, with each kind of wheels")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("-j,--jobs", arguments->jobs, "runs side by side")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_flag("--resume", arguments->resume, "keep the runs that are complete");
  addSeed(command, context);
  addOutput(command, context, "folder to write");
  command->get_option("--output")->required();
  addJson(command, context);
  command->footer(
      "--seed draws the buildings and the drives: keep it to yourself until all entries are in.\n"
      "An entry that crashes, runs out of time or breaks its contract has failed that run, which ranks as\n"
      "worse than any other; the contest goes on. Writes standings.txt, .md, .csv, .json, report.html, and\n"
      "what 'bench' writes.\n"
      "Exit codes: 0 held, whoever failed; 3 bad input; 6 runs are missing (--resume).\n"
      "Examples:\n"
      "  rasterslam contest graph icp anna/anna.ini ben/ben.ini -o contest --seed 20261124 -j 2\n"
      "  rasterslam contest a/a.ini b/b.ini --suite mine.ini --seeds 10 -o final");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return hold(context, *arguments); };
  });
}

}  // namespace slam::apps

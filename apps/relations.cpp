#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/metrics/relation_error.h"

namespace slam::apps {
namespace {

struct RelationsArguments {
  std::string truth;
  double step_m = 1, near_m = 1, apart_s = 30;
};

int writeRelations(const Context& context, const RelationsArguments& arguments) {
  const auto truth = logs::readTrajectory(arguments.truth);
  const auto relations = metrics::relationsOf(truth, arguments.step_m, arguments.near_m, arguments.apart_s);
  if (relations.empty())
    throw core::InputError(arguments.truth + ": a path of " + std::to_string(core::pathLength(truth)) +
                           " m gives no relation, expected at least --step " +
                           std::to_string(arguments.step_m) + " m");
  const std::string file = context.output.empty() ? "truth.relations" : context.output;
  files::refuseToOverwrite(file, context.overwrite);
  logs::writeRelations(relations, file);
  std::size_t places_seen_again = 0;
  for (const auto& relation : relations)
    places_seen_again += relation.to_time_s - relation.from_time_s > arguments.apart_s ? 1 : 0;
  if (context.json)
    std::cout << nlohmann::ordered_json{{"file", file},
                                        {"relations", relations.size()},
                                        {"places_seen_again", places_seen_again}}
                     .dump(2)
              << "\n";
  else
    std::printf("%s: %zu relations along %.1f m, %zu of them between places seen again\n", file.c_str(),
                relations.size(), core::pathLength(truth), places_seen_again);
  return 0;
}

}  // namespace

void addRelations(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand(
      "relations",
      "write the relations that a true path gives: for 'eval --relations' and 'compare --relations'");
  auto arguments = std::make_shared<RelationsArguments>();
  command->add_option("truth", arguments->truth, "true path: TUM, or MRPT's .GT.txt")->required();
  command
      ->add_option("--step", arguments->step_m, "metres of path from one pose to the next that are related")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--near", arguments->near_m,
                   "relate such a pose also to the nearest earlier one within so many metres")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--apart", arguments->apart_s, "but only to one more than so many seconds before")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  addOutput(command, context, "file to write (default truth.relations)");
  addJson(command, context);
  command->footer(
      "Stamps and motions are written with 6 decimals (seconds, metres, radians).\n"
      "Examples:\n"
      "  rasterslam relations run.gt.tum -o run.relations\n"
      "  rasterslam relations run.gt.tum -o run.relations --step 0.5 --near 2 --apart 60");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return writeRelations(context, *arguments); };
  });
}

}  // namespace slam::apps

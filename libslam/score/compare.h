#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/files/ini.h"
#include "libslam/record/record.h"
#include "libslam/resources/manifest.h"
#include "libslam/score/evaluate.h"
#include "libslam/table/table.h"

namespace slam::score {

/// What to compare. Exactly one of plan_path and log_path is given.
struct CompareRequest {
  std::string plan_path;   ///< simulate a log in this plan first
  std::string log_path;    ///< or take this log
  std::string truth_path;  ///< "" = look beside the log (see findTruth())
  std::string
      truth_plan_path;  ///< plan to score maps on; "" = the simulated plan, or the one in the log's manifest
  /// Relations to score every path by; "" = none. Belongs to log_path. Errors: when none of them lies within
  /// the log's time.
  std::string relations_path;
  record::RecordConfig record;       ///< for plan_path
  std::vector<std::string> methods;  ///< names in configs/methods or paths of .ini files
  std::string methods_folder;
  /// "section.key=value", over every method that has such a section. Errors: one that none of them has.
  std::vector<std::string> method_settings;
  std::string output;  ///< folder
  std::uint64_t seed = 1;
  int threads = 1;  ///< methods run side by side
  /// The rasterslam program: each method then runs as `PROGRAM run METHOD LOG`, a process of its own, so that
  /// a crash or a runaway is its own row and its memory can be measured. "" runs them in this process,
  /// without figures of memory.
  std::string program;
  bool quiet = false;  ///< hand --quiet to those processes
  bool overwrite = false, resume = false;
};

struct Comparison {
  std::vector<Evaluation> evaluations;  ///< in the order of the request
  bool has_truth = false;
  table::Table accuracy;       ///< what fits 80 columns
  table::Table full_accuracy;  ///< all figures
  table::Table cost;
  std::optional<table::Table> relations, worst_relations;  ///< when relations were given
  std::string log_path;
  int failed = 0, reused = 0;
};

/// Simulates if asked, runs every method on the same log, scores, draws, and writes into `output`:
///   log/run.rawlog (and its truth)   when simulated
///   METHOD/                          one buildMap() folder per method, with difference.png where a plan is
///                                    known, and truth and plan in its map.3Dscene
///   scores.txt .md .tex              accuracy, the main figures
///   scores.csv .json                 accuracy, all figures; like the two above the same bytes for the same
///                                    seed, any number of threads
///   relations.txt .csv .json         with relations: the error of every path against them;
///                                    worst_relations.csv
///   cost.csv .json                   time and memory: differ from run to run
///   maps.png paths.png scan.png      pictures
///   manifest.json                    how to make it again
/// A method that fails gets a row that says so. An interrupt keeps the finished methods; `resume` reuses each
/// method folder whose log, configuration, seed and version are still the same.
Comparison compare(const CompareRequest& request, resources::Manifest manifest, core::Progress& progress);

}  // namespace slam::score

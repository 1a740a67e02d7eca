#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "libslam/sweep/sweep.h"

namespace slam::sweep {

/// A sweep for machines that others schedule.
struct SubmitRequest {
  std::string engine;                ///< parallel | slurm
  std::size_t tasks = 16;            ///< parts of the sweep; a part has many cells
  std::vector<std::string> options;  ///< of sbatch, one a line: "--partition=long"
};
/// Names for the command line.
const std::vector<std::string>& submitEngines();

/// Makes the sweep's folder (as sweep() does, on `sweep_request`, whose jobs are the cores of a task) and
/// writes into its folder submit/
///   parallel: tasks.txt (a shell line per task), submit.sh (runs them by GNU parallel, then merges)
///   slurm:    sweep.sbatch (a job array, a task may be killed and is tried three times), merge.sbatch (after
///             it, whatever became of it), submit.sh (hands both to sbatch, prints their job ids)
/// Each task is `rasterslam bench exec suite.ini --shard i/n`, so submitting again goes on where the last one
/// was. Returns the path of submit.sh. The program and the folder must be at the same absolute paths on every
/// machine. Errors: as sweep(); an unknown engine (InputError).
std::string writeSubmission(const Sweep& sweep, const SweepRequest& sweep_request,
                            const SubmitRequest& request, const resources::Manifest& manifest);

}  // namespace slam::sweep

#include "libslam/sweep/submit.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"

namespace slam::sweep {
namespace fs = std::filesystem;
namespace {

using Words = std::vector<std::string>;

struct Paths {
  std::string folder, submit;  ///< absolute
};

/// The command of one task but for its number.
Words execWords(const SweepRequest& request, const Paths& paths) {
  return {request.program, "bench", "exec", paths.folder + "/suite.ini",  "-o",
          paths.folder,    "-q",    "-j",   std::to_string(request.jobs), "--shard"};
}

std::string mergeLine(const SweepRequest& request, const Paths& paths) {
  return resources::shellQuoted({request.program, "bench", "merge", paths.folder});
}

std::string writeParallel(const SweepRequest& request, const SubmitRequest& submit, const Paths& paths) {
  std::string tasks;
  for (std::size_t i = 1; i <= submit.tasks; ++i) {
    auto words = execWords(request, paths);
    words.push_back(std::to_string(i) + "/" + std::to_string(submit.tasks));
    // 6: methods that failed are results.
    tasks += resources::shellQuoted(words) + " || [ $? -eq 6 ]\n";
  }
  files::writeFileAtomically(paths.submit + "/tasks.txt", tasks);
  return "#!/bin/sh\n"
         "# sh submit.sh [OPTIONS OF GNU PARALLEL, such as --jobs 8 or --sshloginfile HOSTS]\n"
         "parallel --retries 3 --joblog " +
         resources::shellQuoted({paths.submit + "/joblog.txt"}) + " \"$@\" < " +
         resources::shellQuoted({paths.submit + "/tasks.txt"}) + "\nexec " + mergeLine(request, paths) + "\n";
}

/// As Slurm's job names are, whatever the suite is called.
std::string jobName(std::string name) {
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && std::strchr("._-", c) == nullptr) c = '_';
  return name.substr(0, 100);
}

/// `#SBATCH` lines cannot quote everything, and what follows a line break would be a line of the shell.
void requireOneLine(const std::string& what, const std::string& text, const char* refused) {
  if (text.find_first_of(refused) != std::string::npos)
    throw core::InputError(what +
                           ": holds a line break, a quote or a backslash, which a Slurm script cannot hold");
}

std::string sbatchHead(const std::string& name, const std::string& log, const SubmitRequest& submit) {
  std::string text = "#!/bin/sh\n#SBATCH --job-name=" + jobName(name) + "\n#SBATCH --output=\"" + log +
                     "\"\n#SBATCH --open-mode=append\n#SBATCH --requeue\n";
  for (const auto& option : submit.options) text += "#SBATCH " + option + "\n";
  return text;
}

std::string writeSlurm(const Sweep& sweep, const SweepRequest& request, const SubmitRequest& submit,
                       const Paths& paths) {
  const std::string count = std::to_string(submit.tasks);
  files::writeFileAtomically(
      paths.submit + "/sweep.sbatch",
      sbatchHead(sweep.plan.name, paths.submit + "/task_%a.log", submit) + "#SBATCH --array=1-" + count +
          "\n#SBATCH --cpus-per-task=" + std::to_string(request.jobs) +
          "\n"
          "for attempt in 1 2 3; do\n"
          "  status=0\n  " +
          resources::shellQuoted(execWords(request, paths)) + " \"$SLURM_ARRAY_TASK_ID/" + count +
          "\" || status=$?\n"
          "  # 6: methods that failed are results; 2 and 3 would be the same again.\n"
          "  case $status in 0 | 6) exit 0 ;; 2 | 3) exit \"$status\" ;; esac\n"
          "  echo \"attempt $attempt ended with exit code $status\" >&2\n"
          "done\n"
          "exit \"$status\"\n");
  files::writeFileAtomically(paths.submit + "/merge.sbatch",
                             sbatchHead(sweep.plan.name + "-merge", paths.submit + "/merge.log", submit) +
                                 "exec " + mergeLine(request, paths) + "\n");
  return "#!/bin/sh\n"
         "set -e\n"
         "sweep=$(sbatch --parsable " +
         resources::shellQuoted({paths.submit + "/sweep.sbatch"}) +
         ")\n"
         "merge=$(sbatch --parsable --dependency=\"afterany:${sweep%%;*}\" " +
         resources::shellQuoted({paths.submit + "/merge.sbatch"}) +
         ")\n"
         "echo \"job array ${sweep%%;*} of " +
         count + " tasks, then merge job ${merge%%;*}\"\n";
}

}  // namespace

const std::vector<std::string>& submitEngines() {
  static const std::vector<std::string> engines = {"parallel", "slurm"};
  return engines;
}

std::string writeSubmission(const Sweep& sweep, const SweepRequest& sweep_request,
                            const SubmitRequest& request, const resources::Manifest& manifest) {
  const auto& engines = submitEngines();
  if (std::find(engines.begin(), engines.end(), request.engine) == engines.end())
    throw core::InputError("--engine: found '" + request.engine + "', expected parallel or slurm" +
                           core::didYouMean(request.engine, engines));
  Paths paths;
  paths.folder = fs::absolute(sweep_request.output).lexically_normal().string();
  paths.submit = paths.folder + "/submit";
  if (request.engine == "slurm") {
    requireOneLine("-o", paths.folder, "\n\r\"\\");
    for (const auto& option : request.options) requireOneLine("--option", option, "\n\r");
  }
  prepareSweepFolder(sweep, sweep_request, manifest);
  std::error_code error;
  fs::create_directories(paths.submit, error);
  if (error) throw core::IoError(paths.submit + ": cannot be made: " + error.message());
  std::string script = paths.submit + "/submit.sh";
  files::writeFileAtomically(script, request.engine == "parallel"
                                         ? writeParallel(sweep_request, request, paths)
                                         : writeSlurm(sweep, sweep_request, request, paths));
  return script;
}

}  // namespace slam::sweep

#include "libslam/explore/exploration_jobs.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <mutex>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/threads/thread_team.h"

namespace slam::explore {
namespace fs = std::filesystem;
namespace {

/// Progress of runs side by side as one bar.
class SharedProgress {
 public:
  SharedProgress(core::Progress& whole, size_t runs) : whole_(whole), runs_(runs) {}

  class OfOneRun : public core::Progress {
   public:
    explicit OfOneRun(SharedProgress& shared) : shared_(shared) {}
    void update(double fraction, double log_time_s) override {
      shared_.add(std::clamp(fraction, 0.0, 1.0) - fraction_, log_time_s - log_time_s_);
      fraction_ = std::clamp(fraction, 0.0, 1.0);
      log_time_s_ = log_time_s;
    }
    void finish() { shared_.add(1 - fraction_, 0); }

   private:
    SharedProgress& shared_;
    double fraction_ = 0, log_time_s_ = 0;
  };

 private:
  void add(double fraction, double log_time_s) {
    double done = 0, time_s = 0;
    {
      const std::lock_guard lock(mutex_);
      done = done_ += fraction;
      time_s = log_time_s_ += log_time_s;
    }
    whole_.update(done / static_cast<double>(runs_), time_s);
  }

  core::Progress& whole_;
  std::mutex mutex_;
  size_t runs_;
  double done_ = 0, log_time_s_ = 0;
};

void runJob(ExplorationJob& job, const world::Plan& plan, const LoopMethod& method,
            const resources::Manifest& manifest, core::Progress& progress, record::StepObserver* observer) {
  if (!job.folder.empty()) fs::create_directories(job.folder);
  try {
    job.result = exploreOnce(plan, *job.config, method, job.seed, job.folder, manifest, progress, observer);
  } catch (const core::MethodError& error) {
    job.result.exploration = failedExploration(*job.config, method.name, job.seed, error.what());
  }
}

}  // namespace

std::vector<ExplorationJob> makeJobs(const ExploreRequest& request, const std::string& folder) {
  std::vector<ExplorationJob> jobs;
  const bool single = request.strategies.size() == 1 && request.seeds == 1;
  for (const auto& config : request.strategies)
    for (int k = 0; k < request.seeds; ++k) {
      ExplorationJob job;
      job.config = &config;
      job.seed = request.seed + static_cast<std::uint64_t>(k);
      if (!request.tables_only) {
        job.folder = single ? folder : folder + "/" + strategyNameOf(config);
        if (request.seeds > 1) job.folder += "/seed_" + std::to_string(job.seed);
      }
      jobs.push_back(std::move(job));
    }
  return jobs;
}

void runJobs(std::vector<ExplorationJob>& jobs, const world::Plan& plan, const LoopMethod& method,
             int thread_count, const resources::Manifest& manifest, core::Progress& progress,
             record::StepObserver* observer) {
  SharedProgress shared(progress, jobs.size());
  std::atomic<bool> ended{false};
  threads::ThreadTeam(thread_count).forEach(jobs.size(), [&](size_t i) {
    if (ended) return;
    try {
      SharedProgress::OfOneRun of_this_run(shared);
      runJob(jobs[i], plan, method, manifest, of_this_run, observer);
      of_this_run.finish();
    } catch (...) {
      ended = true;
      throw;
    }
  });
}

}  // namespace slam::explore

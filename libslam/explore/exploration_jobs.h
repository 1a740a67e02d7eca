#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/explore/exploration_loop.h"

namespace slam::explore {

/// One run of a request, and what came of it.
struct ExplorationJob {
  const ExploreConfig* config = nullptr;
  std::uint64_t seed = 0;
  std::string folder;  ///< "" = no files
  LoopResult result;
};

/// Strategies in their order, seeds within; a single run has the whole folder.
std::vector<ExplorationJob> makeJobs(const ExploreRequest& request, const std::string& folder);

/// Each run is independent, so the number of threads changes nothing but the time. The first error but
/// MethodError, which is a result, ends it: no more runs are begun.
void runJobs(std::vector<ExplorationJob>& jobs, const world::Plan& plan, const LoopMethod& method,
             int thread_count, const resources::Manifest& manifest, core::Progress& progress,
             record::StepObserver* observer);

}  // namespace slam::explore

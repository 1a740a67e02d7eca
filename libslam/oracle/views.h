#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libslam/metrics/coverage.h"
#include "libslam/oracle/drive_graph.h"
#include "libslam/world/plan.h"

namespace slam::oracle {

/// A set of samples as bits.
using SampleSet = std::vector<std::uint64_t>;
std::size_t countOf(const SampleSet& set);

/// Sampled places to look from, spread evenly over where the robot can drive, and what each of them sees.
///
/// The places are taken one after the other as far as possible by the way from those that are there already
/// (Gonzalez, "Clustering to minimize the maximum intercluster distance", TCS 38, 1985), until none is
/// spacing_m away or there are most_views. What none of them sees then gets a place of its own. Samples are
/// explorable cells on a regular lattice, about most_samples of them.
struct Views {
  std::vector<DriveGraph::Node> node;  ///< per view; the start's is the first
  std::vector<SampleSet> seen;         ///< per view: its samples within the range, all round
  std::vector<std::int32_t> near;      ///< per node of the graph: the view nearest by the way
  std::size_t samples = 0;
};

struct ViewOptions {
  double max_range_m = 0;  ///< <= 0: no limit
  double spacing_m = 0.5;
  std::size_t most_views = 600;
  std::size_t most_samples = 8000;
};

Views sampleViews(const world::Plan& plan, const metrics::ExplorableArea& area, const DriveGraph& graph,
                  const ViewOptions& options);

}  // namespace slam::oracle

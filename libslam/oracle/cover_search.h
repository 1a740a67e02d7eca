#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "libslam/oracle/drive_graph.h"
#include "libslam/oracle/views.h"

namespace slam::oracle {

class Chance;

/// Short tours over views that together see enough: the views' ways, and the search.
///
/// A tour is an order of views, the start first; it ends at its last. What is seen on the way counts: that of
/// the views nearest to the nodes passed. The search removes neighbouring stops of the best tour so far and
/// mends what is missing by the views that show most per metre of detour (ruin and recreate: Schrimpf et al.,
/// J. Comput. Phys. 159, 2000), then leaves out every stop that is not needed and shortens the order by 2-opt
/// (Croes 1958) and Or-opt (Or 1976); a longer tour is accepted as simulated annealing does. The same every
/// time: its random stream has a fixed seed.
class CoverSearch {
 public:
  using Tour = std::vector<std::int32_t>;

  CoverSearch(const DriveGraph& graph, const Views& views);
  /// A tour that sees at least `samples` of them, or as many as can be seen. `rounds` of ruin and recreate.
  /// `go_on` is asked now and then: it may throw.
  Tour search(std::size_t samples, int rounds, const std::function<void()>& go_on);
  double length(const Tour& tour) const;
  std::size_t seenBy(const Tour& tour) const;
  /// The places along a tour, world frame, the start first; bends that a straight line cuts are left out.
  std::vector<core::Point2> path(const Tour& tour) const;

 private:
  const SampleSet& legSeen(std::int32_t a, std::int32_t b) const;
  float leg(std::int32_t a, std::int32_t b) const {
    return leg_m_[static_cast<std::size_t>(a) * views_.node.size() + static_cast<std::size_t>(b)];
  }
  void mend(Tour& tour, std::size_t samples, Chance& chance) const;
  void prune(Tour& tour, std::size_t samples) const;
  void shorten(Tour& tour) const;
  SampleSet coverOf(const Tour& tour) const;

  const DriveGraph& graph_;
  const Views& views_;
  std::vector<float> leg_m_;
  std::vector<DriveGraph::Ways> ways_;
  mutable std::vector<SampleSet> leg_seen_;  ///< made when first asked for
};

}  // namespace slam::oracle

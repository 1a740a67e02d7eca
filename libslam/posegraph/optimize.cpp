#include "libslam/posegraph/optimize.h"

#include <limits>
#include <optional>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/posegraph/descent.h"
#include "libslam/posegraph/graph_system.h"
#include "libslam/posegraph/loop_search.h"
#include "libslam/posegraph/parts.h"
#include "libslam/threads/paced_work.h"

namespace slam::posegraph {
namespace {

/// To order a graph's nodes takes as long as so many multiplications for each of its edges; and to give these
/// their places in the equations.
constexpr double kAnalysisPerEdge = 1000, kPlacingPerEdge = 800;

void requireSound(const OptimizeOptions& o) {
  if (o.robust != "none" && o.robust != "local" && o.robust != "global")
    throw core::ContractError("optimize: robust is '" + o.robust + "', expected none, local or global");
  if (!(o.switch_off_chi2 > 0) || !(o.switch_off_medians >= 0) || !(o.tolerance > 0) || o.max_iterations < 1)
    throw core::ContractError("optimize: an option is out of its bounds");
}

}  // namespace

OptimizeOptions::OptimizeOptions() {
  table().setDefaults(*this);
}

const files::ParameterTable<OptimizeOptions>& OptimizeOptions::table() {
  static const files::ParameterTable<OptimizeOptions> rows(
      "posegraph",
      {{"robust",
        &OptimizeOptions::robust,
        "none",
        {"none", "local", "global"},
        "which loops may be switched off: none; starting from those that are on; starting from none"},
       {"switch_off_chi2", &OptimizeOptions::switch_off_chi2, 30.0, 1e-6, 1e9,
        "a loop is switched off when the graph's chi2 falls by more than this without it"},
       {"switch_off_medians", &OptimizeOptions::switch_off_medians, 60.0, 0.0, 1e9,
        "or by more than so many times what the median loop costs (from 20 loops on; 0: never)"},
       {"tolerance", &OptimizeOptions::tolerance, 1e-3, 1e-9, 1.0,
        "done when no pose would move by more than so many of its standard deviations"},
       {"max_iterations", &OptimizeOptions::max_iterations, 100, 1, 1000000, "most steps of one descent"}});
  return rows;
}

OptimizeResult optimize(PoseGraph& graph, const OptimizeOptions& options) {
  requireSound(options);
  OptimizeResult result;
  result.initial_chi2 = graph.chi2();
  LoopChoice choice;
  if (options.robust == "none") {
    choice.on = edgesOn(graph);
    GraphSystem system(graph, choice.on);
    Descent descent(graph, system, graph.poses(), std::vector<double>(choice.on.size(), 1.0),
                    options.tolerance, options.max_iterations);
    descent.finish();
    choice.poses = descent.poses();
    choice.converged = descent.converged();
    result.iterations = descent.iterations();
  } else {
    LoopSearch search(graph, options);
    choice = options.robust == "local" ? search.improve() : search.build();
    result.iterations = search.iterations();
  }
  result.converged = choice.converged;
  for (int node = 0; node < graph.nodeCount(); ++node)
    graph.setPose(node, choice.poses[static_cast<size_t>(node)]);
  for (size_t i = 0; i < choice.on.size(); ++i) {
    graph.setOn(static_cast<int>(i), choice.on[i] != 0);
    if (!choice.on[i] && graph.edges()[i].kind == EdgeKind::kLoop)
      result.switched_off.push_back(static_cast<int>(i));
  }
  result.final_chi2 = graph.chi2();
  return result;
}

struct OptimizeInPieces::Work {
  PoseGraph graph;
  OptimizeOptions options;
  std::optional<GraphSystem> system;
  std::optional<Descent> descent;
  threads::PaidFirst dear;
};

OptimizeInPieces::OptimizeInPieces(PoseGraph graph, const OptimizeOptions& options)
    : work_(std::make_unique<Work>(Work{std::move(graph), options, {}, {}, {}})) {
  requireSound(options);
  if (options.robust != "none")
    throw core::ContractError("OptimizeInPieces: robust is '" + options.robust + "', expected none");
  requireHeld(work_->graph, edgesOn(work_->graph));
}

OptimizeInPieces::~OptimizeInPieces() = default;

bool OptimizeInPieces::advance(double& work) {
  Work& w = *work_;
  const auto edges = static_cast<double>(w.graph.edges().size());
  if (!w.system) {
    if (!w.dear.isPaid(kAnalysisPerEdge * edges, work)) return false;
    w.system.emplace(w.graph, edgesOn(w.graph));
  }
  if (!w.descent) {
    if (!w.dear.isPaid(kPlacingPerEdge * edges, work)) return false;
    w.descent.emplace(w.graph, *w.system, w.graph.poses(), std::vector<double>(w.graph.edges().size(), 1.0),
                      w.options.tolerance, w.options.max_iterations);
  }
  return w.descent->advance(work);
}

OptimizeResult OptimizeInPieces::finish() {
  double unlimited = std::numeric_limits<double>::infinity();
  advance(unlimited);
  OptimizeResult result;
  result.converged = work_->descent->converged();
  result.iterations = work_->descent->iterations();
  result.initial_chi2 = work_->descent->firstChi2();
  result.final_chi2 = work_->descent->chi2();
  return result;
}

const PoseGraph& OptimizeInPieces::graph() const {
  return work_->graph;
}

const std::vector<core::Pose2>& OptimizeInPieces::poses() const {
  return work_->descent ? work_->descent->poses() : work_->graph.poses();
}

}  // namespace slam::posegraph

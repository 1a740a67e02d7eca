#include "libslam/certified/global.h"

#include <algorithm>

#include "libslam/certified/relaxation.h"
#include "libslam/posegraph/chaining.h"

namespace slam::certified {
namespace {

/// In standard deviations: how near a minimum a certificate is asked for. At a distance d the bound is looser
/// by d^2.
constexpr double kFine = 1e-6;
/// An end is lower than another by at least so much of its chi2.
constexpr double kLower = 1e-9;

}  // namespace

GlobalResult optimizeGlobally(posegraph::PoseGraph& graph, const posegraph::OptimizeOptions& options) {
  GlobalResult out;
  posegraph::OptimizeOptions plain = options;
  plain.robust = "none";
  plain.tolerance = std::min(options.tolerance, kFine);
  const auto finish = [&] {
    const posegraph::OptimizeResult fine = posegraph::optimize(graph, plain);
    out.optimum.iterations += fine.iterations;
    out.optimum.converged = out.optimum.converged || fine.converged;
    out.optimum.final_chi2 = fine.final_chi2;
    out.certificate = certify(graph);
  };
  out.optimum = posegraph::optimize(graph, options);
  if (out.optimum.converged) finish();
  if (out.certificate.is_optimal) return out;

  posegraph::PoseGraph other = graph;
  posegraph::startAt(other, relaxedPoses(graph));
  const posegraph::OptimizeResult relaxed = posegraph::optimize(other, plain);
  out.optimum.iterations += relaxed.iterations;
  if (!(relaxed.final_chi2 < out.optimum.final_chi2 * (1 - kLower))) {
    if (!out.optimum.converged) finish();
    return out;
  }
  out.from_relaxation = true;
  graph = std::move(other);
  out.optimum.converged = relaxed.converged;
  if (options.robust != "none") {
    posegraph::OptimizeOptions again = options;
    again.robust = "local";
    const posegraph::OptimizeResult judged = posegraph::optimize(graph, again);
    out.optimum.iterations += judged.iterations;
    out.optimum.switched_off = judged.switched_off;
  }
  finish();
  return out;
}

}  // namespace slam::certified

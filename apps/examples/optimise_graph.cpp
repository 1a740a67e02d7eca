// Optimises a pose graph in a g2o file: optimise_graph IN.g2o OUT.g2o
#include <cstdio>

#include "libslam/posegraph/g2o_io.h"
#include "libslam/posegraph/optimize.h"

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fprintf(stderr, "usage: optimise_graph IN.g2o OUT.g2o\n");
    return 2;
  }
  auto file = slam::posegraph::readG2oFile(argv[1]);
  slam::posegraph::OptimizeOptions options;
  options.robust = "global";  // false loops may be among the edges
  const auto result = slam::posegraph::optimize(file.graph, options);
  slam::posegraph::writeG2oFile(file.graph, file.ids, argv[2]);
  std::printf("%d poses, %zu edges: chi2 %.6g -> %.6g, %zu loops switched off%s\n", file.graph.nodeCount(),
              file.graph.edges().size(), result.initial_chi2, result.final_chi2, result.switched_off.size(),
              result.converged ? "" : " (not converged)");
} catch (const std::exception& error) {
  std::fprintf(stderr, "optimise_graph: %s\n", error.what());
  return 1;
}

#include <sstream>

#include "libslam/posegraph/g2o_io.h"
#include "libslam/posegraph/marginals.h"
#include "libslam/posegraph/optimize.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream text(std::string(reinterpret_cast<const char*>(data), size));
  return slam::fuzz::refuseOrRead([&] {
    auto graph = slam::posegraph::readG2o(text, "fuzz.g2o").graph;
    slam::posegraph::OptimizeOptions options;
    options.robust = size % 2 == 0 ? "local" : "global";
    options.max_iterations = 5;
    slam::posegraph::optimize(graph, options);
    try {
      slam::posegraph::Marginals(graph).all();
    } catch (const slam::core::MethodError&) {
      // A file may well leave a direction open.
    }
  });
}

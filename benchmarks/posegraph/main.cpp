// Pose graphs: time and result of the optimisation, of wrong loops, of a graph that grows, of covariances.
//   rasterslam_posegraph_bench [--data FOLDER] [--seeds N] [--csv F]
// FOLDER holds posegraphs/ (g2o files, xz); what is absent is skipped and said. All times are thread CPU
// time.
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/files/files.h"
#include "libslam/posegraph/edge_error.h"
#include "libslam/posegraph/g2o_io.h"
#include "libslam/posegraph/marginals.h"
#include "libslam/posegraph/optimize.h"
#include "libslam/table/table.h"
#include "libslam/testing/pose_graphs.h"
#include "libslam/testing/temp_folder.h"
#include "libslam/threads/cpu_time.h"

namespace {

using namespace slam;
using posegraph::Edge;
using posegraph::EdgeKind;
using posegraph::PoseGraph;

struct Arguments {
  std::string data = "../shared/data", csv;
  int seeds = 20;
};

struct NamedGraph {
  std::string name;
  PoseGraph graph;
};

constexpr int kRepetitions = 21;

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1))];
}

double sum(const std::vector<double>& values) {
  double total = 0;
  for (const double value : values) total += value;
  return total;
}

double milliseconds(const std::function<void()>& work) {
  const double start = threads::cpuSeconds();
  work();
  return 1e3 * (threads::cpuSeconds() - start);
}

double medianMilliseconds(const std::function<void()>& work) {
  std::vector<double> times(kRepetitions);
  for (double& time : times) time = milliseconds(work);
  return quantile(times, 0.5);
}

double rmsDistance(const PoseGraph& a, const PoseGraph& b) {
  double total = 0;
  for (int node = 0; node < a.nodeCount(); ++node) {
    const double d = core::distance(a.pose(node), b.pose(node));
    total += d * d;
  }
  return std::sqrt(total / a.nodeCount());
}

PoseGraph optimum(PoseGraph graph) {
  posegraph::optimize(graph);
  return graph;
}

std::vector<NamedGraph> graphs(const Arguments& a) {
  std::vector<NamedGraph> all;
  for (const char* name : {"intel", "manhattan"}) {
    const std::string path = a.data + "/posegraphs/" + name + ".g2o.xz";
    if (!std::filesystem::exists(path)) {
      std::cerr << name << ": skipped, " << path << " is not there\n";
      continue;
    }
    const auto unpacked = testing::runCommand("xzcat '" + path + "'");
    if (unpacked.exit_code != 0) throw core::InputError(path + ": " + unpacked.err);
    std::istringstream text(unpacked.out);
    all.push_back({name, posegraph::readG2o(text, path).graph});
  }
  return all;
}

/// One analysis and one factorisation of the same equations by Eigen's scalar Cholesky.
double simplicialMilliseconds(const PoseGraph& graph) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int a, int b, const Eigen::Matrix3d& block) {
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        entries.emplace_back(3 * a + row, 3 * b + column, block(row, column));
  };
  for (const Edge& edge : graph.edges()) {
    const auto q = posegraph::edgeQuadratic(graph.pose(edge.from), graph.pose(edge.to), edge);
    add(edge.from, edge.from, q.aa);
    add(edge.to, edge.to, q.bb);
    add(edge.from, edge.to, q.ab);
    add(edge.to, edge.from, q.ab.transpose());
  }
  for (int i = 0; i < 3; ++i) entries.emplace_back(i, i, 1e9);
  const Eigen::Index size = 3 * static_cast<Eigen::Index>(graph.nodeCount());
  Eigen::SparseMatrix<double> equations(size, size);
  equations.setFromTriplets(entries.begin(), entries.end());
  return medianMilliseconds([&] {
    const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(equations);
    if (factor.info() != Eigen::Success) throw core::MethodError("SimplicialLLT failed");
  });
}

double blockMilliseconds(const PoseGraph& graph) {
  const std::vector<char> all(graph.edges().size(), 1);
  const std::vector<double> weights(graph.edges().size(), 1.0);
  return medianMilliseconds([&] {
    posegraph::GraphSystem system(graph, all);
    system.linearise(graph, graph.poses(), weights);
    if (!system.factorize()) throw core::MethodError("the block factorisation failed");
  });
}

table::Table optimisation(const std::vector<NamedGraph>& all) {
  table::Table table;
  table.caption = "Optimisation";
  table.columns = {{"graph", "graph"},
                   {"nodes", "nodes", 0},
                   {"edges", "edges", 0},
                   {"initial_chi2", "initial chi2", 4},
                   {"final_chi2", "final chi2", 7},
                   {"steps", "steps", 0},
                   {"ms", "ms", 2},
                   {"again_ms", "again (ms)", 2},
                   {"block_ms", "one system (ms)", 2},
                   {"simplicial_ms", "Eigen's factor (ms)", 2}};
  table.notes = {"start: the file's poses (intel), or odometry chained (manhattan)",
                 "ms: optimize() from the start, all in all; again: from the optimum",
                 "one system: ordering, linearisation and factorisation; Eigen's factor: ordering and "
                 "factorisation of the "
                 "same equations by SimplicialLLT, without linearisation and assembly"};
  for (const auto& [name, graph] : all) {
    PoseGraph work = graph;
    const auto result = posegraph::optimize(work);
    const PoseGraph done = work;
    const double ms = medianMilliseconds([&, &start = graph] {
      work = start;
      posegraph::optimize(work);
    });
    const double again_ms = medianMilliseconds([&] {
      work = done;
      posegraph::optimize(work);
    });
    table.rows.push_back({name, double(graph.nodeCount()), double(graph.edges().size()), result.initial_chi2,
                          result.final_chi2, double(result.iterations), ms, again_ms, blockMilliseconds(done),
                          simplicialMilliseconds(done)});
  }
  return table;
}

table::Table wrongLoops(const std::vector<NamedGraph>& all, int seeds) {
  table::Table table;
  table.caption = "Wrong loops";
  table.columns = {{"graph", "graph"},
                   {"robust", "robust"},
                   {"false_share", "false / true loops", 2},
                   {"false_loops", "false loops", 0},
                   {"seeds", "seeds", 0},
                   {"within", "within 5 %", 0},
                   {"worst_ratio", "worst chi2 ratio", 4},
                   {"worst_rms_m", "worst rms (m)", 4},
                   {"false_kept", "false kept, most", 0},
                   {"true_lost", "true lost, most", 0},
                   {"ms", "ms", 0},
                   {"most_ms", "most ms", 0}};
  table.notes = {
      "false loops: between two random nodes at least 20 apart, up to 5 m away along each axis, any heading, "
      "the "
      "information of some true loop; added to the file's edges",
      "chi2 ratio: chi2 of all true edges over that of the optimum without false loops; rms: distance of the "
      "poses from "
      "that optimum; within 5 %: seeds whose ratio is below 1.05",
      "ms: median"};
  for (const auto& [name, graph] : all) {
    const PoseGraph clean = optimum(graph);
    for (const char* robust : {"local", "global"})
      for (const double share : {0.0, 0.1, 0.3}) {
        // On the larger graph three wrong loops to ten right ones fill the equations: minutes.
        if (share > 0.1 && (std::string(robust) == "local" || graph.nodeCount() > 2000)) continue;
        const int runs = share == 0 ? 1 : share > 0.1 ? std::min(seeds, 5) : seeds;
        int within = 0, count = 0;
        double worst_ratio = 0, worst_rms = 0, false_kept = 0, true_lost = 0;
        std::vector<double> times;
        for (int seed = 0; seed < runs; ++seed) {
          PoseGraph work = graph;
          core::RandomStream random(static_cast<std::uint64_t>(seed), "false loops");
          count = testing::addFalseLoops(work, share, random);
          posegraph::OptimizeOptions options;
          options.robust = robust;
          times.push_back(milliseconds([&] { posegraph::optimize(work, options); }));
          double chi2 = 0, kept = 0, lost = 0;
          for (size_t i = 0; i < work.edges().size(); ++i) {
            const bool is_true = i < graph.edges().size();
            if (is_true) chi2 += work.chi2(static_cast<int>(i));
            if (is_true && !work.edges()[i].on) ++lost;
            if (!is_true && work.edges()[i].on) ++kept;
          }
          const double ratio = chi2 / clean.chi2();
          within += ratio < 1.05;
          worst_ratio = std::max(worst_ratio, ratio);
          worst_rms = std::max(worst_rms, rmsDistance(work, clean));
          false_kept = std::max(false_kept, kept);
          true_lost = std::max(true_lost, lost);
        }
        table.rows.push_back({name, std::string(robust), share, double(count), double(runs), double(within),
                              worst_ratio, worst_rms, false_kept, true_lost, quantile(times, 0.5),
                              quantile(times, 1)});
        std::cerr << name << " " << robust << " " << share << "\n";
      }
  }
  return table;
}

/// The graph node by node, as a robot would make it: odometry chains the new pose, and optimize() is called
/// when the loops that came since the last call have a chi2 above `waiting_chi2`.
table::Table growing(const std::vector<NamedGraph>& all) {
  table::Table table;
  table.caption = "A graph that grows";
  table.columns = {{"graph", "graph"},
                   {"robust", "robust"},
                   {"waiting_chi2", "waits to chi2", 2},
                   {"loops", "loops", 0},
                   {"calls", "calls", 0},
                   {"total_ms", "total (ms)", 0},
                   {"median_ms", "median (ms)", 2},
                   {"p99_ms", "p99 (ms)", 2},
                   {"last_ms", "last (ms)", 2},
                   {"rms_m", "rms at the end (m)", 4}};
  table.notes = {
      "waits to chi2: the chi2 of new loops that is let gather before a call (0: every loop is a call)",
      "rms at the end: distance from the optimum of the whole graph, before any last call"};
  for (const auto& [name, graph] : all) {
    const PoseGraph clean = optimum(graph);
    std::vector<std::vector<Edge>> edges_of(static_cast<size_t>(graph.nodeCount()));  // by the later node
    for (const Edge& edge : graph.edges())
      edges_of[static_cast<size_t>(std::max(edge.from, edge.to))].push_back(edge);
    for (const char* robust : {"none", "local"})
      for (const double waits : {0.0, 0.1, 1.0}) {
        posegraph::OptimizeOptions options;
        options.robust = robust;
        options.tolerance = 0.1;
        PoseGraph work;
        work.addNode(graph.pose(0));
        work.setFixed(0);
        double waiting = 0;
        int loops = 0;
        std::vector<double> times;
        for (int node = 1; node < graph.nodeCount(); ++node) {
          const auto& edges = edges_of[static_cast<size_t>(node)];
          for (const Edge& edge : edges)
            if (edge.kind == EdgeKind::kOdometry) work.addNode(work.pose(edge.from) * edge.T_from_to);
          bool has_loop = false;
          for (const Edge& edge : edges) {
            const int number = work.addEdge(edge);
            if (edge.kind != EdgeKind::kLoop) continue;
            has_loop = true;
            ++loops;
            waiting += work.chi2(number);
          }
          if (!has_loop || waiting <= waits) continue;
          times.push_back(milliseconds([&] { posegraph::optimize(work, options); }));
          waiting = 0;
        }
        table.rows.push_back({name, std::string(robust), waits, double(loops), double(times.size()),
                              sum(times), quantile(times, 0.5), quantile(times, 0.99), times.back(),
                              rmsDistance(work, clean)});
      }
    std::cerr << name << " grown\n";
  }
  return table;
}

table::Table covariances(const std::vector<NamedGraph>& all) {
  table::Table table;
  table.caption = "Covariances";
  table.columns = {{"graph", "graph"},
                   {"factor_ms", "factor (ms)", 2},
                   {"one_us", "one node (us)", 1},
                   {"pair_us", "one pair (us)", 1},
                   {"all_ms", "all nodes (ms)", 2}};
  table.notes = {
      "factor: Marginals(graph); one node, one pair: means over 200 of them, the pairs each with the last "
      "node"};
  for (const auto& [name, graph] : all) {
    const PoseGraph done = optimum(graph);
    const posegraph::Marginals marginals(done);
    constexpr int kCount = 200;
    const int last = done.nodeCount() - 1, stride = last / kCount;
    double sink = 0;
    const double factor_ms =
        medianMilliseconds([&] { sink += posegraph::Marginals(done).covariance(last)(0, 0); });
    const double one_ms = medianMilliseconds([&] {
      for (int i = 0; i < kCount; ++i) sink += marginals.covariance(i * stride)(0, 0);
    });
    const double pair_ms = medianMilliseconds([&] {
      for (int i = 0; i < kCount; ++i) sink += marginals.relative(i * stride, last)(0, 0);
    });
    const double all_ms = medianMilliseconds([&] { sink += marginals.all().back()(0, 0); });
    if (!(sink > 0)) throw core::MethodError("covariances are not positive");
    table.rows.push_back({name, factor_ms, 1e3 * one_ms / kCount, 1e3 * pair_ms / kCount, all_ms});
  }
  return table;
}

Arguments parse(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i < argc; ++i) {
    const std::string key = argv[i];
    if (i + 1 >= argc) throw core::InputError(key + ": expected a value");
    const std::string value = argv[++i];
    if (key == "--data")
      a.data = value;
    else if (key == "--csv")
      a.csv = value;
    else if (key == "--seeds")
      a.seeds = std::max(1, std::atoi(value.c_str()));
    else
      throw core::InputError(key + ": unknown option");
  }
  return a;
}

void run(const Arguments& a) {
  const auto all = graphs(a);
  std::string csv;
  for (const table::Table& table :
       {optimisation(all), wrongLoops(all, a.seeds), growing(all), covariances(all)}) {
    std::cout << table::toText(table) << std::endl;
    csv += (csv.empty() ? "" : "\r\n") + table::toCsv(table);
  }
  if (!a.csv.empty()) files::writeFileAtomically(a.csv, csv);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    ::run(parse(argc, argv));
    return 0;
  } catch (const core::InputError& error) {
    std::cerr << error.what() << "\n";
    return 3;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}

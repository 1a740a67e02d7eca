#include "libslam/posegraph/g2o_io.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/core/parameters.h"
#include "libslam/posegraph/chaining.h"

namespace slam::posegraph {
namespace {

using Id = long long;

/// The words of one line behind its tag, taken one by one.
class Fields {
 public:
  Fields(std::istringstream& words, std::string where) : words_(words), where_(std::move(where)) {}

  Id id() {
    const std::string word = next("an id");
    Id value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size())
      refuse("found '" + word + "', expected an id");
    return value;
  }
  double number() {
    const std::string word = next("a number");
    double value = 0;
    if (!core::parseNumber(word, value)) refuse("found '" + word + "', expected a finite number");
    return value;
  }
  core::Pose2 pose() {
    core::Pose2 pose;
    pose.x = number(), pose.y = number(), pose.phi = number();
    return pose;
  }
  Eigen::Matrix3d information() {
    Eigen::Matrix3d m;
    for (int row = 0; row < 3; ++row)
      for (int column = row; column < 3; ++column) m(row, column) = m(column, row) = number();
    const std::string problem = informationProblem(m);
    if (!problem.empty())
      refuse("found an information matrix that is " + problem + ", expected a positive semidefinite one");
    return m;
  }
  bool atEnd() { return (words_ >> std::ws).eof(); }
  void requireEnd() {
    if (!atEnd()) refuse("found '" + next("") + "', expected the end of the line");
  }
  [[noreturn]] void refuse(const std::string& what) const { throw core::InputError(where_ + ": " + what); }

 private:
  std::string next(const char* expected) {
    std::string word;
    if (!(words_ >> word)) refuse(std::string("found the end of the line, expected ") + expected);
    return word;
  }
  std::istringstream& words_;
  std::string where_;
};

struct FileEdge {
  std::optional<Id> from;  // none: a prior
  Id to = 0;
  core::Pose2 T_from_to;
  Eigen::Matrix3d information;
};

struct FileContent {
  std::map<Id, std::optional<core::Pose2>> vertices;  // without a pose: only named by an edge
  std::vector<FileEdge> edges;
  std::map<Id, std::string> fixed;  // with the line that says so
  std::map<std::string, int> passed_over;
};

void parseLine(const std::string& tag, Fields& fields, const std::string& where, FileContent& content) {
  if (tag == "VERTEX_SE2") {
    const Id id = fields.id();
    auto& pose = content.vertices[id];
    if (pose) fields.refuse("found vertex " + std::to_string(id) + " a second time, expected it once");
    pose = fields.pose();
  } else if (tag == "EDGE_SE2" || tag == "EDGE_PRIOR_SE2") {
    FileEdge edge;
    if (tag == "EDGE_SE2") edge.from = fields.id();
    edge.to = fields.id();
    if (edge.from == edge.to)
      fields.refuse("found an edge from vertex " + std::to_string(edge.to) +
                    " to itself, expected two vertices");
    edge.T_from_to = fields.pose();
    edge.information = fields.information();
    if (edge.from) content.vertices[*edge.from];
    content.vertices[edge.to];
    content.edges.push_back(edge);
  } else if (tag == "FIX") {
    do content.fixed.emplace(fields.id(), where);
    while (!fields.atEnd());
  } else {
    ++content.passed_over[tag];
    return;
  }
  fields.requireEnd();
}

FileContent parse(std::istream& text, const std::string& name) {
  FileContent content;
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    const std::string where = name + ":" + std::to_string(++number);
    std::istringstream words(line);
    std::string tag;
    if (!(words >> tag) || tag.front() == '#') continue;
    Fields fields(words, where);
    parseLine(tag, fields, where, content);
  }
  if (content.vertices.empty())
    throw core::InputError(name + ": found no vertex and no edge, expected lines VERTEX_SE2 and EDGE_SE2");
  for (const auto& [id, where] : content.fixed)
    if (content.vertices.count(id) == 0)
      throw core::InputError(where + ": found FIX of " + std::to_string(id) +
                             ", expected a vertex of the file");
  return content;
}

void append(std::string& line, const core::Pose2& pose) {
  for (const double value : {pose.x, pose.y, pose.phi}) line += ' ' + core::formatNumber(value);
}

}  // namespace

G2oGraph readG2o(std::istream& text, const std::string& name) {
  FileContent content = parse(text, name);
  G2oGraph out;
  out.passed_over = std::move(content.passed_over);
  std::vector<std::optional<core::Pose2>> given;
  for (const auto& [id, pose] : content.vertices) {
    out.ids.push_back(id);
    given.push_back(pose);
  }
  const auto nodeOf = [&out](Id id) {
    return static_cast<int>(std::lower_bound(out.ids.begin(), out.ids.end(), id) - out.ids.begin());
  };
  std::vector<Edge> edges;
  for (const FileEdge& read : content.edges) {
    Edge edge{kMap, nodeOf(read.to), read.T_from_to, read.information, EdgeKind::kOdometry};
    if (read.from) {
      edge.from = nodeOf(*read.from);
      // Without ++ on the id, which may be the largest there is.
      if (*read.from >= read.to || read.to - 1 != *read.from) edge.kind = EdgeKind::kLoop;
    }
    edges.push_back(edge);
  }
  for (const core::Pose2& pose : chained(edges, std::move(given))) out.graph.addNode(pose);
  bool is_held = !content.fixed.empty();
  for (const Edge& edge : edges) {
    out.graph.addEdge(edge);
    is_held = is_held || edge.from == kMap;
  }
  for (const auto& fixed : content.fixed) out.graph.setFixed(nodeOf(fixed.first));
  if (!is_held) out.graph.setFixed(0);
  return out;
}

G2oGraph readG2oFile(const std::string& path) {
  core::requireReadableFile(path);
  std::ifstream text(path);
  return readG2o(text, path);
}

void writeG2oFile(const PoseGraph& graph, const std::vector<Id>& ids, const std::string& path) {
  if (!ids.empty() && ids.size() != static_cast<size_t>(graph.nodeCount()))
    throw core::ContractError("writeG2oFile: " + std::to_string(ids.size()) + " ids for " +
                              std::to_string(graph.nodeCount()) + " nodes");
  const auto idOf = [&ids](int node) {
    return ' ' + std::to_string(ids.empty() ? node : ids[static_cast<size_t>(node)]);
  };
  core::GrowingFile file(path);
  for (int node = 0; node < graph.nodeCount(); ++node) {
    std::string line = "VERTEX_SE2" + idOf(node);
    append(line, graph.pose(node));
    file.append(line + '\n');
  }
  for (int node = 0; node < graph.nodeCount(); ++node)
    if (graph.isFixed(node)) file.append("FIX" + idOf(node) + '\n');
  for (const Edge& edge : graph.edges()) {
    if (!edge.on) continue;
    std::string line = edge.from == kMap ? "EDGE_PRIOR_SE2" : "EDGE_SE2" + idOf(edge.from);
    line += idOf(edge.to);
    append(line, edge.T_from_to);
    for (int row = 0; row < 3; ++row)
      for (int column = row; column < 3; ++column)
        line += ' ' + core::formatNumber(edge.information(row, column));
    file.append(line + '\n');
  }
  file.commit();
}

}  // namespace slam::posegraph

#include "libslam/posegraph/g2o_io.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
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
    if (!files::parseNumber(word, value)) refuse("found '" + word + "', expected a finite number");
    return value;
  }
  core::Pose2 pose() {
    core::Pose2 pose;
    pose.x = number(), pose.y = number(), pose.phi = number();
    return pose;
  }
  /// `is_toro`: columns xx xy yy pp xp yp; else the upper triangle by rows.
  Eigen::Matrix3d information(bool is_toro) {
    static const std::array<std::pair<int, int>, 6> kRows = {
        {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};
    static const std::array<std::pair<int, int>, 6> kToro = {
        {{0, 0}, {0, 1}, {1, 1}, {2, 2}, {0, 2}, {1, 2}}};
    Eigen::Matrix3d m;
    for (const auto& [row, column] : is_toro ? kToro : kRows) m(row, column) = m(column, row) = number();
    const std::string problem = informationProblem(m);
    if (!problem.empty())
      refuse("found an information matrix that is " + problem + ", expected a positive semidefinite one");
    return m;
  }
  bool atEnd() { return (words_ >> std::ws).eof(); }
  /// Where MRPT's graphs say more of a node than its pose.
  bool atRemark() { return (words_ >> std::ws).peek() == '|'; }
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
  std::map<Id, Id> same;            // EQUIV: the larger id stands for the smaller
  std::map<std::string, int> passed_over;
};

void parseVertex(Fields& fields, FileContent& content) {
  const Id id = fields.id();
  auto& pose = content.vertices[id];
  if (pose) fields.refuse("found vertex " + std::to_string(id) + " a second time, expected it once");
  pose = fields.pose();
}

void parseEdge(bool is_prior, bool is_toro, Fields& fields, FileContent& content) {
  FileEdge edge;
  if (!is_prior) edge.from = fields.id();
  edge.to = fields.id();
  if (edge.from == edge.to)
    fields.refuse("found an edge from vertex " + std::to_string(edge.to) +
                  " to itself, expected two vertices");
  edge.T_from_to = fields.pose();
  edge.information = fields.information(is_toro);
  if (edge.from) content.vertices[*edge.from];
  content.vertices[edge.to];
  content.edges.push_back(edge);
}

void parseLine(const std::string& tag, Fields& fields, const std::string& where, FileContent& content) {
  if (tag == "VERTEX_SE2" || tag == "VERTEX2" || tag == "VERTEX") {
    parseVertex(fields, content);
    if (fields.atRemark()) return;
  } else if (tag == "EDGE_SE2" || tag == "EDGE_PRIOR_SE2") {
    parseEdge(tag == "EDGE_PRIOR_SE2", false, fields, content);
  } else if (tag == "EDGE2" || tag == "EDGE" || tag == "ODOMETRY") {
    parseEdge(false, true, fields, content);
  } else if (tag == "FIX") {
    do content.fixed.emplace(fields.id(), where);
    while (!fields.atEnd());
  } else if (tag == "EQUIV") {
    const Id a = fields.id(), b = fields.id();
    if (a != b) content.same[std::max(a, b)] = std::min(a, b);
  } else {
    ++content.passed_over[tag];
    return;
  }
  fields.requireEnd();
}

/// Puts the smallest id in the place of all that EQUIV says are the same vertex; edges inside one are
/// dropped.
void mergeSame(FileContent& content) {
  const auto smallest = [&content](Id id) {
    for (auto it = content.same.find(id); it != content.same.end(); it = content.same.find(id))
      id = it->second;
    return id;
  };
  for (const auto& pair : content.same) {
    const auto it = content.vertices.find(pair.first);
    if (it == content.vertices.end()) continue;
    auto& kept = content.vertices[smallest(pair.first)];
    if (!kept) kept = it->second;
    content.vertices.erase(it);
  }
  for (auto& edge : content.edges) {
    if (edge.from) edge.from = smallest(*edge.from);
    edge.to = smallest(edge.to);
  }
  const auto inside = [](const FileEdge& edge) { return edge.from == edge.to; };
  content.edges.erase(std::remove_if(content.edges.begin(), content.edges.end(), inside),
                      content.edges.end());
  std::map<Id, std::string> fixed;
  for (const auto& [id, where] : content.fixed) fixed.emplace(smallest(id), where);
  content.fixed = std::move(fixed);
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
  mergeSame(content);
  if (content.vertices.empty())
    throw core::InputError(name + ": found no vertex and no edge, expected lines VERTEX_SE2 and EDGE_SE2");
  for (const auto& [id, where] : content.fixed)
    if (content.vertices.count(id) == 0)
      throw core::InputError(where + ": found FIX of " + std::to_string(id) +
                             ", expected a vertex of the file");
  return content;
}

/// One line per vertex, per fixed vertex and per edge that is on, as idOf() calls the nodes.
class Writer {
 public:
  Writer(const PoseGraph& graph, const std::vector<Id>& ids, const std::string& path)
      : graph_(graph), ids_(ids), file_(path) {}

  void vertex(int node) { file_.append("VERTEX_SE2" + idOf(node) + text(graph_.pose(node)) + '\n'); }
  void fix(int node) {
    if (graph_.isFixed(node)) file_.append("FIX" + idOf(node) + '\n');
  }
  void edges() {
    for (const Edge& edge : graph_.edges()) {
      if (!edge.on) continue;
      std::string line = edge.from == kMap ? "EDGE_PRIOR_SE2" : "EDGE_SE2" + idOf(edge.from);
      line += idOf(edge.to) + text(edge.T_from_to);
      for (int row = 0; row < 3; ++row)
        for (int column = row; column < 3; ++column)
          line += ' ' + files::formatNumber(edge.information(row, column));
      file_.append(line + '\n');
    }
  }
  void commit() { file_.commit(); }

 private:
  std::string idOf(int node) const {
    return ' ' + std::to_string(ids_.empty() ? node : ids_[static_cast<size_t>(node)]);
  }
  static std::string text(const core::Pose2& pose) {
    std::string line;
    for (const double value : {pose.x, pose.y, pose.phi}) line += ' ' + files::formatNumber(value);
    return line;
  }
  const PoseGraph& graph_;
  const std::vector<Id>& ids_;
  files::GrowingFile file_;
};

void requireIds(const PoseGraph& graph, const std::vector<Id>& ids, const char* who) {
  if (!ids.empty() && ids.size() != static_cast<size_t>(graph.nodeCount()))
    throw core::ContractError(std::string(who) + ": " + std::to_string(ids.size()) + " ids for " +
                              std::to_string(graph.nodeCount()) + " nodes");
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
  Edges edges;
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
  files::requireReadableFile(path);
  std::ifstream text(path);
  return readG2o(text, path);
}

void writeG2oFile(const PoseGraph& graph, const std::vector<Id>& ids, const std::string& path) {
  requireIds(graph, ids, "writeG2oFile");
  Writer writer(graph, ids, path);
  for (int node = 0; node < graph.nodeCount(); ++node) writer.vertex(node);
  for (int node = 0; node < graph.nodeCount(); ++node) writer.fix(node);
  writer.edges();
  writer.commit();
}

void writeMrptGraphFile(const PoseGraph& graph, const std::vector<Id>& ids, const std::string& path) {
  requireIds(graph, ids, "writeMrptGraphFile");
  if (!ids.empty() && ids.front() < 0)
    throw core::InputError(path + ": found vertex " + std::to_string(ids.front()) +
                           ", expected ids of zero and above in a graph of MRPT's");
  int fixed = 0, priors = 0;
  for (int node = 0; node < graph.nodeCount(); ++node) fixed += graph.isFixed(node);
  for (const Edge& edge : graph.edges()) priors += edge.on && edge.from == kMap;
  if (priors > 0)
    throw core::InputError(path + ": found " + std::to_string(priors) +
                           " priors, expected none in a graph of MRPT's");
  if (fixed != 1)
    throw core::InputError(path + ": found " + std::to_string(fixed) +
                           " fixed vertices, expected one, the root of a graph of MRPT's");
  Writer writer(graph, ids, path);
  for (int node = 0; node < graph.nodeCount(); ++node) {
    writer.vertex(node);
    writer.fix(node);
  }
  writer.edges();
  writer.commit();
}

}  // namespace slam::posegraph

#pragma once
#include <istream>
#include <map>
#include <string>
#include <vector>

#include "libslam/posegraph/pose_graph.h"

namespace slam::posegraph {

/// A graph as g2o's files hold it (Kümmerle et al., ICRA 2011): lines
///   VERTEX_SE2 id x y phi
///   EDGE_SE2 id_from id_to x y phi i11 i12 i13 i22 i23 i33     (upper triangle of the information)
///   EDGE_PRIOR_SE2 id x y phi i11 i12 i13 i22 i23 i33
///   FIX id [id ...]
/// and as MRPT's text graphs do (CNetworkOfPoses2DInf::saveToTextFile(), graph-slam, graphslam-engine), which
/// are the same lines with | and a remark behind some vertices, or, in older ones and in TORO's,
///   VERTEX2 id x y phi                                           (or VERTEX)
///   EDGE2 id_from id_to x y phi ixx ixy iyy ipp ixp iyp           (or EDGE, ODOMETRY)
///   EQUIV id id                                                   one vertex: the smaller id
/// The columns of EDGE2 are those of TORO's definition and of the graphs that MRPT ships; MRPT 2.x reads them
/// as it reads EDGE_SE2, and so finds indefinite information in its own.
/// Metres and radians. An edge between consecutive ids, the smaller first, is taken as odometry, any other as
/// a loop.
struct G2oGraph {
  PoseGraph graph;
  std::vector<long long> ids;  ///< of the nodes, ascending: node i of the graph is the file's vertex ids[i]
  std::map<std::string, int> passed_over;  ///< lines with other tags, by tag
};

/// Reads to the end of the text; `name` stands for the file in messages. Blank lines and lines that start
/// with # are passed over, other tags counted; no locale. Lines may come in any order.
/// A vertex that is only named by edges gets its pose by chaining measurements from the vertex of the
/// smallest id, breadth first and odometry before loops. Where nothing is fixed and there is no prior, the
/// vertex with the smallest id is fixed.
/// Errors (InputError with name:line): a number that is missing, malformed or not finite, columns too many, a
/// vertex given twice, an edge from a vertex to itself, information that is zero or indefinite; a FIX of no
/// vertex; no vertex at all.
G2oGraph readG2o(std::istream& text, const std::string& name);
/// The same from a file; and files::requireReadableFile()'s errors.
G2oGraph readG2oFile(const std::string& path);

/// Reads back to the same bits. `ids`: one per node, ascending, or empty for 0, 1, 2 ... An edge that is off
/// is left out. REQUIRES as many ids as nodes (ContractError). Errors: IoError; whole or not at all.
void writeG2oFile(const PoseGraph& graph, const std::vector<long long>& ids, const std::string& path);

/// The same for MRPT: its CNetworkOfPoses2DInf::loadFromTextFile() and graph-slam read it. Such a graph has
/// one fixed vertex, its root, no priors, and ids of zero and above. Errors: InputError when this graph has
/// others; as writeG2oFile().
void writeMrptGraphFile(const PoseGraph& graph, const std::vector<long long>& ids, const std::string& path);

}  // namespace slam::posegraph

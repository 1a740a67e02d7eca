#include "libslam/posegraph/g2o_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/graphs/CNetworkOfPoses.h>

#include <fstream>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/pose_graphs.h"
#include "libslam/testing/temp_folder.h"

namespace slam::posegraph {
namespace {

G2oGraph parsed(const std::string& text) {
  std::istringstream stream(text);
  return readG2o(stream, "a.g2o");
}

std::string errorFor(const std::string& text) {
  EXPECT_THROW(parsed(text), core::InputError) << text;
  return testing::errorOf([&] { parsed(text); });
}

void expectPose(const core::Pose2& got, const core::Pose2& expected) {
  EXPECT_NEAR(got.x, expected.x, 1e-15);
  EXPECT_NEAR(got.y, expected.y, 1e-15);
  EXPECT_NEAR(got.phi, expected.phi, 1e-15);
}

const std::string kUnit = " 1 0 0 1 0 1\n";

TEST(G2o, LinesAreReadInAnyOrder) {
  const G2oGraph read = parsed(
      "EDGE_SE2 7 8 1 2 0.5 11 12 13 22 23 33\n"
      "# a comment\n\n"
      "VERTEX_SE2 8 3 4 -0.25\r\n"
      "FIX 7\n"
      "VERTEX_SE2 -2 0 0 0\n"
      "EDGE_SE2 8 -2 0 0 0" +
      kUnit +
      "VERTEX_XY 3 0 0\n"
      "EDGE_PRIOR_SE2 8 3 4 0 5 0 0 6 0 7\n"
      "VERTEX_XY 4 0 0\n"
      "VERTEX_SE2 7 1e1 -.5 +0.1\n");
  EXPECT_THAT(read.ids, ::testing::ElementsAre(-2, 7, 8));
  expectPose(read.graph.pose(0), {0, 0, 0});
  expectPose(read.graph.pose(1), {10, -0.5, 0.1});
  expectPose(read.graph.pose(2), {3, 4, -0.25});
  EXPECT_FALSE(read.graph.isFixed(0));
  EXPECT_TRUE(read.graph.isFixed(1));
  ASSERT_EQ(read.graph.edges().size(), 3U);
  const Edge& edge = read.graph.edges()[0];
  EXPECT_EQ(edge.from, 1);
  EXPECT_EQ(edge.to, 2);
  expectPose(edge.T_from_to, {1, 2, 0.5});
  Eigen::Matrix3d information;
  information << 11, 12, 13, 12, 22, 23, 13, 23, 33;
  EXPECT_EQ(edge.information, information);
  EXPECT_EQ(edge.kind, EdgeKind::kOdometry) << "7 to 8";
  EXPECT_EQ(read.graph.edges()[1].kind, EdgeKind::kLoop);
  EXPECT_EQ(read.graph.edges()[2].from, kMap);
  EXPECT_EQ(read.graph.edges()[2].to, 2);
  EXPECT_EQ(read.graph.edges()[2].information(1, 1), 6);
  EXPECT_EQ(read.passed_over, (std::map<std::string, int>{{"VERTEX_XY", 2}}));
}

TEST(G2o, VerticesThatOnlyEdgesNameAreChained) {
  // 4 hangs on 3 by odometry and on 0 by a loop that says otherwise: odometry goes first, whatever the order
  // of lines.
  const G2oGraph read =
      parsed("EDGE_SE2 0 4 99 0 0" + kUnit + "VERTEX_SE2 2 10 0 1.5707963267948966\n" + "EDGE_SE2 3 4 2 0 0" +
             kUnit + "EDGE_SE2 2 3 1 0 0" + kUnit + "EDGE_SE2 1 2 1 0 1.5707963267948966" + kUnit +
             "EDGE_SE2 0 1 1 0 0" + kUnit + "EDGE_SE2 20 21 5 0 0" + kUnit);
  EXPECT_THAT(read.ids, ::testing::ElementsAre(0, 1, 2, 3, 4, 20, 21));
  expectPose(read.graph.pose(0), {8, 0, 0});
  expectPose(read.graph.pose(1), {9, 0, 0});
  expectPose(read.graph.pose(3), {10, 1, 1.5707963267948966});
  expectPose(read.graph.pose(4), {10, 3, 1.5707963267948966});
  expectPose(read.graph.pose(5), {0, 0, 0});
  expectPose(read.graph.pose(6), {5, 0, 0});
  EXPECT_TRUE(read.graph.isFixed(0)) << "nothing else holds it";
}

TEST(G2o, APriorHoldsTheGraphAndGivesItsVertexAPose) {
  const G2oGraph read = parsed("EDGE_SE2 0 1 1 0 0" + kUnit + "EDGE_PRIOR_SE2 1 5 6 0" + kUnit);
  EXPECT_FALSE(read.graph.isFixed(0));
  expectPose(read.graph.pose(1), {5, 6, 0});
  expectPose(read.graph.pose(0), {4, 6, 0});
}

TEST(G2o, TheLargestIdsAreNoNeighbours) {
  const G2oGraph read = parsed("EDGE_SE2 9223372036854775807 -9223372036854775808 1 0 0" + kUnit);
  EXPECT_EQ(read.graph.edges()[0].kind, EdgeKind::kLoop);
}

TEST(G2o, BadLinesAreNamed) {
  using ::testing::HasSubstr;
  EXPECT_THAT(errorFor(""), HasSubstr("a.g2o: found no vertex"));
  EXPECT_THAT(errorFor("VERTEX_XY 1 2 3\n"), HasSubstr("a.g2o: found no vertex"));
  EXPECT_THAT(errorFor("\nVERTEX_SE2 0 1 2\n"),
              HasSubstr("a.g2o:2: found the end of the line, expected a number"));
  EXPECT_THAT(errorFor("VERTEX_SE2\n"), HasSubstr("a.g2o:1: found the end of the line, expected an id"));
  EXPECT_THAT(errorFor("VERTEX_SE2 x 0 0 0\n"), HasSubstr("found 'x', expected an id"));
  EXPECT_THAT(errorFor("VERTEX_SE2 1.5 0 0 0\n"), HasSubstr("found '1.5', expected an id"));
  EXPECT_THAT(errorFor("VERTEX_SE2 99999999999999999999 0 0 0\n"), HasSubstr("expected an id"));
  EXPECT_THAT(errorFor("VERTEX_SE2 0 0 nan 0\n"), HasSubstr("found 'nan', expected a finite number"));
  EXPECT_THAT(errorFor("VERTEX_SE2 0 0 0 0 0\n"), HasSubstr("found '0', expected the end of the line"));
  EXPECT_THAT(errorFor("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 0 0 0 0\n"),
              HasSubstr("a.g2o:2: found vertex 0 a second time"));
  EXPECT_THAT(errorFor("EDGE_SE2 3 3 0 0 0" + kUnit), HasSubstr("an edge from vertex 3 to itself"));
  EXPECT_THAT(errorFor("EDGE_SE2 0 1 0 0 0 1 0 0 1 0\n"),
              HasSubstr("found the end of the line, expected a number"));
  EXPECT_THAT(errorFor("EDGE_SE2 0 1 0 0 0 1 0 0 1 0 -1\n"),
              HasSubstr("an information matrix that is indefinite"));
  EXPECT_THAT(errorFor("EDGE_SE2 0 1 0 0 0 0 0 0 0 0 0\n"), HasSubstr("an information matrix that is zero"));
  EXPECT_THAT(errorFor("VERTEX_SE2 0 0 0 0\nFIX 1\n"),
              HasSubstr("a.g2o:2: found FIX of 1, expected a vertex"));
  EXPECT_THAT(errorFor("VERTEX_SE2 0 0 0 0\nFIX\n"), HasSubstr("a.g2o:2: found the end of the line"));
  EXPECT_THROW(readG2oFile("/nowhere/a.g2o"), core::InputError);
}

TEST(G2o, AGraphComesBackFromItsFile) {
  const testing::TempFolder folder;
  PoseGraph graph = testing::driveOnGrid(150, 3).graph;
  graph.setFixed(7);
  Edge prior;
  prior.to = 9, prior.T_from_to = {0.1, 1.0 / 3, -2};
  prior.information << 3, 0.1, 0.2, 0.1, 4, 0.3, 0.2, 0.3, 5;
  graph.addEdge(prior);
  writeG2oFile(graph, {}, folder / "a.g2o");
  const G2oGraph read = readG2oFile(folder / "a.g2o");
  ASSERT_EQ(read.graph.nodeCount(), graph.nodeCount());
  ASSERT_EQ(read.graph.edges().size(), graph.edges().size());
  EXPECT_TRUE(read.passed_over.empty());
  for (int node = 0; node < graph.nodeCount(); ++node) {
    EXPECT_EQ(read.ids[static_cast<size_t>(node)], node);
    EXPECT_EQ(read.graph.pose(node).x, graph.pose(node).x);
    EXPECT_EQ(read.graph.pose(node).y, graph.pose(node).y);
    EXPECT_EQ(read.graph.pose(node).phi, graph.pose(node).phi);
    EXPECT_EQ(read.graph.isFixed(node), graph.isFixed(node));
  }
  for (size_t i = 0; i < graph.edges().size(); ++i) {
    const Edge &a = graph.edges()[i], &b = read.graph.edges()[i];
    EXPECT_EQ(a.from, b.from);
    EXPECT_EQ(a.to, b.to);
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.T_from_to.x, b.T_from_to.x);
    EXPECT_EQ(a.T_from_to.phi, b.T_from_to.phi);
    EXPECT_EQ(a.information, b.information);
  }
  writeG2oFile(read.graph, read.ids, folder / "b.g2o");
  EXPECT_EQ(files::readTextFile(folder / "a.g2o"), files::readTextFile(folder / "b.g2o"));
}

TEST(G2o, AnEdgeThatIsOffStaysOutOfTheFile) {
  const testing::TempFolder folder;
  G2oGraph read = parsed("EDGE_SE2 5 6 1 0 0" + kUnit + "EDGE_SE2 6 5 2 0 0" + kUnit);
  read.graph.setOn(1, false);
  writeG2oFile(read.graph, read.ids, folder / "a.g2o");
  const G2oGraph again = readG2oFile(folder / "a.g2o");
  ASSERT_EQ(again.graph.edges().size(), 1U);
  EXPECT_THAT(again.ids, ::testing::ElementsAre(5, 6));
  EXPECT_THROW(writeG2oFile(read.graph, {1}, folder / "b.g2o"), core::ContractError);
}

TEST(MrptGraph, TorosLinesAreReadInTheirOwnOrder) {
  const G2oGraph read = parsed(
      "VERTEX2 0 0 0 0\nVERTEX 1 1 2 0.5 | a remark\nVERTEX_SE2 2 3 4 0 |tight\n"
      "EDGE2 0 1 1 2 0.5 11 12 22 33 13 23\nODOMETRY 1 2 0 0 0 1 0 2 3 0 0\nEDGE 2 0 0 0 0 1 0 2 3 0 0\n");
  EXPECT_TRUE(read.passed_over.empty());
  expectPose(read.graph.pose(1), {1, 2, 0.5});
  Eigen::Matrix3d information;
  information << 11, 12, 13, 12, 22, 23, 13, 23, 33;
  ASSERT_EQ(read.graph.edges().size(), 3U);
  EXPECT_EQ(read.graph.edges()[0].information, information);
  EXPECT_EQ(read.graph.edges()[1].information, Eigen::Vector3d(1, 2, 3).asDiagonal().toDenseMatrix());
  EXPECT_EQ(read.graph.edges()[2].kind, EdgeKind::kLoop);
}

TEST(MrptGraph, EquivalentVerticesBecomeTheSmallest) {
  const G2oGraph read = parsed(
      "EQUIV 9 3\nEQUIV 3 1\nVERTEX_SE2 9 5 6 0\nVERTEX_SE2 3 7 8 0\nVERTEX_SE2 4 0 0 0\nEDGE_SE2 9 4 1 0 0" +
      kUnit + "EDGE_SE2 9 3 0 0 0" + kUnit + "EDGE_SE2 4 1 2 0 0" + kUnit + "FIX 9\n");
  EXPECT_THAT(read.ids, ::testing::ElementsAre(1, 4));
  expectPose(read.graph.pose(0), {7, 8, 0});
  ASSERT_EQ(read.graph.edges().size(), 2U) << "that from a vertex to itself is dropped";
  EXPECT_EQ(read.graph.edges()[0].from, 0);
  EXPECT_EQ(read.graph.edges()[1].to, 0);
  EXPECT_TRUE(read.graph.isFixed(0));
}

TEST(MrptGraph, MrptReadsWhatWeWriteAndWeWhatItWrites) {
  const testing::TempFolder folder;
  const PoseGraph graph = testing::driveOnGrid(60, 3).graph;
  std::vector<long long> ids;
  ids.reserve(static_cast<size_t>(graph.nodeCount()));
  for (int node = 0; node < graph.nodeCount(); ++node) ids.push_back(10 + 3 * node);
  writeMrptGraphFile(graph, ids, folder / "ours.graph");
  mrpt::graphs::CNetworkOfPoses2DInf theirs;
  theirs.loadFromTextFile(folder / "ours.graph");
  ASSERT_EQ(theirs.nodes.size(), ids.size());
  ASSERT_EQ(theirs.edgeCount(), graph.edges().size());
  for (size_t i = 0; i < ids.size(); ++i) {
    const auto& pose = theirs.nodes.at(static_cast<mrpt::graphs::TNodeID>(ids[i]));
    EXPECT_EQ(pose.x(), graph.poses()[i].x);
    EXPECT_NEAR(pose.phi(), graph.poses()[i].phi, 1e-15);
  }
  for (const Edge& edge : graph.edges()) {
    const auto found =
        theirs.edges.find({static_cast<mrpt::graphs::TNodeID>(ids[static_cast<size_t>(edge.from)]),
                           static_cast<mrpt::graphs::TNodeID>(ids[static_cast<size_t>(edge.to)])});
    ASSERT_NE(found, theirs.edges.end());
    EXPECT_EQ(found->second.mean.y(), edge.T_from_to.y);
    EXPECT_EQ(found->second.cov_inv.asEigen(), edge.information);
  }

  theirs.root = 10;
  theirs.saveToTextFile(folder / "theirs.graph");
  const G2oGraph read = readG2oFile(folder / "theirs.graph");
  EXPECT_EQ(read.ids, ids);
  EXPECT_TRUE(read.graph.isFixed(0));
  EXPECT_TRUE(read.passed_over.empty());
  EXPECT_EQ(read.graph.edges().size(), graph.edges().size());
  for (size_t i = 0; i < ids.size(); ++i)  // it writes six digits
    EXPECT_NEAR(read.graph.poses()[i].x, graph.poses()[i].x, 1e-4);
}

TEST(MrptGraph, TheGraphsThatMrptShipsAreRead) {
  const std::string path = "/usr/share/mrpt/datasets/graph_2d_circle_50nodes.graph";
  if (!std::ifstream(path)) GTEST_SKIP() << "MRPT's data sets are not here";
  const G2oGraph read = readG2oFile(path);
  EXPECT_EQ(read.graph.nodeCount(), 50);
  EXPECT_EQ(read.graph.edges()[0].information, Eigen::Matrix3d::Identity());
}

TEST(MrptGraph, WhatMrptHasNoPlaceForIsRefused) {
  using ::testing::HasSubstr;
  const testing::TempFolder folder;
  const auto refused = [&](const std::string& text) {
    const G2oGraph read = parsed(text);
    return testing::errorOf([&] { writeMrptGraphFile(read.graph, read.ids, folder / "b.graph"); });
  };
  EXPECT_THAT(refused("EDGE_SE2 -1 1 1 0 0" + kUnit),
              HasSubstr("b.graph: found vertex -1, expected ids of zero and above"));
  EXPECT_THAT(refused("EDGE_PRIOR_SE2 1 1 0 0" + kUnit), HasSubstr("found 1 priors, expected none"));
  EXPECT_THAT(refused("EDGE_SE2 0 1 1 0 0" + kUnit + "FIX 0 1\n"),
              HasSubstr("found 2 fixed vertices, expected one"));
  EXPECT_FALSE(std::ifstream(folder / "b.graph").is_open());
}

}  // namespace
}  // namespace slam::posegraph

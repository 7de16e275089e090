#include "core/vertices/vertex_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/check.h"

namespace rimlight {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Two triangles side by side that share an edge's positions, but not its vertices, and one apart.
VertexMesh split_mesh() {
  VertexMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0},
                    {1, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {9, 9, 9}};
  mesh.triangles = {{0, 1, 2}, {3, 5, 4}, {6, 7, 8}};
  return mesh;
}

TEST(VertexGraph, JoinsWhatTrianglesJoinAcrossSplits) {
  const VertexGraph graph(split_mesh());
  EXPECT_THAT(graph.neighbours(0), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(graph.neighbours(1), ElementsAre(0, 2, 4, 5));
  EXPECT_THAT(graph.neighbours(3), ElementsAre(0, 2, 4, 5));
  EXPECT_THAT(graph.neighbours(5), ElementsAre(1, 2, 3, 4));
}

TEST(VertexGraph, KeepsPiecesApart) {
  const VertexGraph graph(split_mesh());
  EXPECT_THAT(graph.neighbours(6), ElementsAre(7, 8));
  EXPECT_THAT(graph.neighbours(9), IsEmpty()) << "no triangle uses it";
  EXPECT_THAT(graph.neighbours(100), IsEmpty());
  EXPECT_THAT(VertexGraph().neighbours(0), IsEmpty());
}

TEST(VertexGraph, RefusesTrianglesOfMissingVertices) {
  VertexMesh mesh = split_mesh();
  mesh.triangles.push_back({0, 1, 10});
  EXPECT_THROW(VertexGraph{mesh}, CheckFailure);
}

}  // namespace
}  // namespace rimlight

// Growing and smoothing of regions, on a chain of vertices where everything can be told by hand.
#include "core/vertices/interest_region.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "core/vertices/vertex_product_kernel.h"

namespace rimlight {
namespace {

constexpr std::size_t kSums = kLightChannels * kBatchVertices;

std::size_t place(std::size_t packed) {
  return packed / kBatchVertices * kSums + packed % kBatchVertices;
}

/// Vertex v is next to v − 1 and v + 1: flat triangles of which two corners are one vertex.
VertexGraph chain(std::uint32_t count) {
  VertexMesh mesh;
  for (std::uint32_t v = 0; v < count; ++v) {
    mesh.positions.push_back({static_cast<float>(v), 0, 0});
    if (v > 0) mesh.triangles.push_back({v - 1, v, v});
  }
  return VertexGraph(mesh);
}

/// All of a chain, with a base of one.
struct Chain {
  explicit Chain(std::uint32_t count = 200) : graph(chain(count)) {
    std::vector<std::uint32_t> all(count);
    std::iota(all.begin(), all.end(), 0u);
    selection.select_vertices(all);
    base.assign(selection.panel_count() * kSums, 1.0f);
    light = base;
    region.reset(selection);
  }
  FilteredLight filtered() { return {base, light}; }

  VertexGraph graph;
  VertexSelection selection;
  std::vector<float> base, light;
  InterestRegion region;
};

/// The full light differs from the base by 1 − vertex/100, and counts how often it is asked for.
struct FullLight {
  std::vector<int> asked = std::vector<int>(400);
  InterestRegion::Calculate calculate() {
    return [this](const VertexSelection& some, std::span<float> to) {
      for (std::size_t panel = 0; panel < some.panel_count(); ++panel) {
        some.for_each_vertex(panel, [&](std::size_t vertex, std::size_t lane) {
          ++asked[vertex];
          for (std::size_t c = 0; c < kLightChannels; ++c) to[panel * kSums + c * 64 + lane] = 1;
          to[panel * kSums + 2 * 64 + lane] += 1 - static_cast<float>(vertex) / 100;
        });
      }
    };
  }
};

TEST(InterestRegion, GrowsAsFarAsTheLightDiffersAndAsksOnce) {
  Chain chain;
  chain.region.add(0);
  FullLight full;
  chain.region.refine(chain.graph, 0.295f, full.calculate(), chain.filtered());
  for (std::size_t v = 0; v < 200; ++v) {
    EXPECT_EQ(chain.region.contains(v), v <= 70) << v;
    EXPECT_EQ(full.asked[v], v >= 1 && v <= 71 ? 1 : 0) << v;
  }
  EXPECT_FLOAT_EQ(chain.light[place(70) + 2 * 64], 1.3f);
  EXPECT_FLOAT_EQ(chain.light[place(71) + 2 * 64], 1) << "asked, and left as it was";
  EXPECT_DOUBLE_EQ(chain.region.outside(), 129.0 / 200);
}

TEST(InterestRegion, DoesNotCrossWhatIsNotSelected) {
  Chain chain;
  const std::vector<std::uint32_t> some = {0, 1, 2, 4, 5};
  chain.selection.select_vertices(some);
  chain.region.reset(chain.selection);
  chain.region.add(0);
  FullLight full;
  chain.region.refine(chain.graph, 0.1f, full.calculate(), chain.filtered());
  EXPECT_TRUE(chain.region.contains(2));
  EXPECT_FALSE(chain.region.contains(3)) << "vertex 4, behind the gap";
  EXPECT_EQ(full.asked[3], 0);
}

TEST(InterestRegion, SmoothsTwoTiersLinearly) {
  Chain chain;
  chain.region.add(10);
  chain.light[place(10)] = 1 + 9;
  chain.light[place(11)] = 1 + 3;
  chain.region.smooth(chain.graph, chain.filtered());
  EXPECT_FLOAT_EQ(chain.light[place(10)], 10) << "inside";
  EXPECT_FLOAT_EQ(chain.light[place(9)], 1 + 6) << "two thirds of 9";
  EXPECT_FLOAT_EQ(chain.light[place(11)], 1 + 3 + 4) << "two thirds of the way from 3 to 9";
  EXPECT_FLOAT_EQ(chain.light[place(8)], 1 + 2) << "a third of 6";
  EXPECT_FLOAT_EQ(chain.light[place(7)], 1);
  EXPECT_FLOAT_EQ(chain.light[place(13)], 1);
}

TEST(InterestRegion, OfNothingOrEverythingHasNoBoundary) {
  Chain chain;
  FullLight full;
  const std::vector<float> before = chain.light;
  chain.region.refine(chain.graph, 0, full.calculate(), chain.filtered());
  chain.region.smooth(chain.graph, chain.filtered());
  EXPECT_EQ(chain.light, before);
  EXPECT_EQ(chain.region.outside(), 1);
  for (std::size_t v = 0; v < 200; ++v) chain.region.add(v);
  chain.region.refine(chain.graph, 0, full.calculate(), chain.filtered());
  chain.region.smooth(chain.graph, chain.filtered());
  EXPECT_EQ(chain.light, before);
  EXPECT_EQ(chain.region.outside(), 0);
  EXPECT_THAT(full.asked, testing::Each(0));
}

}  // namespace
}  // namespace rimlight

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/half.h"
#include "core/basis/sh.h"
#include "core/math/vec.h"

namespace rimlight {

/// Vertices as receivers are stored in batches: what a kernel works on while it stays in the
/// first-level cache. The last batch is padded with vertices that stay black.
inline constexpr std::size_t kBatchVertices = 64;

constexpr std::size_t batch_count(std::size_t vertices) {
  return (vertices + kBatchVertices - 1) / kBatchVertices;
}

/// Where vertices are and how they join. A vertex has one material; where two meet it is split.
/// Vertices that have a highlight come first.
struct VertexMesh {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;                           // unit, of shading
  std::vector<std::array<std::uint32_t, 3>> triangles;  // of vertices
  std::vector<std::uint32_t> materials;                 // [vertex]
  std::vector<Vec3f> tints;  // [vertex]: multiplies the material's albedo (its texture); 1 else
};

/// What a vertex reflects, and a session may edit. Its radiance in a direction ω_o is
///
///     tint · albedo / π · irradiance  +  highlight · (lobe ∗ (L · visibility))(mirrored ω_o)
///
/// (Lee 2014, eqs. 4.2 and 4.4), the lobe (s + 1)/2π · max(0, cos α)^s about the mirror direction.
struct VertexMaterial {
  std::string name;
  Vec3f albedo{0.5f, 0.5f, 0.5f};
  Vec3f highlight{0, 0, 0};
  double exponent = 50;  // s
};

/// Transport of a mesh's vertices in spherical harmonics (convention: sh.h). A view of memory that
/// its owner keeps alive; numbers are finite. Any thread.
struct VertexTransportView {
  std::size_t vertex_count = 0;
  std::size_t highlight_count = 0;  // the first so many vertices have a highlight
  int irradiance_degree = 0;
  int visibility_degree = 0;
  /// 1 where all light that arrives has the colour it left the sky with; 3 where it was reflected
  /// by coloured surfaces before; 0 where nothing stands in its way and nothing is stored: then it
  /// follows from the normals.
  std::size_t irradiance_channels = 1;
  /// Irradiance at a vertex under each harmonic, indirect light included:
  /// [batch][channel][(n + 1)²][kBatchVertices].
  std::span<const Half> irradiance;
  /// Visibility of the sky, not weighted by the cosine, above the vertex' tangent plane:
  /// [batch of the highlight_count][(n + 1)²][kBatchVertices].
  std::span<const Half> visibility;
  /// [vertex], unit; needed only where irradiance follows from them.
  std::span<const Vec3f> normals = {};
};

}  // namespace rimlight

#pragma once

#include <vector>

#include "core/relight/design_state.h"
#include "core/vertices/vertex_scene.h"

namespace rimlight::reference {

/// A pixel of a scene of vertices, in double, without harmonics of the light: radiance by
/// quadrature of light × visibility × lobe over the texels of the environment's cube map.
struct VertexPixel {
  Vec3d radiance;        // of the surfaces alone
  double coverage = 0;   // share of the points that hit
  double magnitude = 0;  // Σ |summand|: what rounding scales with
  bool is_safe = true;   // no ray passes so close to an edge that floats may decide otherwise
};

class VertexImage {
 public:
  /// `light_size`: of the cube map. Materials are the scene's with the state's edits.
  VertexImage(const VertexScene& scene, const DesignState& state, int light_size);

  VertexPixel pixel(int x, int y) const;

 private:
  struct Texel {
    Vec3d direction;  // turned
    Vec3d flux;       // radiance · solid angle
  };
  void add_point(double x, double y, double share, VertexPixel& pixel) const;

  const VertexScene& scene_;
  Camera camera_;
  std::vector<VertexMaterial> materials_;
  std::vector<Texel> texels_;
};

}  // namespace rimlight::reference

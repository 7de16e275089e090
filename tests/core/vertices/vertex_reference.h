#pragma once

#include <optional>
#include <vector>

#include "core/light/sun_and_sky.h"
#include "core/relight/design_state.h"
#include "core/vertices/vertex_scene.h"

namespace rimlight::reference {

/// A pixel of a scene of vertices, in double, without harmonics of the light: radiance by
/// quadrature of light × visibility × lobe over the texels of the environment's cube map. A sun
/// that the scene wants apart is a direction, with a shadow by trying all triangles.
struct VertexPixel {
  Vec3d radiance;        // of the surfaces alone
  double sun = 0;        // share of the points that a sun lights
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
  struct SurfacePoint {
    std::size_t triangle;
    double weights[3];
    Vec3d normal, mirrored;  // unit
  };
  void add_sun(const SurfacePoint& at, double share, VertexPixel& pixel) const;
  void add_point(double x, double y, double share, VertexPixel& pixel) const;

  const VertexScene& scene_;
  Camera camera_;
  std::vector<VertexMaterial> materials_;
  std::vector<Texel> texels_;
  std::optional<Sun> sun_;  // turned
};

}  // namespace rimlight::reference

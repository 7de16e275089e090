#pragma once

#include <span>

#include "core/relight/tile_image.h"
#include "core/vertices/sun_shadows.h"
#include "core/vertices/vertex_lighting.h"
#include "core/vertices/vertex_materials.h"
#include "core/vertices/vertex_view.h"

namespace rimlight {

/// What pixels are made of.
struct VertexShading {
  const VertexMesh& mesh;
  const VertexView& view;
  std::span<const Vec3f> diffuse;  // [vertex]: radiance, of those that the view needs
  const VertexLighting& lighting;  // of those that have a highlight
  const VertexMaterials& materials;
  int visibility_degree;
  const Sun* sun;  // or null; then its shadows are not looked at
  const SunShadows& shadows;
};

/// The radiance of a tile's pixels, its upper left corner at (left, top), black outside the image:
/// diffuse radiance interpolated from vertices; to it the highlight, the light that arrives
/// interpolated, convolved with the lobe, at the mirrored direction (Lee 2014, eq. 4.4); to both
/// the sun's, if there is one. Answers Σ of its squares. Any thread; allocates nothing after each
/// thread's first tile.
double shade_tile(const VertexShading& shading, int left, int top, TileImage& image);

/// The pixels of even x and y to the three beside and below: what a coarse view shows.
void spread_known(TileImage& image);
double sum_of_squares(const TileImage& image);

}  // namespace rimlight

#pragma once

#include "core/scene/scene.h"
#include "core/transport/vertex_transport.h"

namespace rimlight {

/// A scene's material as vertices have it: a Lambert part and a Phong lobe about the mirror
/// direction. At every vertex, albedo + highlight ≤ 1 in each channel.
///
///   lambert        as it is
///   phong          as it is: highlight = specular, which the scene's lobe reflects at normal
///                  incidence
///   the others     an approximation, by quadrature at normal incidence. With the lobe's weight
///                  f cos θ dω over the directions that are reflected, α from the mirror direction:
///                    highlight = ∫ f cos θ dω                    (what it reflects, each channel)
///                    s         = (2g − 1)/(1 − g),  g = ⟨cos α⟩  (the Phong lobe of the same mean
///                                                                 cosine: its own is (s + 1)/(s +
///                                                                 2)), within [1, 1e5]
///                    albedo    = ∫ of the diffuse part over both hemispheres, per unit of flux
///                  The growth of gloss at grazing angles is left out, and so is its stretching.
///   subsurface     albedo times what a flat surface of the medium reflects under even light
VertexMaterial vertex_material(const Material& material);

}  // namespace rimlight

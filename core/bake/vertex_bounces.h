#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/bake/vertex_gather.h"
#include "core/bake/vertex_subsurface.h"

namespace rimlight {

/// What a vertex reflects to others is at most this, so that light between surfaces comes to an
/// end.
inline constexpr float kMostBouncedAlbedo = 0.9999f;

/// Terms of a series. Light inside a sphere with an opening of f of its surface falls by 1 − f from
/// one to the next: so many leave 2 % for an f of 0.1 %, and say so.
inline constexpr int kMostBounces = 4096;

/// What vertices reflect to each other, [vertex]: tint · albedo + highlight, at most that a
/// channel. A highlight's light counts as evenly spread.
std::vector<Vec3f> bounced_albedo(const VertexMesh& mesh,
                                  std::span<const VertexMaterial> materials);

/// All light at the vertices in one channel, by way of others included,
///
///     E = S (D + G ρ E) = Σ_k (S G ρ)^k S D
///
/// with the gather matrix G, the albedo ρ and the spreading S below surfaces. The series is summed
/// until what is left of it is below `error`, in rms of any vertex' coefficients: bounded by the
/// last term · q/(1 − q), q the largest row sum of G ρ (S makes no light).
struct Bounces {
  int count = 0;    // terms summed, kMostBounces at most
  double left = 0;  // the bound on what is left: above `error` where the terms were too few
};

/// `irradiance` [vertex][coefficients]: D, replaced by E. An empty matrix leaves S D.
Bounces add_bounces(const GatherMatrix& matrix, std::span<const float> albedo,
                    const SubsurfaceSpread& spread, int channel, std::size_t coefficients,
                    double error, std::vector<float>& irradiance);

}  // namespace rimlight

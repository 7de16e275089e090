#pragma once

#include <functional>
#include <vector>

#include "core/material/brdf_curve.h"

namespace rimlight {

/// The share of its light that a surface reflects, by direction: ∫ f cos θ_i dω_i at several cos
/// θ_o.
struct DirectionalAlbedo {
  double cosine = 1;  // cos θ_o
  Vec3d albedo;
};

/// Isotropic BRDFs in double, directions as in brdf.h.
using IsotropicBrdf = std::function<Vec3d(const Vec3d& in, const Vec3d& out)>;

/// By quadrature over half vectors: the 256 bins of θ_h, each with `points` Gauss–Legendre points,
/// and 2 · 48 steps of φ_h by symmetry; so lobes down to one bin, and curves with jumps between
/// bins, are resolved. Broad BRDFs are right to 5e-3, at grazing
/// angles to 2 % (the horizon cuts the grid). Ten
/// cosines, from 1 to 0.02. About 1 M evaluations of f for 4 points.
std::vector<DirectionalAlbedo> directional_albedos(const IsotropicBrdf& f, int points = 4);

/// The same for a material with drawn curves; an anisotropic one is an error of the caller
/// (CheckFailure).
std::vector<DirectionalAlbedo> directional_albedos(const CurvedBrdf& brdf);

/// The largest of all channels and angles. Above 1 (allow 1e-2 for the quadrature) the material
/// makes light from nothing.
double largest_albedo(const std::vector<DirectionalAlbedo>& albedos);

}  // namespace rimlight

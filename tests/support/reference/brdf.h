#pragma once

#include <complex>

#include "core/material/brdf.h"
#include "core/math/vec.h"

namespace rimlight::reference {

/// Unpolarised Fresnel reflectance of a complex index, from the field amplitudes themselves.
double fresnel(std::complex<double> index, double cosine);

/// Beckmann's distribution of half vectors at a polar angle of the given cosine.
double beckmann(double roughness, double cosine);

/// The specular lobe of one channel as brdf.h states it, in double and straight from the formulas.
double specular(const Brdf& brdf, int channel, const Vec3d& in, const Vec3d& out);

/// ∫ specular(in, out) cos θ_i dω_i, by quadrature over directions about the mirror (phong)
/// or over half vectors (the others), where the integrand is smooth.
double specular_albedo(const Brdf& brdf, int channel, const Vec3d& out, int steps);

}  // namespace rimlight::reference

#pragma once

#include "server/session/scene_catalog.h"

namespace rimlight::server::test {

/// A scene whose BRDFs are edited, in closed form: a sphere under one distant light that the
/// state's rotation turns. From the left: "pearl" (cook_torrance), "red & blue" (blinn_phong),
/// "brushed" (ward), which may load the measured "gold".
ServedScene curve_sphere_scene(const std::string& name, int side);

/// The material with what was edited of it.
CurvedBrdf edited(const CurveMaterial& material, const MaterialEdit& edit);

/// H(θ_h) a lobe, Δ(θ_d) and P slowly falling.
FactoredBrdf made_up_measured();

}  // namespace rimlight::server::test

#pragma once

#include <filesystem>

namespace rimlight::test {

/// Bakes a ball "pearl" of Cook–Torrance and one "wax" of Blinn–Phong on a matt floor, of kind
/// brdf_curve, 48 × 48 pixels under 6 × 8 × 8 texels of "studio" and "sunny". About a second.
void bake_balls_with_curves(const std::filesystem::path& folder);

}  // namespace rimlight::test

#include "tests/support/curve_bake.h"

#include <memory>

#include "core/bake/image_bake.h"
#include "core/scene/scene_source.h"

namespace rimlight::test {
namespace {

constexpr const char* kScene = R"({ "name": "balls",
  "camera": { "position": [0, 1.2, 3.4], "target": [0, 0.4, 0], "field_of_view": 32 },
  "materials": {
    "floor": { "model": "lambert", "albedo": 0.5 },
    "pearl": { "model": "cook_torrance", "albedo": [0.4, 0.35, 0.3], "roughness": 0.3, "eta": 1.6 },
    "wax": { "model": "blinn_phong", "albedo": [0.5, 0.1, 0.1], "specular": 0.2, "exponent": 40 } },
  "objects": [
    { "shape": "plane", "size": [5, 5], "material": "floor" },
    { "shape": "sphere", "radius": 0.5, "translate": [-0.55, 0.5, 0], "material": "pearl" },
    { "shape": "sphere", "radius": 0.5, "translate": [0.55, 0.5, 0], "material": "wax" } ],
  "environments": ["studio", "sunny"],
  "bake": { "kind": "brdf_curve", "width": 48, "height": 48, "cube_size": 8, "bounces": 0,
            "primary_rays": 4, "psnr_db": 30 } })";

}  // namespace

void bake_balls_with_curves(const std::filesystem::path& folder) {
  bake_curves(std::make_shared<const Scene>(parse_scene(kScene, "balls", ".")), folder, {});
}

}  // namespace rimlight::test

#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "core/bake/transport_bake.h"
#include "core/scene/scene.h"

namespace rimlight {

/// Bakes a scene's image-space transport in the cube Haar basis to `folder` (NAME.bake), as
/// bake_transport() does. Throws Error when the camera sees nothing.
BakeSummary bake_image(const std::shared_ptr<const Scene>& scene,
                       const std::filesystem::path& folder,
                       const std::function<void(const BakeProgress&)>& progress);

/// The same without the direct light of editable materials (find_editable_materials); kept instead
/// is what follows their curves: a bake of kind brdf_curve. Throws Error when there is none of them
/// in the picture.
BakeSummary bake_curves(const std::shared_ptr<const Scene>& scene,
                        const std::filesystem::path& folder,
                        const std::function<void(const BakeProgress&)>& progress);

}  // namespace rimlight

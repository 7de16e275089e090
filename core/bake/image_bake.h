#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "core/scene/scene.h"

namespace rimlight {

/// Told as a bake goes on, from one thread.
struct BakeProgress {
  std::string stage;     // "tracing", "compressing", …
  double fraction = 0;   // of the stage, in [0, 1]
  bool resumed = false;  // this step was found done
};

struct BakeSummary {
  double seconds = 0;
  std::size_t resumed_tiles = 0;
  std::size_t bytes = 0;     // of stored transport
  double worst_psnr_db = 0;  // of the compressed transport, over the check lights
  std::string worst_light;
};

/// Bakes a scene's image-space transport in the cube Haar basis to `folder` (NAME.bake). Uses all
/// cores; memory is bounded by one group of dense rows a core and one tile of what is kept. An
/// interrupted bake of the same scene and settings resumes at the last finished tile of 64×64
/// pixels; the bytes do not depend on threads or interruptions. The compression is chosen so that
/// every check light keeps the scene's psnr_db against the uncompressed transport. Throws Error
/// when the scene shows nothing, or when the folder cannot be written.
BakeSummary bake_image(const std::shared_ptr<const Scene>& scene,
                       const std::filesystem::path& folder,
                       const std::function<void(const BakeProgress&)>& progress);

}  // namespace rimlight

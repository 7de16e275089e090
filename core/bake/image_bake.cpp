#include "core/bake/image_bake.h"

#include "core/bake/fingerprint.h"
#include "core/bake/group_baker.h"
#include "core/scene/ray_scene.h"

namespace rimlight {

BakeSummary bake_image(const std::shared_ptr<const Scene>& scene,
                       const std::filesystem::path& folder,
                       const std::function<void(const BakeProgress&)>& progress) {
  const RayScene rays(scene);
  const BakeSettings& bake = scene->bake;
  return bake_transport(GroupBaker(rays),
                        {.scene = scene->name,
                         .camera = scene->camera,
                         .environments = scene->environments,
                         .settings = {{"primary_rays", bake.primary_rays},
                                      {"bounces", bake.bounces},
                                      {"psnr_db", bake.psnr_db},
                                      {"seed", bake.seed}},
                         .psnr_db = bake.psnr_db,
                         .seed = bake.seed,
                         .reference_receivers = bake.reference_receivers,
                         .fingerprint = fingerprint(*scene)},
                        folder, progress);
}

}  // namespace rimlight

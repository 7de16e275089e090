#include "core/bake/image_bake.h"

#include <optional>

#include "core/bake/fingerprint.h"
#include "core/bake/group_baker.h"
#include "core/basis/cube_map.h"
#include "core/math/random.h"
#include "core/scene/ray_scene.h"

namespace rimlight {
namespace {

/// The streams of this seed have nothing to do with those of the scene's own.
BakeSettings with_another_seed(BakeSettings settings) {
  settings.seed = mix_bits(settings.seed);
  return settings;
}

BakeSettings with_finer_texels(BakeSettings settings) {
  settings.cube_size *= 2;
  return settings;
}

}  // namespace

BakeSummary bake_image(const std::shared_ptr<const Scene>& scene,
                       const std::filesystem::path& folder,
                       const std::function<void(const BakeProgress&)>& progress) {
  const RayScene rays(scene);
  const BakeSettings& bake = scene->bake;
  const GroupBaker baker(rays), retraced(rays, with_another_seed(bake));
  std::optional<GroupBaker> finer;
  if (2 * bake.cube_size <= cube::kLargestSize) finer.emplace(rays, with_finer_texels(bake));
  return bake_transport(baker,
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
                         .fingerprint = fingerprint(*scene),
                         .retraced = &retraced,
                         .finer = finer ? &*finer : nullptr},
                        folder, progress);
}

}  // namespace rimlight

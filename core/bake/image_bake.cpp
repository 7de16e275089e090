#include "core/bake/image_bake.h"

#include <optional>
#include <utility>

#include "core/bake/curve_surfaces.h"
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

/// The transport of a scene's pixels, the direct light of surfaces of `direct` in it.
BakeSummary bake_pixels(const RayScene& rays, const MaterialSet& direct, const CurvePart* curves,
                        std::uint64_t fingerprint, const std::filesystem::path& folder,
                        const std::function<void(const BakeProgress&)>& progress) {
  const Scene& scene = rays.scene();
  const BakeSettings& bake = scene.bake;
  const GroupBaker baker(rays, bake, direct);
  const GroupBaker retraced(rays, with_another_seed(bake), direct);
  std::optional<GroupBaker> finer;
  if (2 * bake.cube_size <= cube::kLargestSize) {
    finer.emplace(rays, with_finer_texels(bake), direct);
  }
  return bake_transport(baker,
                        {.scene = scene.name,
                         .camera = scene.camera,
                         .environments = scene.environments,
                         .settings = {{"primary_rays", bake.primary_rays},
                                      {"bounces", bake.bounces},
                                      {"psnr_db", bake.psnr_db},
                                      {"seed", bake.seed}},
                         .psnr_db = bake.psnr_db,
                         .seed = bake.seed,
                         .reference_receivers = bake.reference_receivers,
                         .fingerprint = fingerprint,
                         .retraced = &retraced,
                         .finer = finer ? &*finer : nullptr,
                         .curves = curves},
                        folder, progress);
}

}  // namespace

BakeSummary bake_image(const std::shared_ptr<const Scene>& scene,
                       const std::filesystem::path& folder,
                       const std::function<void(const BakeProgress&)>& progress) {
  return bake_pixels(RayScene(scene), {}, nullptr, fingerprint(*scene), folder, progress);
}

BakeSummary bake_curves(const std::shared_ptr<const Scene>& scene,
                        const std::filesystem::path& folder,
                        const std::function<void(const BakeProgress&)>& progress) {
  const EditableMaterials editable = find_editable_materials(*scene);
  const RayScene rays(scene);
  std::vector<CubeLight> lights;
  for (const Environment& environment : scene->environments) {
    lights.push_back(environment.project(scene->bake.cube_size));
  }
  CurveSurfaces found = find_curve_surfaces(rays, editable, lights, [&](double fraction) {
    if (progress) progress({"seeing the sky", fraction, false});
  });
  CurvePart part;
  part.materials = editable.materials;
  for (const MeasuredReflection& each : scene->measured) {
    part.measured.push_back(
        {.name = each.name, .brdf = {.albedo = {}}, .measured = each.lobe->factors()});
  }
  part.images = std::move(found.images);
  part.receivers = {part.materials, part.measured, found.surfaces, found.visibility.view()};
  std::uint64_t apart = fingerprint(*scene);
  for (const std::uint32_t index : editable.index) apart = mix_bits(apart ^ index);
  return bake_pixels(rays, editable.set().others(), &part, apart, folder, progress);
}

}  // namespace rimlight

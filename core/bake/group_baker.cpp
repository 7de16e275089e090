#include "core/bake/group_baker.h"

#include <algorithm>

#include "core/bake/lane_kernel.h"

namespace rimlight {
namespace {

IndirectSettings indirect_settings(const BakeSettings& settings) {
  IndirectSettings result;
  result.cube_size = settings.cube_size;
  result.bounces = settings.bounces;
  return result;
}

}  // namespace

GroupBaker::GroupBaker(const RayScene& scene, const std::vector<CheckLight>& check_lights)
    : scene_(scene),
      layout_{scene.scene().bake.width, scene.scene().bake.height},
      haar_(scene.scene().bake.cube_size),
      direct_(scene, haar_.size()),
      indirect_(scene, indirect_settings(scene.scene().bake)) {
  for (const CheckLight& light : check_lights) check_lights_.push_back(light.coefficients);
}

bool GroupBaker::sees_geometry(std::size_t first_receiver) const {
  const BakeSettings& settings = scene_.scene().bake;
  GroupSamples samples;
  sample_group(scene_, layout_, first_receiver, settings.primary_rays, settings.seed, samples);
  return !samples.empty();
}

void GroupBaker::bake(std::size_t first_receiver, BakedGroup& group) const {
  const BakeSettings& settings = scene_.scene().bake;
  sample_group(scene_, layout_, first_receiver, settings.primary_rays, settings.seed,
               group.samples_);
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    group.coverage[lane] = group.samples_.coverage(lane);
  }
  group.empty = group.samples_.empty();
  if (group.empty) {
    std::fill(group.check_images.begin(), group.check_images.end(), 0.0f);
    return;
  }
  const std::uint64_t seed = mix_bits(settings.seed ^ mix_bits(first_receiver));
  std::fill(group.texels_.values.begin(), group.texels_.values.end(), 0.0f);
  direct_.add(group.samples_, seed, group.texels_);
  indirect_.add(group.samples_, seed, group.texels_);
  haar_.forward(group.texels_.values, group.coefficients.values, kRowLanes);
  multiply_rows(group.coefficients, check_lights_, group.check_images.data());
}

}  // namespace rimlight

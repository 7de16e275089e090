#include "core/bake/group_baker.h"

#include <algorithm>
#include <memory>

#include "core/math/random.h"

namespace rimlight {
namespace {

IndirectSettings indirect_settings(const BakeSettings& settings) {
  IndirectSettings result;
  result.cube_size = settings.cube_size;
  result.bounces = settings.bounces;
  return result;
}

}  // namespace

GroupBaker::GroupBaker(const RayScene& scene, const BakeSettings& settings,
                       const MaterialSet& direct)
    : scene_(scene),
      settings_(settings),
      layout_{settings.width, settings.height},
      haar_(settings.cube_size),
      direct_(scene, haar_.size(), direct),
      indirect_(scene, indirect_settings(settings)) {}

bool GroupBaker::has_receivers(std::size_t first_receiver) const {
  GroupSamples samples;
  sample_group(scene_, layout_, first_receiver, settings_.primary_rays, settings_.seed, samples);
  return !samples.empty();
}

void GroupBaker::find_rows(std::size_t first_receiver, BakedGroup& group) const {
  thread_local GroupSamples samples;
  sample_group(scene_, layout_, first_receiver, settings_.primary_rays, settings_.seed, samples);
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    group.coverage[lane] = samples.coverage(lane);
  }
  group.empty = samples.empty();
  if (group.empty) return;
  thread_local std::unique_ptr<GroupRows> texels;
  if (texels == nullptr || texels->cube_size != haar_.size()) {
    texels = std::make_unique<GroupRows>(haar_.size());
  }
  const std::uint64_t seed = mix_bits(settings_.seed ^ mix_bits(first_receiver));
  std::fill(texels->values.begin(), texels->values.end(), 0.0f);
  direct_.add(samples, seed, *texels);
  indirect_.add(samples, seed, *texels);
  haar_.forward(texels->values, group.coefficients.values, kRowLanes);
}

}  // namespace rimlight

#include "core/import/resampling_error.h"

#include <array>
#include <cstddef>

#include "core/bake/group.h"
#include "core/bake/lane_kernel.h"
#include "core/base/aligned_vector.h"
#include "core/base/parallel.h"
#include "core/image/metrics.h"

namespace rimlight {
namespace {

using Image = std::vector<Vec3f>;

struct ImagePair {
  Image direct, resampled;
};

void add_image(std::span<const float> rows, const std::vector<Vec3f>& light, Vec3f* image) {
  alignas(64) std::array<float, kRowLanes> sum{};
  for (std::size_t direction = 0; direction < light.size(); ++direction) {
    add_weighted_lanes(rows.data() + direction * kRowLanes, light[direction], sum.data());
  }
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    image[lane] = {sum[lane], sum[kGroupLanes + lane], sum[2 * kGroupLanes + lane]};
  }
}

Image covered(const Image& image, std::span<const float> coverage) {
  Image result;
  for (std::size_t receiver = 0; receiver < image.size(); ++receiver) {
    if (coverage[receiver] > 0) result.push_back(image[receiver]);
  }
  return result;
}

}  // namespace

std::vector<ResamplingError> measure_resampling(const TransportSource& source,
                                                std::span<const float> coverage,
                                                const std::vector<ResampledLight>& lights) {
  const std::size_t receivers = source.pixels().receiver_count();
  std::vector<ImagePair> images(lights.size());
  for (ImagePair& pair : images) pair = {Image(receivers), Image(receivers)};
  parallel_for(receivers / kGroupLanes, [&](std::size_t group) {
    AlignedVector<float> rows(source.direction_count() * kRowLanes);
    const std::size_t first = group * kGroupLanes;
    source.read_group(first, rows);
    for (std::size_t i = 0; i < lights.size(); ++i) {
      add_image(rows, lights[i].direct, images[i].direct.data() + first);
      add_image(rows, lights[i].resampled, images[i].resampled.data() + first);
    }
  });
  std::vector<ResamplingError> errors;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const Image direct = covered(images[i].direct, coverage);
    const Image resampled = covered(images[i].resampled, coverage);
    errors.push_back({lights[i].name, relative_l2(resampled, direct),
                      display_psnr(resampled, direct, auto_exposure_scale(direct))});
  }
  return errors;
}

}  // namespace rimlight

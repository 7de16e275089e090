#include "core/transport/reference_rows.h"

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/transport/bake_tensors.h"

namespace rimlight {
namespace {

constexpr std::size_t kLanes = PixelLayout::kGroupReceivers;
constexpr std::size_t kRowFloats = 3 * kLanes;

void check_groups(std::span<const std::uint64_t> groups, const std::string& path,
                  std::size_t receivers) {
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (groups[i] % kLanes == 0 && groups[i] < receivers && (i == 0 || groups[i] > groups[i - 1])) {
      continue;
    }
    throw Error(path + ": tensor \"first_receiver\", element " + std::to_string(i),
                std::to_string(groups[i]), "ascending first receivers of groups of the picture");
  }
}

/// sum[c][lane] += weight[c] · row[c][lane].
void add_row(const float* row, const Vec3f& weight, double* sum) {
  for (std::size_t c = 0; c < 3; ++c) {
    const double of_channel = weight[static_cast<int>(c)];
    for (std::size_t i = c * kLanes; i < (c + 1) * kLanes; ++i) {
      sum[i] += of_channel * static_cast<double>(row[i]);
    }
  }
}

}  // namespace

std::vector<TensorShape> reference_tensors(std::size_t group_count, std::size_t column_count) {
  return {{"first_receiver", ElementType::u64, {group_count}},
          {"rows", ElementType::f32, {group_count, column_count, 3, kLanes}}};
}

std::optional<ReferenceRows> ReferenceRows::open(const Bake& bake) {
  const TensorFile* const file = bake.find_file(kReferenceFile);
  if (file == nullptr) return std::nullopt;
  ReferenceRows result;
  result.path_ = (bake.folder() / kReferenceFile).string();
  result.columns_ = bake.transport().column_count();
  result.groups_ = file->tensor<std::uint64_t>("first_receiver", ElementType::u64);
  for (const TensorShape& tensor : reference_tensors(result.groups_.size(), result.columns_)) {
    expect_shape(*file, result.path_, tensor.name, tensor.shape);
  }
  check_groups(result.groups_, result.path_, bake.manifest().pixels.receiver_count());
  result.rows_ = file->tensor<float>("rows", ElementType::f32);
  return result;
}

void ReferenceRows::multiply_group(std::size_t group, std::span<const CubeLight> lights,
                                   std::vector<std::vector<Vec3f>>& images) const {
  std::vector<double> sums(lights.size() * kRowFloats);
  const float* row = rows_.data() + group * columns_ * kRowFloats;
  for (std::size_t column = 0; column < columns_; ++column, row += kRowFloats) {
    for (std::size_t light = 0; light < lights.size(); ++light) {
      add_row(row, lights[light].at(column), sums.data() + light * kRowFloats);
    }
  }
  for (std::size_t light = 0; light < lights.size(); ++light) {
    const double* const sum = sums.data() + light * kRowFloats;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Vec3f radiance = {static_cast<float>(sum[lane]), static_cast<float>(sum[kLanes + lane]),
                              static_cast<float>(sum[2 * kLanes + lane])};
      if (!is_finite(radiance)) {
        throw Error(path_ + ": tensor \"rows\", group " + std::to_string(group),
                    "a radiance that is not finite", "finite rows");
      }
      images[light][group * kLanes + lane] = radiance;
    }
  }
}

std::vector<std::vector<Vec3f>> ReferenceRows::multiply(std::span<const CubeLight> lights) const {
  for (const CubeLight& light : lights) RIMLIGHT_CHECK_EQ(light.count(), columns_);
  std::vector<std::vector<Vec3f>> images(lights.size(),
                                         std::vector<Vec3f>(groups_.size() * kLanes));
  parallel_for(groups_.size(), [&](std::size_t group) { multiply_group(group, lights, images); });
  return images;
}

}  // namespace rimlight

#include "core/transport/reference_rows.h"

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/transport/bake_tensors.h"

namespace rimlight {
namespace {

constexpr std::size_t kLanes = PixelLayout::kGroupReceivers;
constexpr std::size_t kRowFloats = 3 * kLanes;

struct Names {
  const char* receivers;
  const char* rows;
};
Names names_of(ReferenceRows::Kind kind) {
  switch (kind) {
    case ReferenceRows::Kind::retraced:
      return {"retraced_receiver", "retraced_rows"};
    case ReferenceRows::Kind::finer:
      return {"finer_receiver", "finer_rows"};
    case ReferenceRows::Kind::rows:
      break;
  }
  return {"first_receiver", "rows"};
}

/// Haar coefficients of a band and of all coarser ones are as many as a cube map of that size has
/// texels; its finest band on twice the size as three of those.
constexpr std::size_t kFinerColumns = 3;

void check_groups(std::span<const std::uint64_t> groups, const std::string& tensor,
                  std::size_t receivers) {
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (groups[i] % kLanes == 0 && groups[i] < receivers && (i == 0 || groups[i] > groups[i - 1])) {
      continue;
    }
    throw Error(tensor + ", element " + std::to_string(i), std::to_string(groups[i]),
                "ascending first receivers of groups of the picture");
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

std::vector<TensorShape> reference_tensors(const ReferenceCounts& groups,
                                           std::size_t column_count) {
  std::vector<TensorShape> tensors;
  const auto add = [&](ReferenceRows::Kind kind, std::size_t count, std::size_t columns) {
    const Names names = names_of(kind);
    tensors.push_back({names.receivers, ElementType::u64, {count}});
    tensors.push_back({names.rows, ElementType::f32, {count, columns, 3, kLanes}});
  };
  add(ReferenceRows::Kind::rows, groups.rows, column_count);
  if (groups.retraced > 0) add(ReferenceRows::Kind::retraced, groups.retraced, column_count);
  if (groups.finer > 0) {
    add(ReferenceRows::Kind::finer, groups.finer, kFinerColumns * column_count);
  }
  return tensors;
}

std::optional<ReferenceRows> ReferenceRows::open(const Bake& bake, Kind kind) {
  const TensorFile* const file = bake.find_file(kReferenceFile);
  const Names names = names_of(kind);
  if (file == nullptr || (kind != Kind::rows && !file->has(names.rows))) return std::nullopt;
  const std::string path = (bake.folder() / kReferenceFile).string();
  const std::size_t of_light = bake.transport().column_count();
  ReferenceRows result;
  result.columns_ = kind == Kind::finer ? kFinerColumns * of_light : of_light;
  result.first_column_ = kind == Kind::finer ? of_light : 0;
  result.groups_ = file->tensor<std::uint64_t>(names.receivers, ElementType::u64);
  const std::size_t groups = result.groups_.size();
  expect_shape(*file, path, names.receivers, {groups});
  expect_shape(*file, path, names.rows, {groups, result.columns_, 3, kLanes});
  check_groups(result.groups_, path + ": tensor \"" + names.receivers + "\"",
               bake.manifest().pixels.receiver_count());
  result.rows_ = file->tensor<float>(names.rows, ElementType::f32);
  result.rows_name_ = path + ": tensor \"" + names.rows + "\"";
  return result;
}

void ReferenceRows::multiply_group(std::size_t group, std::span<const CubeLight> lights,
                                   std::vector<std::vector<Vec3f>>& images) const {
  std::vector<double> sums(lights.size() * kRowFloats);
  const float* row = rows_.data() + group * columns_ * kRowFloats;
  for (std::size_t column = 0; column < columns_; ++column, row += kRowFloats) {
    for (std::size_t light = 0; light < lights.size(); ++light) {
      add_row(row, lights[light].at(first_column_ + column), sums.data() + light * kRowFloats);
    }
  }
  for (std::size_t light = 0; light < lights.size(); ++light) {
    const double* const sum = sums.data() + light * kRowFloats;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Vec3f radiance = {static_cast<float>(sum[lane]), static_cast<float>(sum[kLanes + lane]),
                              static_cast<float>(sum[2 * kLanes + lane])};
      if (!is_finite(radiance)) {
        throw Error(rows_name_ + ", group " + std::to_string(group),
                    "a radiance that is not finite", "finite rows");
      }
      images[light][group * kLanes + lane] = radiance;
    }
  }
}

std::vector<std::vector<Vec3f>> ReferenceRows::multiply(std::span<const CubeLight> lights) const {
  for (const CubeLight& light : lights) {
    RIMLIGHT_CHECK_EQ(light.count(), first_column_ + columns_);
  }
  std::vector<std::vector<Vec3f>> images(lights.size(),
                                         std::vector<Vec3f>(groups_.size() * kLanes));
  parallel_for(groups_.size(), [&](std::size_t group) { multiply_group(group, lights, images); });
  return images;
}

}  // namespace rimlight

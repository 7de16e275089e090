#include "core/transport/curve_tensors.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/transport/bake_tensors.h"

namespace rimlight {
namespace {

using Block = SkyVisibilityView::Block;
using MixedBytes = std::array<std::uint8_t, SkyVisibilityView::kMixedBytes>;

constexpr float kLargestTint = 1e6f;
constexpr std::size_t kPointVectors = sizeof(SurfacePoint) / sizeof(Vec3f);
static_assert(kPointVectors == 4);
static_assert(sizeof(Vec3f) == 3 * sizeof(float) && sizeof(Block) == 1);

/// Writes one member of all surfaces.
template <typename T, typename Member>
void append_member(TensorFileWriter& writer, std::span<const CurveSurface> surfaces,
                   const Member& member) {
  std::vector<T> values;
  values.reserve(surfaces.size());
  for (const CurveSurface& surface : surfaces) values.push_back(surface.*member);
  writer.append(std::span<const T>(values));
}

[[noreturn]] void fail(const std::string& path, const std::string& tensor, std::size_t element,
                       const std::string& expected) {
  throw Error(path + ": tensor " + quote(tensor), "element " + std::to_string(element), expected);
}

bool is_unit(const Vec3f& v) { return std::abs(length(v) - 1) < 1e-3f; }

bool is_good(const SurfacePoint& point) {
  return is_unit(point.normal) && is_unit(point.geometric_normal) && is_unit(point.outgoing) &&
         is_finite(point.tangent) && length(point.tangent) < 1e6f;
}

bool is_tint(const Vec3f& v) {
  return is_finite(v) && v.x >= 0 && v.y >= 0 && v.z >= 0 && max_component(v) <= kLargestTint;
}

auto order(const CurveSurface& surface) {
  return std::tuple(surface.receiver / kTileReceivers, surface.material, surface.receiver);
}

void check_surfaces(const std::vector<CurveSurface>& surfaces, const std::string& path,
                    const BakeManifest& manifest) {
  const std::size_t receivers = manifest.pixels.receiver_count();
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const CurveSurface& surface = surfaces[i];
    if (surface.receiver >= receivers) fail(path, "receiver", i, "a receiver of the picture");
    if (surface.material >= manifest.materials.size()) {
      fail(path, "material", i, "one of the manifest's materials");
    }
    if (!(surface.share > 0 && surface.share <= 1)) fail(path, "share", i, "above 0, at most 1");
    if (!is_tint(surface.tint)) fail(path, "tint", i, "finite numbers of 0 to 1e6");
    if (!std::ranges::all_of(surface.points, [](const auto& p) { return is_good(p); })) {
      fail(path, "points", i, "unit vectors");
    }
    if (i > 0 && order(surfaces[i]) < order(surfaces[i - 1])) {
      fail(path, "receiver", i, "surfaces by tile, material and receiver");
    }
  }
}

/// The number of mixed blocks before each surface, as `first` says it.
void check_blocks(const SkyVisibilityView& view, const std::string& path) {
  std::uint64_t count = 0;
  const std::size_t each = view.blocks_per_surface();
  for (std::size_t surface = 0; surface < view.first_mixed.size(); ++surface) {
    if (view.first_mixed[surface] != count) {
      fail(path, "first_mixed", surface, std::to_string(count) + ", as there are mixed blocks");
    }
    if (surface + 1 == view.first_mixed.size()) break;
    for (const Block block : view.blocks.subspan(surface * each, each)) {
      if (block > Block::mixed) fail(path, "blocks", surface * each, "0, 1 or 2");
      if (block == Block::mixed) ++count;
    }
  }
  if (count != view.mixed.size()) {
    fail(path, "mixed", view.mixed.size(), std::to_string(count) + " blocks");
  }
  for (std::size_t i = 0; i < view.mixed.size(); ++i) {
    for (const std::uint8_t two : view.mixed[i]) {
      if ((two & 15u) > SkyVisibilityView::kAll || two >> 4u > SkyVisibilityView::kAll) {
        fail(path, "mixed", i, "fifths of 0 to 5");
      }
    }
  }
}

/// A tensor whose first dimension is known.
template <typename T>
std::span<const T> read_tensor(const TensorFile& file, const std::string& path,
                               const std::string& name, ElementType type,
                               const std::vector<std::size_t>& shape) {
  const auto values = file.tensor<T>(name, type);
  expect_shape(file, path, name, shape);
  return values;
}

void check_factor(std::span<const float> values, const std::string& path, const char* name) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] >= 0) || !std::isfinite(values[i])) {
      fail(path, name, i, "finite numbers of 0 or more");
    }
  }
}

}  // namespace

std::vector<TensorShape> curve_tensors(const CurveReceivers& receivers) {
  const std::size_t surfaces = receivers.surfaces.size(), measured = receivers.measured.size();
  const SkyVisibilityView& sky = receivers.visibility;
  return {{"receiver", ElementType::u32, {surfaces}},
          {"material", ElementType::u32, {surfaces}},
          {"share", ElementType::f32, {surfaces}},
          {"tint", ElementType::f32, {surfaces, 3}},
          {"points", ElementType::f32, {surfaces, kSurfacePoints, kPointVectors, 3}},
          {"blocks", ElementType::u8, {surfaces, sky.blocks_per_surface()}},
          {"first_mixed", ElementType::u64, {surfaces + 1}},
          {"mixed", ElementType::u8, {sky.mixed.size(), SkyVisibilityView::kMixedBytes}},
          {"half_angle", ElementType::f32, {measured, kCurveBins, 3}},
          {"difference_angle", ElementType::f32, {measured, kCurveBins, 3}},
          {"rest", ElementType::f32, {measured, kRestKnots, 3}}};
}

void write_curves(TensorFileWriter& writer, const CurveReceivers& receivers) {
  const auto surfaces = receivers.surfaces;
  RIMLIGHT_CHECK_EQ(receivers.visibility.surface_count(), surfaces.size());
  append_member<std::uint32_t>(writer, surfaces, &CurveSurface::receiver);
  append_member<std::uint32_t>(writer, surfaces, &CurveSurface::material);
  append_member<float>(writer, surfaces, &CurveSurface::share);
  append_member<Vec3f>(writer, surfaces, &CurveSurface::tint);
  append_member<std::array<SurfacePoint, kSurfacePoints>>(writer, surfaces, &CurveSurface::points);
  writer.append(receivers.visibility.blocks);
  writer.append(receivers.visibility.first_mixed);
  writer.append(receivers.visibility.mixed);
  for (const auto& each : receivers.measured) {
    writer.append(std::span<const Vec3f>(each.measured->half_angle.values));
  }
  for (const auto& each : receivers.measured) {
    writer.append(std::span<const Vec3f>(each.measured->difference_angle.values));
  }
  for (const auto& each : receivers.measured) {
    writer.append(std::span<const Vec3f>(each.measured->rest));
  }
}

std::vector<CurveSurface> read_curve_surfaces(const TensorFile& file, const std::string& path,
                                              const BakeManifest& manifest) {
  const auto receiver = file.tensor<std::uint32_t>("receiver", ElementType::u32);
  const std::size_t count = receiver.size();
  expect_shape(file, path, "receiver", {count});
  const auto material =
      read_tensor<std::uint32_t>(file, path, "material", ElementType::u32, {count});
  const auto share = read_tensor<float>(file, path, "share", ElementType::f32, {count});
  const auto tint = read_tensor<Vec3f>(file, path, "tint", ElementType::f32, {count, 3});
  const auto points = read_tensor<std::array<SurfacePoint, kSurfacePoints>>(
      file, path, "points", ElementType::f32, {count, kSurfacePoints, kPointVectors, 3});
  if (count == 0) fail(path, "receiver", 0, "one surface or more");
  std::vector<CurveSurface> surfaces(count);
  for (std::size_t i = 0; i < count; ++i) {
    surfaces[i] = {receiver[i], material[i], share[i], tint[i], points[i]};
  }
  check_surfaces(surfaces, path, manifest);
  return surfaces;
}

SkyVisibilityView read_sky_visibility(const TensorFile& file, const std::string& path,
                                      const BakeManifest& manifest, std::size_t surface_count) {
  if (manifest.cube_size % SkyVisibilityView::kBlockSide != 0) {
    throw Error(path, "a cube map of " + std::to_string(manifest.cube_size),
                "at least " + std::to_string(SkyVisibilityView::kBlockSide));
  }
  SkyVisibilityView view;
  view.cube_size = manifest.cube_size;
  view.blocks = read_tensor<Block>(file, path, "blocks", ElementType::u8,
                                   {surface_count, view.blocks_per_surface()});
  view.first_mixed =
      read_tensor<std::uint64_t>(file, path, "first_mixed", ElementType::u64, {surface_count + 1});
  view.mixed = file.tensor<MixedBytes>("mixed", ElementType::u8);
  expect_shape(file, path, "mixed", {view.mixed.size(), SkyVisibilityView::kMixedBytes});
  check_blocks(view, path);
  return view;
}

void read_measured_factors(const TensorFile& file, const std::string& path,
                           BakeManifest& manifest) {
  std::vector<CurveMaterial>& measured = manifest.measured_brdfs;
  const std::size_t count = measured.size();
  const auto read = [&](const char* name, std::size_t values) {
    const auto numbers = read_tensor<float>(file, path, name, ElementType::f32, {count, values, 3});
    check_factor(numbers, path, name);
    return read_tensor<Vec3f>(file, path, name, ElementType::f32, {count, values, 3});
  };
  const auto half = read("half_angle", kCurveBins), rest = read("rest", kRestKnots);
  const auto difference = read("difference_angle", kCurveBins);
  for (std::size_t i = 0; i < count; ++i) {
    FactoredBrdf& factors = *measured[i].measured;
    factors.half_angle.axis = CurveAxis::half_angle;
    factors.difference_angle.axis = CurveAxis::difference_angle;
    std::ranges::copy(half.subspan(i * kCurveBins, kCurveBins), factors.half_angle.values.begin());
    std::ranges::copy(difference.subspan(i * kCurveBins, kCurveBins),
                      factors.difference_angle.values.begin());
    std::ranges::copy(rest.subspan(i * kRestKnots, kRestKnots), factors.rest.begin());
  }
  for (CurveMaterial& material : manifest.materials) {
    if (!material.measured) continue;
    material.measured =
        std::ranges::find(measured, material.measured_name, &CurveMaterial::name)->measured;
  }
}

}  // namespace rimlight

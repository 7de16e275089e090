#include "tests/support/small_curve_bake.h"

#include <algorithm>
#include <string>
#include <tuple>

#include "core/basis/cube_map.h"
#include "core/math/random.h"

namespace rimlight::test {
namespace {

constexpr int kSurfaces = 60;

Vec3f random_rgb(Random& random, double high) {
  const auto value = [&] { return static_cast<float>(random.uniform(0, high)); };
  return {value(), value(), value()};
}

Vec3f random_unit(Random& random) {
  return normalized(random_rgb(random, 1) - Vec3f{0.5f, 0.5f, 0.5f} + Vec3f{0, 0, 0.7f});
}

std::vector<CurveMaterial> random_materials(Random& random) {
  std::vector<CurveMaterial> materials;
  for (const BrdfModel model :
       {BrdfModel::lambert, BrdfModel::phong, BrdfModel::cook_torrance, BrdfModel::blinn_phong,
        BrdfModel::ward, BrdfModel::ashikhmin_shirley}) {
    Brdf brdf;
    brdf.model = model;
    brdf.albedo = random_rgb(random, 0.5);
    brdf.specular = random_rgb(random, 0.5);
    brdf.exponent = static_cast<float>(random.uniform(1, 1e5));
    brdf.exponent_across = static_cast<float>(random.uniform(1, 1e5));
    brdf.roughness = static_cast<float>(random.uniform(1e-4, 1));
    brdf.roughness_across = static_cast<float>(random.uniform(1e-4, 1));
    brdf.eta = random_rgb(random, 99) + Vec3f{0.05f, 0.05f, 0.05f};
    brdf.k = random_rgb(random, 100);
    materials.push_back({"material " + std::to_string(materials.size()), brdf});
  }
  // The ends of what scenes may say, as floats write them.
  materials.front().brdf.roughness = 1e-4f;
  materials.front().brdf.exponent = 1e5f;
  materials.front().brdf.eta = {0.05f, 100, 1};
  return materials;
}

CurveMaterial random_measured(Random& random, const std::string& name) {
  CurveMaterial material{name, {}};
  FactoredBrdf& factors = material.measured.emplace();
  for (Vec3f& value : factors.half_angle.values) value = random_rgb(random, 1e6);
  for (Vec3f& value : factors.difference_angle.values) value = random_rgb(random, 2);
  for (Vec3f& value : factors.rest) value = random_rgb(random, 2);
  factors.error.logarithmic = {0.1, random.uniform(), 0.3};
  factors.error.relative = {random.uniform(), 0.2, 0.1};
  factors.valid_share = random.uniform();
  return material;
}

CurveSurface random_surface(Random& random, const BakeManifest& manifest) {
  CurveSurface surface;
  surface.receiver = static_cast<std::uint32_t>(random.below(manifest.pixels.receiver_count()));
  surface.material = static_cast<std::uint32_t>(random.below(manifest.materials.size()));
  surface.share = static_cast<float>(random.uniform(0.01, 1));
  surface.tint = random_rgb(random, 1.5);
  for (SurfacePoint& point : surface.points) {
    point = {random_unit(random), random_unit(random), random_unit(random), random_unit(random)};
  }
  surface.points[1].tangent = {};
  return surface;
}

}  // namespace

std::vector<std::uint8_t> random_fifths(int cube_size, std::uint64_t seed) {
  Random random(seed, 5);
  const auto size = static_cast<std::size_t>(cube_size);
  const std::size_t across = size / SkyVisibilityView::kBlockSide;
  std::vector<std::uint64_t> kinds(cube::kFaces * across * across);
  for (std::uint64_t& kind : kinds) kind = random.below(3);
  std::vector<std::uint8_t> fifths(cube::texel_count(cube_size));
  for (std::size_t texel = 0; texel < fifths.size(); ++texel) {
    const std::size_t row = texel / size / SkyVisibilityView::kBlockSide;
    const std::uint64_t kind = kinds[row * across + texel % size / SkyVisibilityView::kBlockSide];
    fifths[texel] = kind == 0   ? 0
                    : kind == 1 ? SkyVisibilityView::kAll
                                : static_cast<std::uint8_t>(random.below(6));
  }
  return fifths;
}

CurveBakeParts::CurveBakeParts(std::uint64_t seed)
    : manifest(small_manifest(settings)), sky(settings.cube_size) {
  Random random(seed, 4);
  manifest.materials = random_materials(random);
  for (const char* const name : {"cloth", "silk"}) {
    manifest.measured_brdfs.push_back(random_measured(random, name));
  }
  const CurveMaterial& cloth = manifest.measured_brdfs.front();
  manifest.materials.push_back({.name = "coat",
                                .brdf = {.albedo = {}},
                                .measured = cloth.measured,
                                .measured_name = cloth.name});
  for (int i = 0; i < kSurfaces; ++i) surfaces.push_back(random_surface(random, manifest));
  std::ranges::sort(surfaces, {}, [](const CurveSurface& surface) {
    return std::tuple(surface.receiver / kTileReceivers, surface.material, surface.receiver);
  });
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    fifths.push_back(random_fifths(settings.cube_size, mix_bits(seed ^ i)));
    sky.add(fifths.back());
  }
}

CurveReceivers CurveBakeParts::receivers() const {
  return {manifest.materials, manifest.measured_brdfs, surfaces, sky.view()};
}

void write_curve_bake(const std::filesystem::path& folder, const CurveBakeParts& parts) {
  BakeWriter writer(folder);
  fill(writer, parts.settings);
  writer.add_curves(parts.receivers());
  writer.commit(parts.manifest);
}

}  // namespace rimlight::test

#include "core/bake/curve_surfaces.h"

#include <algorithm>
#include <memory>
#include <numeric>

#include "core/bake/lambert_kernel.h"
#include "core/bake/lobe_response.h"
#include "core/bake/sky_visibility.h"
#include "core/bake/texel_quadrature.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

constexpr std::size_t kGroupsPerTile = kTileReceivers / kGroupLanes;

/// What one group adds.
struct GroupResult {
  explicit GroupResult(int cube_size) : visibility(cube_size) {}

  std::vector<CurveSurface> surfaces;
  SkyVisibilityPacker visibility;
  std::vector<Vec3f> reflected;  // [surface][light]
};

/// What a thread keeps between groups.
struct Workspace {
  GroupSamples samples;
  GroupSurfaces surfaces;
  SkyVisibility visibility;
  PixelSurfaces found;
  std::vector<std::uint8_t> fifths;
};

float tint_of(float found, float baked) { return baked > 0 ? found / baked : 1; }

class SurfaceFinder {
 public:
  SurfaceFinder(const RayScene& scene, const EditableMaterials& editable,
                const std::vector<CubeLight>& lights)
      : scene_(scene),
        editable_(editable),
        set_(editable.set()),
        lights_(lights),
        settings_(scene.scene().bake),
        layout_{settings_.width, settings_.height},
        texels_(settings_.cube_size) {}

  const PixelLayout& layout() const { return layout_; }

  void find(std::size_t first_receiver, GroupResult& result) const {
    thread_local const auto workspace = std::make_unique<Workspace>();
    Workspace& work = *workspace;
    sample_group(scene_, layout_, first_receiver, settings_.primary_rays, settings_.seed,
                 work.samples);
    if (work.samples.empty()) return;
    work.surfaces.assign(work.samples, set_);
    if (work.surfaces.layer_count() == 0) return;
    trace(first_receiver, work);
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      find_surfaces(work.samples, lane, work.found);
      std::size_t layer = 0;
      for (const PixelSurface& surface : work.found) {
        if (!set_.has(surface.material)) continue;
        add(surface, {layer++, lane}, first_receiver, work, result);
      }
    }
  }

 private:
  struct Place {
    std::size_t layer, lane;
  };

  void trace(std::size_t first_receiver, Workspace& work) const {
    const std::uint64_t seed = mix_bits(settings_.seed ^ mix_bits(first_receiver));
    work.visibility.clear(work.surfaces.layer_count(), texels_);
    for (std::size_t texel = 0; texel < texels_.count(); ++texel) {
      for (std::size_t layer = 0; layer < work.surfaces.layer_count(); ++layer) {
        work.visibility.responding(layer, texel) =
            facing_lanes(work.surfaces.layer(layer), texels_.quarters(texel));
      }
    }
    work.visibility.trace(scene_, work.surfaces, texels_, mix_bits(seed));
  }

  void add(const PixelSurface& surface, const Place& place, std::size_t first_receiver,
           Workspace& work, GroupResult& result) const {
    result.surfaces.push_back(
        describe(surface, static_cast<std::uint32_t>(first_receiver + place.lane)));
    work.fifths.resize(texels_.count());
    static_assert(SkyVisibility::kMoreShadowRays + 1 == SkyVisibilityView::kAll);
    for (std::size_t texel = 0; texel < texels_.count(); ++texel) {
      const std::uint8_t lit = work.visibility.lit_rays(place.layer, texel)[place.lane];
      const bool more = (work.visibility.refined(place.layer, texel) & lane_bit(place.lane)) != 0;
      work.fifths[texel] = more ? lit : static_cast<std::uint8_t>(SkyVisibilityView::kAll * lit);
    }
    result.visibility.add(work.fifths);
    add_reflected(surface, work.fifths, result);
  }

  CurveSurface describe(const PixelSurface& surface, std::uint32_t receiver) const {
    CurveSurface result;
    result.receiver = receiver;
    result.material = editable_.index[surface.material];
    result.share = surface.share;
    const Vec3f& baked = editable_.materials[result.material].brdf.albedo;
    const Vec3f& found = surface.brdf.albedo;
    result.tint = {tint_of(found.x, baked.x), tint_of(found.y, baked.y), tint_of(found.z, baked.z)};
    static_assert(kSurfacePoints == kQuarters);
    for (std::size_t q = 0; q < kSurfacePoints; ++q) {
      const std::size_t hit = standing_hit(surface, q);
      const SurfaceHit& at = *surface.hits[hit];
      result.points[q] = {at.shading_normal, at.tangent, at.geometric_normal,
                          surface.outgoing[hit]};
    }
    return result;
  }

  /// Under all lights at once: the response is what takes the time.
  void add_reflected(const PixelSurface& surface, const std::vector<std::uint8_t>& fifths,
                     GroupResult& result) const {
    const LobeSurface lobe = lobe_surface(surface);
    const std::size_t first = result.reflected.size();
    result.reflected.resize(first + lights_.size());
    for (std::size_t texel = 0; texel < fifths.size(); ++texel) {
      if (fifths[texel] == 0) continue;
      const Vec3f response = lobe_response(lobe, texels_.quarters(texel)) *
                             (static_cast<float>(fifths[texel]) / SkyVisibilityView::kAll);
      for (std::size_t light = 0; light < lights_.size(); ++light) {
        result.reflected[first + light] += response * lights_[light].at(texel);
      }
    }
  }

  const RayScene& scene_;
  const EditableMaterials& editable_;
  MaterialSet set_;
  const std::vector<CubeLight>& lights_;
  BakeSettings settings_;
  PixelLayout layout_;
  TexelQuadrature texels_;
};

/// A tile's groups one after the other, then in the order of material and receiver.
void collect(const std::vector<GroupResult>& groups, CurveSurfaces& all) {
  struct Source {
    std::size_t group, index;
  };
  std::vector<Source> sources;
  for (std::size_t group = 0; group < groups.size(); ++group) {
    for (std::size_t i = 0; i < groups[group].surfaces.size(); ++i) sources.push_back({group, i});
  }
  const auto surface = [&groups](const Source& source) -> const CurveSurface& {
    return groups[source.group].surfaces[source.index];
  };
  std::ranges::stable_sort(sources, {}, [&](const Source& source) {
    return std::pair(surface(source).material, surface(source).receiver);
  });
  std::vector<std::uint8_t> fifths(cube::texel_count(all.visibility.view().cube_size));
  for (const Source& source : sources) {
    const GroupResult& from = groups[source.group];
    all.surfaces.push_back(surface(source));
    from.visibility.view().unpack(source.index, fifths);
    all.visibility.add(fifths);
    const std::size_t lights = all.images.size();
    for (std::size_t light = 0; light < lights; ++light) {
      all.images[light][surface(source).receiver] += from.reflected[source.index * lights + light];
    }
  }
}

/// As a bake keeps it: a measured one without what points into the scene.
CurveMaterial curve_material(const Material& material) {
  if (material.measured == nullptr) return {material.name, material.brdf};
  return {.name = material.name,
          .brdf = {.albedo = {}},
          .measured = material.measured->factors(),
          .measured_name = material.measured_name};
}

}  // namespace

MaterialSet EditableMaterials::set() const {
  std::vector<bool> editable(index.size());
  for (std::size_t i = 0; i < index.size(); ++i) editable[i] = index[i] != kNone;
  return MaterialSet(std::move(editable));
}

EditableMaterials find_editable_materials(const Scene& scene) {
  EditableMaterials result;
  result.index.assign(scene.materials.size(), EditableMaterials::kNone);
  const std::vector<std::string>& names = scene.bake.editable;
  if (scene.bake.cube_size < SkyVisibilityView::kBlockSide) {
    throw Error(
        scene.name + ": cube_size", std::to_string(scene.bake.cube_size),
        "at least " + std::to_string(SkyVisibilityView::kBlockSide) + " where curves are edited");
  }
  for (const std::string& name : names) {
    if (std::ranges::find(scene.materials, name, &Material::name) == scene.materials.end()) {
      throw Error(scene.name + ": editable", quote(name), "the name of a material of the scene");
    }
  }
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& material = scene.materials[i];
    const bool is_editable = names.empty() ? material.brdf.model != BrdfModel::lambert
                                           : std::ranges::find(names, material.name) != names.end();
    if (!is_editable) continue;
    result.index[i] = static_cast<std::uint32_t>(result.materials.size());
    result.materials.push_back(curve_material(material));
  }
  if (result.materials.empty()) {
    throw Error(scene.name, "no material with a gloss", "a material whose BRDF can be edited");
  }
  return result;
}

CurveSurfaces find_curve_surfaces(const RayScene& scene, const EditableMaterials& editable,
                                  const std::vector<CubeLight>& lights,
                                  const std::function<void(double fraction)>& progress) {
  const SurfaceFinder finder(scene, editable, lights);
  const int cube_size = scene.scene().bake.cube_size;
  CurveSurfaces all(cube_size);
  all.images.assign(lights.size(), std::vector<Vec3f>(finder.layout().receiver_count()));
  const std::size_t tiles = finder.layout().tile_count();
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    std::vector<GroupResult> groups(kGroupsPerTile, GroupResult(cube_size));
    parallel_for(kGroupsPerTile, [&](std::size_t group) {
      finder.find(tile * kTileReceivers + group * kGroupLanes, groups[group]);
    });
    collect(groups, all);
    progress(static_cast<double>(tile + 1) / static_cast<double>(tiles));
  }
  if (all.surfaces.empty()) {
    throw Error(scene.scene().name, "no editable material in the picture",
                "one that the camera sees");
  }
  return all;
}

}  // namespace rimlight

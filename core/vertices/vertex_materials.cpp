#include "core/vertices/vertex_materials.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/basis/sh_zonal.h"
#include "core/vertices/lobe_curve.h"
#include "core/vertices/vertex_products.h"

namespace rimlight {
namespace {

/// A lobe whose last band keeps so much of itself would need more bands to look as sharp as it is.
constexpr float kCutLobe = 0.5f;

void check_colour(const std::optional<Vec3f>& colour, const std::string& where) {
  if (!colour) return;
  for (int c = 0; c < 3; ++c) {
    if (!((*colour)[c] >= 0 && (*colour)[c] <= 1)) {
      throw Error(where, std::to_string((*colour)[c]), "0 to 1");
    }
  }
}

void check_edit(const MaterialEdit& edit, const std::string& where) {
  check_colour(edit.albedo, where + "/albedo");
  check_colour(edit.highlight, where + "/highlight");
  if (edit.exponent && !(*edit.exponent >= 0 && *edit.exponent <= VertexMaterials::kMostExponent)) {
    throw Error(where + "/exponent", std::to_string(*edit.exponent), "0 to 10000");
  }
  if (edit.lobe) check_lobe(*edit.lobe, where + "/lobe");
}

}  // namespace

VertexMaterials::VertexMaterials(const VertexScene& scene, std::size_t stride)
    : scene_(scene),
      stride_(stride),
      materials_(scene.materials),
      curves_(scene.materials.size()),
      has_highlight_(scene.materials.size()),
      can_have_highlight_(scene.materials.size()),
      lobes_(scene.materials.size() * stride) {
  for (std::size_t vertex = 0; vertex < scene.transport.highlight_count; ++vertex) {
    can_have_highlight_[scene.mesh->materials[vertex]] = 1;
  }
  for (std::size_t i = 0; i < materials_.size(); ++i) project_lobe(i);
  find_highlights();
}

std::size_t VertexMaterials::find(const std::string& name) const {
  const auto found = std::ranges::find(scene_.materials, name, &VertexMaterial::name);
  if (found != scene_.materials.end()) {
    return static_cast<std::size_t>(found - scene_.materials.begin());
  }
  std::string names;
  for (const VertexMaterial& material : scene_.materials) names += " " + quote(material.name);
  throw Error("materials", quote(name), "one of" + names);
}

bool VertexMaterials::set(const std::map<std::string, MaterialEdit>& edits) {
  if (edits == edits_) return false;
  std::vector<VertexMaterial> edited = scene_.materials;
  std::vector<std::vector<double>> curves(edited.size());
  for (const auto& [name, edit] : edits) {
    const std::size_t at = find(name);
    VertexMaterial& material = edited[at];
    check_edit(edit, "materials/" + name);
    material.albedo = edit.albedo.value_or(material.albedo);
    material.highlight = edit.highlight.value_or(material.highlight);
    material.exponent = edit.exponent.value_or(material.exponent);
    if (edit.lobe) curves[at] = *edit.lobe;
  }
  edits_ = edits;
  materials_.swap(edited);
  curves_.swap(curves);
  for (std::size_t i = 0; i < materials_.size(); ++i) {
    if (materials_[i].exponent != edited[i].exponent || curves_[i] != curves[i]) project_lobe(i);
  }
  find_highlights();
  return true;
}

void VertexMaterials::find_highlights() {
  for (std::size_t i = 0; i < materials_.size(); ++i) {
    const bool shines = can_have_highlight_[i] != 0 && materials_[i].highlight != Vec3f();
    has_highlight_[i] = shines ? 1 : 0;
  }
}

void VertexMaterials::project_lobe(std::size_t material) {
  const int degree = scene_.transport.visibility_degree;
  const std::vector<double>& curve = curves_[material];
  const auto factors =
      convolution_factors(curve.empty() ? sh::phong_lobe(materials_[material].exponent, degree)
                                        : curve_lobe(curve, degree));
  float* const lobe = lobes_.data() + material * stride_;
  for (std::size_t k = 0; k < sh::coefficient_count(degree); ++k) {
    lobe[k] = factors[static_cast<std::size_t>(sh::degree_of(k))];
  }
}

void VertexMaterials::describe(const std::string& name, const MaterialEdit& edit,
                               std::vector<std::string>& words) const {
  const std::size_t material = find(name);
  if (edit.specular || edit.roughness || edit.eta || edit.k || edit.exponent_across ||
      edit.roughness_across || edit.half_angle || edit.difference_angle || edit.measured) {
    words.push_back("the edited BRDF of " + name + " (this bake has a colour and a highlight)");
  }
  if (edit.albedo && *edit.albedo != scene_.materials[material].albedo &&
      scene_.has_interreflection) {
    words.push_back("light from " + name + " to other surfaces keeps the albedo of the bake");
  }
  const VertexMaterial& shown = materials_[material];
  if (can_have_highlight_[material] == 0) {
    if (shown.highlight != Vec3f()) {
      words.push_back("the highlight of " + name + " (none was baked)");
    }
    return;
  }
  const int degree = scene_.transport.visibility_degree;
  const float last = lobes_[material * stride_ + sh::coefficient_count(degree) - 1];
  const bool is_edited = edit.exponent || edit.lobe;
  if (is_edited && has_highlight_[material] != 0 && std::abs(last) > kCutLobe) {
    words.push_back("all of the sharpness of " + name + " (the bake's degree is " +
                    std::to_string(degree) + ")");
  }
}

std::vector<std::string> VertexMaterials::unshown() const {
  std::vector<std::string> words;
  for (const auto& [name, edit] : edits_) describe(name, edit, words);
  return words;
}

}  // namespace rimlight

#include "core/scene/material_source.h"

#include <memory>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/image/image_file.h"
#include "core/scene/measured_source.h"

namespace rimlight {
namespace {

constexpr double kLargestCoordinate = 1e6;
constexpr std::size_t kLongestName = 200;

/// Sets `value` from an optional field.
void read_optional(const JsonReader& json, std::string_view name, double low, double high,
                   Vec3f& value) {
  if (const auto field = json.optional_member(name)) value = read_channels(*field, low, high);
}

void read_optional(const JsonReader& json, std::string_view name, double low, double high,
                   float& value) {
  if (const auto field = json.optional_member(name)) {
    value = static_cast<float>(field->number(low, high));
  }
}

Brdf read_lambert(const JsonReader& json) {
  json.allow_only({"model", "albedo", "texture", "subsurface"});
  Brdf brdf;
  read_optional(json, "albedo", 0, 1, brdf.albedo);
  return brdf;
}

void check_sum(const JsonReader& json, const Brdf& brdf) {
  for (int c = 0; c < 3; ++c) {
    // 0.7 + 0.3 is a hair above 1 in floats.
    if (brdf.albedo[c] + brdf.specular[c] <= 1 + 1e-6f) continue;
    throw Error(json.where(),
                "albedo + specular of " + std::to_string(brdf.albedo[c] + brdf.specular[c]),
                "at most 1 in each channel");
  }
}

/// One number for both of a lobe's axes, or one for each.
void read_axes(const JsonReader& json, std::string_view name, double low, double high, float& along,
               float& across) {
  const auto field = json.optional_member(name);
  if (!field) return;
  if (field->is_array()) {
    const std::vector<double> both = field->numbers(2, low, high);
    along = static_cast<float>(both[0]);
    across = static_cast<float>(both[1]);
  } else {
    along = across = static_cast<float>(field->number(low, high));
  }
}

/// Phong's, or Blinn–Phong's.
Brdf read_phong(const JsonReader& json, BrdfModel model) {
  json.allow_only({"model", "albedo", "texture", "specular", "exponent", "subsurface"});
  Brdf brdf{.model = model, .specular = {0.05f, 0.05f, 0.05f}};
  read_optional(json, "albedo", 0, 1, brdf.albedo);
  read_optional(json, "specular", 0, 1, brdf.specular);
  read_optional(json, "exponent", 1, 1e5, brdf.exponent);
  check_sum(json, brdf);
  return brdf;
}

Brdf read_ward(const JsonReader& json) {
  json.allow_only({"model", "albedo", "texture", "specular", "roughness", "tangent"});
  Brdf brdf{.model = BrdfModel::ward, .specular = {0.05f, 0.05f, 0.05f}};
  read_optional(json, "albedo", 0, 1, brdf.albedo);
  read_optional(json, "specular", 0, 1, brdf.specular);
  read_axes(json, "roughness", 1e-4, 1, brdf.roughness, brdf.roughness_across);
  check_sum(json, brdf);
  return brdf;
}

Brdf read_ashikhmin_shirley(const JsonReader& json) {
  json.allow_only({"model", "albedo", "texture", "specular", "exponent", "tangent"});
  Brdf brdf{.model = BrdfModel::ashikhmin_shirley, .specular = {0.05f, 0.05f, 0.05f}};
  read_optional(json, "albedo", 0, 1, brdf.albedo);
  read_optional(json, "specular", 0, 1, brdf.specular);
  read_axes(json, "exponent", 1, 1e5, brdf.exponent, brdf.exponent_across);
  return brdf;
}

Brdf read_cook_torrance(const JsonReader& json) {
  json.allow_only({"model", "albedo", "texture", "specular", "roughness", "eta", "k"});
  Brdf brdf{.model = BrdfModel::cook_torrance, .albedo = {}, .specular = {1, 1, 1}};
  read_optional(json, "albedo", 0, 1, brdf.albedo);
  read_optional(json, "specular", 0, 1, brdf.specular);
  read_optional(json, "roughness", 1e-4, 1, brdf.roughness);
  read_optional(json, "eta", 0.05, 100, brdf.eta);
  read_optional(json, "k", 0, 100, brdf.k);
  for (int c = 0; c < 3; ++c) {
    // evaluate() would leave it out in silence.
    if (brdf.albedo[c] == 0 || (brdf.k[c] == 0 && brdf.eta[c] >= 1)) continue;
    throw Error(json.member("albedo").where(), "an albedo on a metal",
                "0 where k > 0 or eta < 1: only a dielectric has diffuse light below its gloss");
  }
  return brdf;
}

/// Mean free paths from a thousandth to a million units of the scene.
Subsurface read_subsurface(const JsonReader& json) {
  json.allow_only({"absorption", "scattering", "eta"});
  Subsurface result{.absorption = read_channels(json.member("absorption"), 0, 1e3),
                    .scattering = read_channels(json.member("scattering"), 1e-6, 1e6)};
  read_optional(json, "eta", 1, 3, result.eta);
  return result;
}

Brdf read_brdf(const JsonReader& json) {
  switch (json.member("model").one_of({"lambert", "phong", "cook_torrance", "blinn_phong", "ward",
                                       "ashikhmin_shirley", "measured"})) {
    case 0:
      return read_lambert(json);
    case 1:
      return read_phong(json, BrdfModel::phong);
    case 2:
      return read_cook_torrance(json);
    case 3:
      return read_phong(json, BrdfModel::blinn_phong);
    case 4:
      return read_ward(json);
    case 5:
      return read_ashikhmin_shirley(json);
    default:
      return {.model = BrdfModel::measured, .albedo = {}};
  }
}

}  // namespace

std::string read_name(const JsonReader& json) {
  const std::string name = json.string();
  if (name.empty() || name.size() > kLongestName) {
    json.fail("a name of 1 to " + std::to_string(kLongestName) + " bytes");
  }
  return name;
}

Vec3d read_point(const JsonReader& json) {
  const std::vector<double> xyz = json.numbers(3, -kLargestCoordinate, kLargestCoordinate);
  return {xyz[0], xyz[1], xyz[2]};
}

Vec3f read_channels(const JsonReader& json, double low, double high) {
  if (!json.is_array()) return Vec3f::filled(static_cast<float>(json.number(low, high)));
  const std::vector<double> rgb = json.numbers(3, low, high);
  return Vec3f(Vec3d(rgb[0], rgb[1], rgb[2]));
}

Material read_material(const JsonReader& json, const std::string& name,
                       const std::filesystem::path& folder,
                       std::vector<MeasuredReflection>& measured) {
  Material material;
  material.name = name;
  material.brdf = read_brdf(json);
  if (material.brdf.model == BrdfModel::measured) {
    const MeasuredReflection& found = read_measured_of_material(json, folder, measured);
    material.measured = found.lobe;
    material.measured_name = found.name;
    material.brdf.measured = found.lobe.get();
  }
  if (const auto tangent = json.optional_member("tangent")) {
    material.tangent = Vec3f(read_point(*tangent));
    if (!(length(material.tangent) >= 1e-6f)) tangent->fail("a direction");
  }
  if (const auto subsurface = json.optional_member("subsurface")) {
    material.subsurface = read_subsurface(*subsurface);
  }
  if (const auto texture = json.optional_member("texture")) {
    try {
      material.albedo_texture =
          std::make_shared<const RgbImage>(read_srgb_picture(folder / texture->string()));
    } catch (const Error& error) {
      throw Error(texture->where() + ": " + error.where(), error.found(), error.expected());
    }
  }
  return material;
}

}  // namespace rimlight

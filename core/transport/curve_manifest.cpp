#include <algorithm>

#include "core/base/error.h"
#include "core/transport/curve_tensors.h"

namespace rimlight {
namespace {

using nlohmann::json;

constexpr std::size_t kMostCurveMaterials = 256;
constexpr double kLargestFitError = 1e9;

/// Beside kModelOfName.
const std::vector<std::string> kModels = {"lambert", "phong",       "cook_torrance",
                                          "ward",    "blinn_phong", "ashikhmin_shirley"};
constexpr BrdfModel kModelOfName[] = {BrdfModel::lambert,       BrdfModel::phong,
                                      BrdfModel::cook_torrance, BrdfModel::ward,
                                      BrdfModel::blinn_phong,   BrdfModel::ashikhmin_shirley};

/// In the place of a model.
constexpr const char* kMeasuredModel = "measured";

template <typename T>
json to_json(const Vec3<T>& v) {
  return {v.x, v.y, v.z};
}

Vec3f read_channels(const JsonReader& reader, double low, double high) {
  const std::vector<double> v = reader.numbers(3, low, high);
  return Vec3f(Vec3d(v[0], v[1], v[2]));
}

Vec3d read_errors(const JsonReader& reader) {
  const std::vector<double> v = reader.numbers(3, 0, kLargestFitError);
  return {v[0], v[1], v[2]};
}

json to_json(const CurveMaterial& material) {
  if (material.measured) {
    return {
        {"name", material.name}, {"model", kMeasuredModel}, {"measured", material.measured_name}};
  }
  const Brdf& brdf = material.brdf;
  return {{"name", material.name},
          {"model", brdf_model_name(brdf.model)},
          {"albedo", to_json(brdf.albedo)},
          {"specular", to_json(brdf.specular)},
          {"exponent", {brdf.exponent, brdf.exponent_across}},
          {"roughness", {brdf.roughness, brdf.roughness_across}},
          {"eta", to_json(brdf.eta)},
          {"k", to_json(brdf.k)}};
}

/// Its factors are those of one of the bake's measured BRDFs.
CurveMaterial read_measured_material(const JsonReader& reader) {
  reader.allow_only({"name", "model", "measured"});
  return {.name = reader.member("name").string(),
          .brdf = {.albedo = {}},
          .measured = FactoredBrdf{},
          .measured_name = reader.member("measured").string()};
}

CurveMaterial read_curve_material(const JsonReader& reader) {
  const JsonReader model = reader.member("model");
  if (model.is_string() && model.string() == kMeasuredModel) return read_measured_material(reader);
  reader.allow_only({"name", "model", "albedo", "specular", "exponent", "roughness", "eta", "k"});
  CurveMaterial material;
  material.name = reader.member("name").string();
  Brdf& brdf = material.brdf;
  brdf.model = kModelOfName[model.one_of(kModels)];
  brdf.albedo = read_channels(reader.member("albedo"), 0, 1);
  brdf.specular = read_channels(reader.member("specular"), 0, 1);
  // Domains of brdf.h, with room for how floats are written.
  const std::vector<double> exponents = reader.member("exponent").numbers(2, 1, 1.000001e5);
  const std::vector<double> roughnesses = reader.member("roughness").numbers(2, 0.999e-4, 1);
  brdf.exponent = static_cast<float>(exponents[0]);
  brdf.exponent_across = static_cast<float>(exponents[1]);
  brdf.roughness = static_cast<float>(roughnesses[0]);
  brdf.roughness_across = static_cast<float>(roughnesses[1]);
  brdf.eta = read_channels(reader.member("eta"), 0.0499, 100);
  brdf.k = read_channels(reader.member("k"), 0, 100);
  return material;
}

/// Elements, none of which has the name of another.
template <typename Read>
std::vector<CurveMaterial> read_named(const JsonReader& list, std::size_t least, const Read& read) {
  std::vector<CurveMaterial> result;
  for (const JsonReader& element : list.elements(least, kMostCurveMaterials)) {
    CurveMaterial next = read(element);
    if (std::ranges::find(result, next.name, &CurveMaterial::name) != result.end()) {
      element.fail("a name that no other has");
    }
    result.push_back(std::move(next));
  }
  return result;
}

}  // namespace

const std::string& brdf_model_name(BrdfModel model) {
  const auto at = std::ranges::find(kModelOfName, model) - std::begin(kModelOfName);
  return kModels[static_cast<std::size_t>(at)];
}

json curve_materials_to_json(const std::vector<CurveMaterial>& materials) {
  json list = json::array();
  for (const CurveMaterial& material : materials) list.push_back(to_json(material));
  return list;
}

std::vector<CurveMaterial> read_curve_materials(const JsonReader& reader) {
  return read_named(reader, 1, read_curve_material);
}

json measured_to_json(const std::vector<CurveMaterial>& measured) {
  json list = json::array();
  for (const CurveMaterial& material : measured) {
    list.push_back({{"name", material.name},
                    {"fit_error_logarithmic", to_json(material.measured->error.logarithmic)},
                    {"fit_error_relative", to_json(material.measured->error.relative)},
                    {"valid_share", material.measured->valid_share}});
  }
  return list;
}

std::vector<CurveMaterial> read_measured(const JsonReader& reader) {
  return read_named(reader, 0, [](const JsonReader& element) {
    element.allow_only({"name", "fit_error_logarithmic", "fit_error_relative", "valid_share"});
    CurveMaterial material;
    material.name = element.member("name").string();
    FactoredBrdf& factors = material.measured.emplace();
    factors.error.logarithmic = read_errors(element.member("fit_error_logarithmic"));
    factors.error.relative = read_errors(element.member("fit_error_relative"));
    factors.valid_share = element.member("valid_share").number(0, 1);
    return material;
  });
}

void check_measured_names(const JsonReader& materials, const BakeManifest& manifest) {
  const std::vector<JsonReader> elements = materials.elements();
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const CurveMaterial& material = manifest.materials[i];
    if (!material.measured) continue;
    if (std::ranges::find(manifest.measured_brdfs, material.measured_name, &CurveMaterial::name) ==
        manifest.measured_brdfs.end()) {
      elements[i].member("measured").fail("the name of one of measured_brdfs");
    }
  }
}

}  // namespace rimlight

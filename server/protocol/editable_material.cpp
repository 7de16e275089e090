#include "server/protocol/editable_material.h"

#include <span>

#include "server/protocol/curve_edits.h"

namespace rimlight::server {
namespace {

using nlohmann::json;

const char* model_name(BrdfModel model) {
  switch (model) {
    case BrdfModel::lambert:
      return "lambert";
    case BrdfModel::phong:
      return "phong";
    case BrdfModel::cook_torrance:
      return "cook_torrance";
    case BrdfModel::blinn_phong:
      return "blinn_phong";
    case BrdfModel::ward:
      return "ward";
    case BrdfModel::ashikhmin_shirley:
      return "ashikhmin_shirley";
    case BrdfModel::measured:
      return "measured";
  }
  return "";
}

template <typename T>
json to_json(const Vec3<T>& v) {
  return {v.x, v.y, v.z};
}

json to_json(std::span<const Vec3f> values) {
  json list = json::array();
  for (const Vec3f& v : values) list.push_back(to_json(v));
  return list;
}

json to_json(const std::optional<BrdfCurve>& curve) {
  return curve ? to_json(std::span<const Vec3f>(curve->values)) : json();
}

}  // namespace

std::vector<CurveAxis> curve_axes(const CurveMaterial& material) {
  std::vector<CurveAxis> axes;
  for (const CurveAxis axis : {CurveAxis::half_angle, CurveAxis::difference_angle}) {
    if (material.measured || factor(material.brdf, axis, 0)) axes.push_back(axis);
  }
  return axes;
}

json editable_to_json(const CurveMaterial& material) {
  const Brdf& brdf = material.brdf;
  json axes = json::array();
  for (const CurveAxis axis : curve_axes(material)) axes.push_back(axis_name(axis));
  return {{"name", material.name},
          {"model", model_name(material.measured ? BrdfModel::measured : brdf.model)},
          {"albedo", to_json(brdf.albedo)},
          {"specular", to_json(brdf.specular)},
          {"exponent", brdf.exponent},
          {"exponent_across", brdf.exponent_across},
          {"roughness", brdf.roughness},
          {"roughness_across", brdf.roughness_across},
          {"eta", to_json(brdf.eta)},
          {"k", to_json(brdf.k)},
          {"axes", axes}};
}

json curves_to_json(const CurveMaterial& material) {
  if (material.measured) return curves_to_json(*material.measured);
  return {{"half_angle", to_json(factor_curve(material.brdf, CurveAxis::half_angle))},
          {"difference_angle", to_json(factor_curve(material.brdf, CurveAxis::difference_angle))},
          {"rest", json()},
          {"fit_error", json()}};
}

json curves_to_json(const FactoredBrdf& brdf) {
  return {{"half_angle", to_json(std::span<const Vec3f>(brdf.half_angle.values))},
          {"difference_angle", to_json(std::span<const Vec3f>(brdf.difference_angle.values))},
          {"rest", to_json(std::span<const Vec3f>(brdf.rest))},
          {"fit_error",
           {{"logarithmic", to_json(brdf.error.logarithmic)},
            {"relative", to_json(brdf.error.relative)}}}};
}

}  // namespace rimlight::server

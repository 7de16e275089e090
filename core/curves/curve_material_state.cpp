#include "core/curves/curve_material_state.h"

#include <array>
#include <string_view>

#include "core/base/error.h"

namespace rimlight {
namespace {

/// The parameters that each model has, by the names of MaterialEdit's fields.
struct ModelFields {
  std::string_view name;
  bool albedo = true, specular = true;
  bool exponent = false, exponent_across = false;
  bool roughness = false, roughness_across = false;
  bool index = false;  // eta and k
};

ModelFields fields_of(BrdfModel model) {
  switch (model) {
    case BrdfModel::lambert:
      return {.name = "lambert", .specular = false};
    case BrdfModel::phong:
      return {.name = "phong", .exponent = true};
    case BrdfModel::cook_torrance:
      return {.name = "cook_torrance", .roughness = true, .index = true};
    case BrdfModel::blinn_phong:
      return {.name = "blinn_phong", .exponent = true};
    case BrdfModel::ward:
      return {.name = "ward", .roughness = true, .roughness_across = true};
    case BrdfModel::ashikhmin_shirley:
      return {.name = "ashikhmin_shirley", .exponent = true, .exponent_across = true};
    case BrdfModel::measured:
      return {.name = "measured", .albedo = false, .specular = false};
  }
  return {};
}

/// A field in an edit's place, its domain checked.
struct FieldCheck {
  const std::string& where;

  void within(double value, double low, double high, const std::string& field) const {
    if (value >= low && value <= high) return;
    throw Error(where + "/" + field, std::to_string(value),
                std::to_string(low) + " to " + std::to_string(high));
  }
  void within(const Vec3f& rgb, double low, double high, const std::string& field) const {
    for (int c = 0; c < 3; ++c) within(rgb[c], low, high, field);
  }
};

/// A field asked for outside its domain is an error, whatever the model has.
void check_parameters(const MaterialEdit& edit, const std::string& where) {
  const FieldCheck check{where};
  if (edit.albedo) check.within(*edit.albedo, 0, 1, "albedo");
  if (edit.specular) check.within(*edit.specular, 0, 1, "specular");
  if (edit.exponent) check.within(*edit.exponent, 1, 1e5, "exponent");
  if (edit.exponent_across) check.within(*edit.exponent_across, 1, 1e5, "exponent_across");
  if (edit.roughness) check.within(*edit.roughness, 1e-4, 1, "roughness");
  if (edit.roughness_across) check.within(*edit.roughness_across, 1e-4, 1, "roughness_across");
  if (edit.eta) check.within(*edit.eta, 0.05, 100, "eta");
  if (edit.k) check.within(*edit.k, 0, 100, "k");
}

void set_exponents(const MaterialEdit& edit, Brdf& brdf) {
  if (edit.exponent || edit.exponent_across) {
    brdf.exponent = static_cast<float>(edit.exponent ? *edit.exponent : *edit.exponent_across);
    brdf.exponent_across =
        static_cast<float>(edit.exponent_across ? *edit.exponent_across : *edit.exponent);
  }
  if (edit.roughness || edit.roughness_across) {
    brdf.roughness = static_cast<float>(edit.roughness ? *edit.roughness : *edit.roughness_across);
    brdf.roughness_across =
        static_cast<float>(edit.roughness_across ? *edit.roughness_across : *edit.roughness);
  }
}

Brdf edited(const Brdf& baked, const MaterialEdit& edit, const std::string& where) {
  Brdf brdf = baked;
  if (edit.albedo) brdf.albedo = *edit.albedo;
  if (edit.specular) brdf.specular = *edit.specular;
  set_exponents(edit, brdf);
  if (edit.eta) brdf.eta = *edit.eta;
  if (edit.k) brdf.k = *edit.k;
  const bool is_sum_bounded = brdf.model == BrdfModel::phong ||
                              brdf.model == BrdfModel::blinn_phong || brdf.model == BrdfModel::ward;
  // 0.7 + 0.3 is a hair above 1 in floats.
  const float sum = max_component(brdf.albedo + brdf.specular);
  if (is_sum_bounded && !(sum <= 1 + 1e-6f)) {
    throw Error(where + (edit.specular ? "/specular" : "/albedo"),
                "albedo + specular of " + std::to_string(sum), "at most 1 in each channel");
  }
  return brdf;
}

void check_curve(const CurveEdit& edit, const std::string& where) {
  if (edit.points.empty() == edit.values.empty()) {
    throw Error(where, edit.points.empty() ? "neither points nor values" : "points and values",
                "one of the two");
  }
  if (!edit.points.empty()) return check_curve_points(edit.points, where);
  std::vector<Vec3d> values;
  for (const Vec3f& value : edit.values) values.emplace_back(value);
  check_curve_values(values, where);
}

void set_curve(CurveAxis axis, const std::optional<CurveEdit>& edit, const std::string& where,
               std::optional<BrdfCurve>& curve) {
  if (!edit) return;
  check_curve(*edit, where);
  if (curve) curve = curve_of(axis, *edit);
}

/// What a session sees when it shows the material: its model, or the measured one.
std::string shown_name(const CurveMaterial& baked, const MaterialEdit& edit) {
  if (edit.measured || baked.measured) return "a measured BRDF";
  return std::string(fields_of(baked.brdf.model).name);
}

}  // namespace

CurveMaterialState resolve(const CurveMaterial& baked, const MaterialEdit& edit,
                           const MeasuredLibrary& library, const std::string& where) {
  check_parameters(edit, where);
  CurveMaterialState state;
  state.measured = baked.measured;
  if (edit.measured) {
    const auto found = library.find(*edit.measured);
    if (found == library.end()) {
      throw Error(where + "/measured", quote(*edit.measured), "a measured BRDF of this bake");
    }
    state.measured = found->second;
  }
  if (state.measured) {
    state.brdf = baked.brdf;
    state.half_angle = state.measured->half_angle;
    state.difference_angle = state.measured->difference_angle;
  } else {
    state.brdf = edited(baked.brdf, edit, where);
    state.half_angle = factor_curve(state.brdf, CurveAxis::half_angle);
    state.difference_angle = factor_curve(state.brdf, CurveAxis::difference_angle);
  }
  set_curve(CurveAxis::half_angle, edit.half_angle, where + "/half_angle", state.half_angle);
  set_curve(CurveAxis::difference_angle, edit.difference_angle, where + "/difference_angle",
            state.difference_angle);
  return state;
}

std::vector<std::string> unavailable(const CurveMaterial& baked, const MaterialEdit& edit) {
  const bool is_measured = edit.measured || baked.measured;
  const ModelFields has = fields_of(baked.brdf.model);
  const std::string name = shown_name(baked, edit);
  std::vector<std::string> sentences;
  const auto ask = [&](bool is_asked, bool is_there, const std::string& what) {
    if (is_asked && (is_measured || !is_there)) sentences.push_back(name + " has no " + what);
  };
  ask(edit.albedo.has_value(), has.albedo, "albedo");
  ask(edit.specular.has_value(), has.specular, "specular weight");
  ask(edit.exponent.has_value(), has.exponent, "exponent");
  ask(edit.exponent_across.has_value(), has.exponent_across, "exponent across");
  ask(edit.roughness.has_value(), has.roughness, "roughness");
  ask(edit.roughness_across.has_value(), has.roughness_across, "roughness across");
  ask(edit.eta.has_value(), has.index, "index of refraction");
  ask(edit.k.has_value(), has.index, "extinction k");
  ask(edit.highlight.has_value(), false, "highlight weight");
  ask(edit.lobe.has_value(), false, "lobe to draw");
  if (is_measured) return sentences;
  ask(edit.half_angle.has_value(), factor(baked.brdf, CurveAxis::half_angle, 0).has_value(),
      "curve over θ_h");
  ask(edit.difference_angle.has_value(),
      factor(baked.brdf, CurveAxis::difference_angle, 0).has_value(), "curve over θ_d");
  return sentences;
}

CurveStateChange change(const CurveMaterialState& from, const CurveMaterialState& to) {
  CurveStateChange result;
  const Brdf &a = from.brdf, &b = to.brdf;
  const bool kind = a.model != b.model || from.measured.has_value() != to.measured.has_value();
  const bool albedo = !(a.albedo == b.albedo), specular = !(a.specular == b.specular);
  const bool exponents = a.exponent != b.exponent || a.exponent_across != b.exponent_across;
  const bool roughness = a.roughness != b.roughness || a.roughness_across != b.roughness_across;
  const bool index = !(a.eta == b.eta && a.k == b.k);
  const bool is_measured = from.measured && to.measured;
  const BrdfModel model = b.model;
  result.half_angle = from.half_angle != to.half_angle;
  result.difference_angle = from.difference_angle != to.difference_angle;
  bool quotient = kind;
  if (is_measured) {
    quotient |= from.measured->rest != to.measured->rest;
  } else if (model == BrdfModel::cook_torrance || model == BrdfModel::blinn_phong) {
    quotient |= specular;
    result.fixed = kind || albedo || (model == BrdfModel::cook_torrance && (specular || index));
  } else if (model == BrdfModel::ashikhmin_shirley) {
    quotient |= exponents;
    result.fixed = kind || albedo || specular;
  } else {
    result.fixed = kind || albedo;
    if (model != BrdfModel::lambert) result.fixed |= specular || exponents || roughness;
  }
  result.fixed |= kind;
  const auto is_there = [&](CurveAxis axis) { return from.has(axis) || to.has(axis); };
  result.transport_half_angle =
      is_there(CurveAxis::half_angle) && (quotient || result.difference_angle);
  result.transport_difference_angle =
      is_there(CurveAxis::difference_angle) && (quotient || result.half_angle);
  return result;
}

}  // namespace rimlight

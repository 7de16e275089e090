#include "server/protocol/material_edits.h"

#include <algorithm>

#include "core/base/error.h"

namespace rimlight::server {
namespace {

using nlohmann::json;

struct Range {
  double low, high;
};
// Of editable BRDFs, as brdf.h has them.
constexpr Range kRoughness{1e-4, 1}, kEta{0.05, 100}, kExtinction{0, 100}, kShare{0, 1};
constexpr double kLeastBrdfExponent = 1;

Vec3f read_colour(const JsonReader& reader, Range range = kShare) {
  const std::vector<double> v = reader.numbers(3, range.low, range.high);
  return Vec3f(Vec3d(v[0], v[1], v[2]));
}

/// One number for all channels, or three.
Vec3f read_index(const JsonReader& reader, Range range) {
  if (reader.is_array()) return read_colour(reader, range);
  return Vec3f::filled(static_cast<float>(reader.number(range.low, range.high)));
}

/// Null is a lobe of no values.
std::vector<double> read_lobe(const JsonReader& reader) {
  std::vector<double> lobe;
  if (reader.value().is_null()) return lobe;
  for (const JsonReader& value : reader.elements(kFewestLobeValues, kMostLobeValues)) {
    lobe.push_back(value.number(0, kLargestLobeValue));
  }
  check_lobe(lobe, reader.where());
  return lobe;
}

/// Exponents of scenes that show no materials may be any that some scene shows.
Range exponent_range(const std::string& name, const KnownMaterials& known) {
  if (known.editable.contains(name)) return {kLeastBrdfExponent, kLargestBrdfExponent};
  return {0, known.names.empty() ? kLargestBrdfExponent : kLargestExponent};
}

void read_brdf_parameters(const JsonReader& reader, MaterialEdit& edit) {
  const auto set_number = [&](const char* name, Range range, std::optional<double>& number) {
    if (const auto member = reader.optional_member(name)) {
      number = member->number(range.low, range.high);
    }
  };
  if (const auto member = reader.optional_member("specular")) edit.specular = read_colour(*member);
  if (const auto member = reader.optional_member("eta")) edit.eta = read_index(*member, kEta);
  if (const auto member = reader.optional_member("k")) edit.k = read_index(*member, kExtinction);
  set_number("roughness", kRoughness, edit.roughness);
  set_number("roughness_across", kRoughness, edit.roughness_across);
  set_number("exponent_across", {kLeastBrdfExponent, kLargestBrdfExponent}, edit.exponent_across);
}

MaterialEdit read_parameters(const JsonReader& reader, Range exponents) {
  reader.allow_only({"albedo", "highlight", "exponent", "lobe", "specular", "roughness", "eta", "k",
                     "exponent_across", "roughness_across"});
  MaterialEdit edit;
  if (const auto member = reader.optional_member("albedo")) edit.albedo = read_colour(*member);
  if (const auto member = reader.optional_member("highlight")) {
    edit.highlight = read_colour(*member);
  }
  if (const auto member = reader.optional_member("exponent")) {
    edit.exponent = member->number(exponents.low, exponents.high);
  }
  if (const auto member = reader.optional_member("lobe")) edit.lobe = read_lobe(*member);
  read_brdf_parameters(reader, edit);
  if (edit == MaterialEdit()) {
    reader.fail(
        "one or more of albedo, highlight, exponent, lobe, specular, roughness, …; or null");
  }
  return edit;
}

template <typename Names>
std::string listed(const Names& names) {
  std::string result;
  for (const std::string& name : names) result += " " + quote(name);
  return result;
}

void check_length(const std::string& where, const std::string& name) {
  if (!name.empty() && name.size() <= kLongestMaterial) return;
  throw Error(where, "a name of " + std::to_string(name.size()) + " bytes",
              "1 to " + std::to_string(kLongestMaterial));
}

void check_name(const JsonReader& reader, const std::string& name,
                const std::vector<std::string>& materials) {
  check_length(reader.where(), name);
  if (materials.empty() || std::ranges::find(materials, name) != materials.end()) return;
  throw Error(reader.where(), "a material " + quote(name), "one of" + listed(materials));
}

/// Whether this scene takes the curve of a known material over an axis.
void check_axis(const JsonReader& reader, const std::string& name, CurveAxis axis,
                const KnownMaterials& known) {
  if (known.editable.empty()) return;
  const auto found = known.editable.find(name);
  if (found != known.editable.end() &&
      std::ranges::find(found->second, axis) != found->second.end()) {
    return;
  }
  throw Error(reader.where(), "a curve of the material " + quote(name),
              "a material with a factor over " + std::string(axis_name(axis)));
}

void read_curves(const JsonReader& reader, const std::string& name, const KnownMaterials& known,
                 MaterialEdit& edit) {
  reader.allow_only({axis_name(CurveAxis::half_angle), axis_name(CurveAxis::difference_angle)});
  for (const CurveAxis axis : {CurveAxis::half_angle, CurveAxis::difference_angle}) {
    const auto member = reader.optional_member(axis_name(axis));
    if (!member) continue;
    check_axis(*member, name, axis, known);
    (axis == CurveAxis::half_angle ? edit.half_angle : edit.difference_angle) = read_curve(*member);
  }
  if (!edit.half_angle && !edit.difference_angle) {
    reader.fail("one or both of half_angle, difference_angle");
  }
}

/// Null is an empty name.
std::string read_measured(const JsonReader& reader, const std::string& name,
                          const KnownMaterials& known) {
  if (!known.editable.empty() && !known.editable.contains(name)) {
    throw Error(reader.where(), "the material " + quote(name), "one whose BRDF can be edited");
  }
  if (reader.value().is_null()) return {};
  std::string measured = reader.string();
  check_length(reader.where(), measured);
  if (known.editable.empty() ||
      std::ranges::find(known.measured, measured) != known.measured.end()) {
    return measured;
  }
  throw Error(reader.where(), "a measured BRDF " + quote(measured),
              known.measured.empty() ? "null: this scene has none"
                                     : "null or one of" + listed(known.measured));
}

template <typename T>
void set_given(const std::optional<T>& given, std::optional<T>& field) {
  if (given) field = given;
}

/// Sets a field whose empty value means that it is taken back.
template <typename T, typename IsEmpty>
void set_or_take_back(const std::optional<T>& given, IsEmpty is_empty, std::optional<T>& field) {
  if (!given) return;
  field = given;
  if (is_empty(*given)) field.reset();
}

void set_given(const MaterialEdit& edit, MaterialEdit& material) {
  set_given(edit.albedo, material.albedo);
  set_given(edit.highlight, material.highlight);
  if (edit.exponent) {
    material.exponent = edit.exponent;
    material.lobe.reset();
  }
  set_or_take_back(
      edit.lobe, [](const auto& lobe) { return lobe.empty(); }, material.lobe);
  set_given(edit.specular, material.specular);
  set_given(edit.roughness, material.roughness);
  set_given(edit.eta, material.eta);
  set_given(edit.k, material.k);
  set_given(edit.exponent_across, material.exponent_across);
  set_given(edit.roughness_across, material.roughness_across);
  const auto is_no_curve = [](const CurveEdit& curve) {
    return curve.points.empty() && curve.values.empty();
  };
  set_or_take_back(edit.half_angle, is_no_curve, material.half_angle);
  set_or_take_back(edit.difference_angle, is_no_curve, material.difference_angle);
  set_or_take_back(
      edit.measured, [](const auto& name) { return name.empty(); }, material.measured);
}

std::size_t drawn_curves(const std::map<std::string, MaterialEdit>& materials) {
  std::size_t count = 0;
  for (const auto& [name, edit] : materials) {
    count +=
        std::size_t{edit.half_angle.has_value()} + std::size_t{edit.difference_angle.has_value()};
  }
  return count;
}

}  // namespace

MaterialEdits read_material(const JsonReader& reader, const KnownMaterials& known) {
  reader.allow_only({"parameter", "curve", "load"});
  MaterialEdits edits;
  const auto each = [&](const char* member, const auto& read) {
    const auto part = reader.optional_member(member);
    if (!part) return;
    for (const auto& [name, value] : part->members()) {
      check_name(*part, name, known.names);
      read(name, value, edits[name]);
    }
  };
  each("parameter", [&](const std::string& name, const JsonReader& value, MaterialChange& change) {
    change.takes_back = value.value().is_null();
    if (!change.takes_back) change.set = read_parameters(value, exponent_range(name, known));
  });
  each("curve", [&](const std::string& name, const JsonReader& value, MaterialChange& change) {
    read_curves(value, name, known, change.set);
  });
  each("load", [&](const std::string& name, const JsonReader& value, MaterialChange& change) {
    change.set.measured = read_measured(value, name, known);
  });
  if (edits.empty() || edits.size() > kMostMaterials) {
    reader.fail("parameter, curve or load of 1 to " + std::to_string(kMostMaterials) +
                " materials");
  }
  return edits;
}

json parameters_to_json(const MaterialEdit& edit) {
  json text = json::object();
  const auto add = [&](const char* name, const auto& field) {
    if (field) text[name] = *field;
  };
  const auto add_colour = [&](const char* name, const std::optional<Vec3f>& v) {
    if (v) text[name] = {v->x, v->y, v->z};
  };
  add_colour("albedo", edit.albedo);
  add_colour("highlight", edit.highlight);
  add("exponent", edit.exponent);
  add("lobe", edit.lobe);
  add_colour("specular", edit.specular);
  add("roughness", edit.roughness);
  add_colour("eta", edit.eta);
  add_colour("k", edit.k);
  add("exponent_across", edit.exponent_across);
  add("roughness_across", edit.roughness_across);
  return text;
}

json material_to_json(const std::map<std::string, MaterialEdit>& materials) {
  json parameter = json::object(), curve = json::object(), load = json::object();
  for (const auto& [name, edit] : materials) {
    json parameters = parameters_to_json(edit);
    if (!parameters.empty()) parameter[name] = std::move(parameters);
    for (const CurveAxis axis : {CurveAxis::half_angle, CurveAxis::difference_angle}) {
      const auto& drawn = axis == CurveAxis::half_angle ? edit.half_angle : edit.difference_angle;
      if (drawn) curve[name][std::string(axis_name(axis))] = curve_to_json(*drawn);
    }
    if (edit.measured) load[name] = *edit.measured;
  }
  return {{"parameter", parameter}, {"curve", curve}, {"load", load}};
}

void apply_material(const MaterialEdits& edits, std::map<std::string, MaterialEdit>& materials) {
  std::map<std::string, MaterialEdit> changed = materials;
  for (const auto& [name, change] : edits) {
    MaterialEdit& material = changed[name];
    if (change.takes_back) material = {};
    set_given(change.set, material);
    if (material == MaterialEdit()) changed.erase(name);
  }
  if (changed.size() > kMostMaterials) {
    throw Error("message: /material",
                "edits of " + std::to_string(changed.size()) + " materials in the session",
                "at most " + std::to_string(kMostMaterials));
  }
  if (const std::size_t curves = drawn_curves(changed); curves > kMostDrawnCurves) {
    throw Error("message: /material/curve", std::to_string(curves) + " drawn curves in the session",
                "at most " + std::to_string(kMostDrawnCurves));
  }
  materials = std::move(changed);
}

}  // namespace rimlight::server

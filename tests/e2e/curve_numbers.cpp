// curve_numbers FILE: what the library makes of points, of models and of drawn curves, as JSON: the
// page's own arithmetic is held to it.
#include <cstdio>
#include <exception>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/material/albedo.h"
#include "core/math/random.h"
#include "server/protocol/curve_edits.h"
#include "server/protocol/editable_material.h"
#include "tests/server/curve_sphere.h"

namespace rimlight {
namespace {

using nlohmann::json;

json bins_of(const BrdfCurve& curve) {
  json list = json::array();
  for (const Vec3f& v : curve.values) list.push_back({v.x, v.y, v.z});
  return list;
}

json random_points() {
  Random random(11);
  json list = json::array();
  for (int i = 0; i < 24; ++i) {
    CurveEdit edit;
    edit.scale = i % 2 == 0 ? CurveScale::linear : CurveScale::logarithmic;
    const int count = 1 + i / 2;
    for (int k = 0; k < count; ++k) {
      const auto value = [&] {
        return random.uniform(0, 1) < 0.2 ? 0 : std::pow(10, random.uniform(-8, 6));
      };
      edit.points.push_back({(k + random.uniform(0, 0.9)) / count, {value(), value(), value()}});
    }
    list.push_back({{"edit", server::curve_to_json(edit)},
                    {"bins", bins_of(curve_of(CurveAxis::half_angle, edit))}});
  }
  return list;
}

std::vector<CurveMaterial> models() {
  const auto cook = [](float roughness, float eta, float k, float albedo) {
    return CurveMaterial{"cook",
                         {.model = BrdfModel::cook_torrance,
                          .albedo = Vec3f::filled(albedo),
                          .specular = {1, 0.8f, 0.5f},
                          .roughness = roughness,
                          .eta = {eta, eta * 1.1f, eta * 1.3f},
                          .k = {k, k / 2, 0}}};
  };
  const auto blinn = [](float exponent) {
    return CurveMaterial{"blinn",
                         {.model = BrdfModel::blinn_phong,
                          .albedo = {0.1f, 0.3f, 0.2f},
                          .specular = {0.8f, 0.1f, 0.3f},
                          .exponent = exponent}};
  };
  const CurveMaterial lambert{"lambert", {.albedo = {0.2f, 0.9f, 0.4f}}};
  return {cook(1e-4f, 1.5f, 0, 0.5f),
          cook(0.05f, 1, 0, 0.9f),
          cook(0.3f, 1.6f, 0, 0.3f),
          cook(1, 0.2f, 3.9f, 0),
          cook(0.2f, 100, 100, 0),
          blinn(1),
          blinn(40),
          blinn(1e5f),
          lambert};
}

/// Curves that reflect too much, and a spike of one bin.
std::vector<MaterialEdit> drawings() {
  std::vector<MaterialEdit> edits(4);
  edits[0].half_angle =
      CurveEdit{CurveScale::linear, {{0, {4, 1, 1}}, {0.5, {2, 2, 1}}, {1, {0, 0, 1}}}, {}};
  edits[1].half_angle =
      CurveEdit{CurveScale::logarithmic, {{0, {100, 1, 1}}, {0.6, {1e-3, 1, 3}}}, {}};
  edits[2].difference_angle = CurveEdit{CurveScale::linear, {{0, {1, 0.1, 0}}, {1, {9, 9, 9}}}, {}};
  edits[3].half_angle = CurveEdit{CurveScale::linear, {}, std::vector<Vec3f>(kCurveBins)};
  edits[3].half_angle->values[20] = {1e3f, 1e2f, 1e6f};
  return edits;
}

json curve_part(const MaterialEdit& edit) {
  return server::material_to_json({{"it", edit}})["curve"]["it"];
}

json numbers() {
  json all{{"points", random_points()}, {"models", json::array()}, {"drawn", json::array()}};
  for (const CurveMaterial& material : models()) {
    const double albedo = largest_albedo(directional_albedos(CurvedBrdf{material.brdf, {}, {}}));
    all["models"].push_back({{"material", server::editable_to_json(material)},
                             {"curves", server::curves_to_json(material)},
                             {"albedo", albedo}});
  }
  for (const MaterialEdit& edit : drawings()) {
    const CurveMaterial material = models()[2];
    all["drawn"].push_back(
        {{"material", server::editable_to_json(material)},
         {"curve", curve_part(edit)},
         {"albedo", largest_albedo(directional_albedos(server::test::edited(material, edit)))}});
  }
  const FactoredBrdf gold = server::test::made_up_measured();
  all["measured"] = {
      {"curves", server::curves_to_json(gold)},
      {"albedo", largest_albedo(directional_albedos(
                     [&](const Vec3d& in, const Vec3d& out) { return evaluate(gold, in, out); }))}};
  return all;
}

}  // namespace
}  // namespace rimlight

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: curve_numbers FILE\n");
    return 2;
  }
  try {
    std::ofstream file(argv[1]);
    file << rimlight::numbers().dump();
    file.close();
    return file.good() ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "curve_numbers: %s\n", error.what());
    return 1;
  }
}

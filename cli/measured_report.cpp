#include "cli/measured_report.h"

#include <cstdio>

#include "cli/inspect_parts.h"
#include "core/material/albedo.h"

namespace rimlight {
namespace {

using nlohmann::json;

constexpr double kQuadratureError = 0.01;  // of largest_albedo()

json to_json(const Vec3d& v) { return {v.x, v.y, v.z}; }

json describe(const MeasuredReflection& measured) {
  const FactoredBrdf& factors = measured.lobe->factors();
  const auto albedos = directional_albedos(
      [&factors](const Vec3d& in, const Vec3d& out) { return evaluate(factors, in, out); });
  return {{"name", measured.name},
          {"fit_error_logarithmic", to_json(factors.error.logarithmic)},
          {"fit_error_relative", to_json(factors.error.relative)},
          {"valid_share", factors.valid_share},
          {"largest_albedo", largest_albedo(albedos)}};
}

}  // namespace

json describe_measured(const Scene& scene) {
  json all = json::array();
  for (const MeasuredReflection& measured : scene.measured) all.push_back(describe(measured));
  return all;
}

void print_measured(const json& measured) {
  for (const json& one : measured) {
    const double albedo = one["largest_albedo"].get<double>();
    std::fprintf(
        stderr,
        "rimlight bake: %s: fitted with an error of %s (logarithms) and %s (of the values), "
        "samples at %.0f %% of all angles\n",
        printable(one["name"].get<std::string>()).c_str(),
        three_numbers(one["fit_error_logarithmic"]).c_str(),
        three_numbers(one["fit_error_relative"]).c_str(), 100 * one["valid_share"].get<double>());
    if (albedo <= 1 + kQuadratureError) continue;
    std::fprintf(stderr, "rimlight bake: %s: reflects up to %.2f times the light that it gets\n",
                 printable(one["name"].get<std::string>()).c_str(), albedo);
  }
}

}  // namespace rimlight

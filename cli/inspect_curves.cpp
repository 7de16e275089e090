#include "cli/inspect_curves.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include "cli/inspect_parts.h"
#include "core/transport/curve_tensors.h"

namespace rimlight {

using nlohmann::json;

json describe_curves(const CurveReceivers& curves) {
  const SkyVisibilityView& sky = curves.visibility;
  json result = {{"surfaces", curves.surfaces.size()},
                 {"mixed_blocks", sky.mixed.size()},
                 {"mixed_share",
                  static_cast<double>(sky.mixed.size()) / static_cast<double>(sky.blocks.size())},
                 {"visibility_bytes",
                  sky.blocks.size_bytes() + sky.first_mixed.size_bytes() + sky.mixed.size_bytes()},
                 {"materials", json::array()},
                 {"measured", measured_to_json({curves.measured.begin(), curves.measured.end()})}};
  for (std::uint32_t i = 0; i < curves.materials.size(); ++i) {
    const CurveMaterial& material = curves.materials[i];
    result["materials"].push_back(
        {{"name", material.name},
         {"model", material.measured ? "measured" : brdf_model_name(material.brdf.model)},
         {"surfaces", std::ranges::count(curves.surfaces, i, &CurveSurface::material)}});
  }
  return result;
}

void print_curves(const json& curves) {
  std::printf("\n  curves: %zu surfaces, what they see of the sky in %.1f MiB (%.0f %% mixed)\n",
              curves["surfaces"].get<std::size_t>(), mebibytes(curves["visibility_bytes"]),
              100 * curves["mixed_share"].get<double>());
  std::printf("\n  editable material              model                surfaces\n");
  for (const json& material : curves["materials"]) {
    std::printf("  %-28s   %-17s  %11zu\n", printable(material["name"].get<std::string>()).c_str(),
                material["model"].get<std::string>().c_str(),
                material["surfaces"].get<std::size_t>());
  }
  if (curves["measured"].empty()) return;
  std::printf("\n  measured BRDF                  fit error (logarithms)   samples\n");
  for (const json& measured : curves["measured"]) {
    const json& error = measured["fit_error_logarithmic"];
    std::printf("  %-28s   %-22s  %6.1f %%\n",
                printable(measured["name"].get<std::string>()).c_str(),
                three_numbers(error).c_str(), 100 * measured["valid_share"].get<double>());
  }
}

}  // namespace rimlight

#include <algorithm>

#include "core/base/check.h"
#include "core/curves/curve_transport.h"
#include "core/transport/receivers.h"

namespace rimlight {

std::vector<CurvePanel> make_panels(const CurveReceivers& receivers) {
  std::vector<CurvePanel> panels;
  const auto& surfaces = receivers.surfaces;
  const auto tile_of = [](const CurveSurface& surface) {
    return surface.receiver / static_cast<std::uint32_t>(kTileReceivers);
  };
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const CurveSurface& surface = surfaces[i];
    RIMLIGHT_CHECK(surface.material < receivers.materials.size());
    const std::uint32_t tile = tile_of(surface);
    const CurveSurface* const before = i > 0 ? &surfaces[i - 1] : nullptr;
    const bool is_same_panel =
        before && tile == tile_of(*before) && surface.material == before->material;
    if (before) {
      RIMLIGHT_CHECK(tile > tile_of(*before) ||
                     (tile == tile_of(*before) && surface.material >= before->material));
      RIMLIGHT_CHECK(!is_same_panel || surface.receiver >= before->receiver);
    }
    const bool is_same_row = is_same_panel && surface.receiver == before->receiver;
    if (!is_same_row) {
      if (!is_same_panel || panels.back().row_count == kPanelRows) {
        panels.push_back({surface.material, tile, 0});
        panels.back().first_surface.fill(static_cast<std::uint32_t>(i));
      }
      CurvePanel& panel = panels.back();
      panel.receivers[panel.row_count++] = surface.receiver;
    }
    CurvePanel& panel = panels.back();
    std::fill(panel.first_surface.begin() + panel.row_count, panel.first_surface.end(),
              static_cast<std::uint32_t>(i + 1));
  }
  return panels;
}

}  // namespace rimlight

#include "core/vertices/vertex_lights.h"

#include <algorithm>
#include <utility>

namespace rimlight {

int VertexLights::degree_for(const VertexTransportView& transport) {
  const int of_highlights = transport.highlight_count > 0 ? 2 * transport.visibility_degree : 0;
  return std::max(transport.irradiance_degree, of_highlights);
}

const ShownLight& VertexLights::at(const std::shared_ptr<const Environment>& environment) {
  const auto found = lights_.find(environment->name());
  if (found != lights_.end()) return found->second;
  auto prepared = prepare_environment(environment, settings_.sizes);
  std::optional<SunAndSky> split;
  if (settings_.sun == SunLight::directional) split = split_sun(prepared->texels);
  VertexLight light(split ? split->sky : prepared->texels, settings_.degree, settings_.window);
  ShownLight shown{std::move(prepared), std::move(light), split ? split->sun : std::nullopt};
  return lights_.emplace(environment->name(), std::move(shown)).first->second;
}

}  // namespace rimlight

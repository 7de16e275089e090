#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "core/light/sun_and_sky.h"
#include "core/relight/prepared_environment.h"
#include "core/vertices/vertex_light.h"
#include "core/vertices/vertex_scene.h"

namespace rimlight {

/// What vertices and pixels are lit by, unturned.
struct ShownLight {
  std::shared_ptr<const PreparedEnvironment> prepared;
  VertexLight light;       // without the sun where that is apart
  std::optional<Sun> sun;  // apart
};

/// The environments shown so far, each projected once. One thread at a time.
class VertexLights {
 public:
  struct Settings {
    PreparedSizes sizes;
    int degree = 0;
    LightWindow window = LightWindow::none;
    SunLight sun = SunLight::harmonics;
  };
  explicit VertexLights(const Settings& settings) : settings_(settings) {}

  /// A light to twice the degree of visibility is all that a product cut off at it sees.
  static int degree_for(const VertexTransportView& transport);

  const ShownLight& at(const std::shared_ptr<const Environment>& environment);
  /// The next of this name may be another one.
  void forget(const std::string& name) { lights_.erase(name); }

 private:
  Settings settings_;
  std::map<std::string, ShownLight> lights_;
};

}  // namespace rimlight

#include "core/vertices/vertex_light.h"

#include <array>
#include <utility>

#include "core/base/error.h"
#include "core/basis/sh_projection.h"
#include "core/basis/sh_rotation.h"
#include "core/basis/sh_window.h"
#include "core/basis/sh_zonal.h"

namespace rimlight {
namespace {

constexpr std::array<std::pair<std::string_view, LightWindow>, 4> kWindows{
    {{"none", LightWindow::none},
     {"hann", LightWindow::hann},
     {"lanczos", LightWindow::lanczos},
     {"fitted", LightWindow::fitted}}};

/// Of all channels together, so that hues stay (weights of sRGB's primaries).
std::vector<float> luminance_of(std::span<const float> light) {
  const std::size_t count = light.size() / 3;
  std::vector<float> luminance(count);
  for (std::size_t i = 0; i < count; ++i) {
    luminance[i] = 0.2126f * light[i] + 0.7152f * light[count + i] + 0.0722f * light[2 * count + i];
  }
  return luminance;
}

std::vector<double> factors_of(LightWindow window, std::span<const float> light, int degree) {
  switch (window) {
    case LightWindow::hann:
      return sh::window_factors(sh::Window::hann, degree);
    case LightWindow::lanczos:
      return sh::window_factors(sh::Window::lanczos, degree);
    case LightWindow::fitted:
      return sh::fitted_window(luminance_of(light)).factors;
    case LightWindow::none:
      break;
  }
  return sh::window_factors(sh::Window::none, degree);
}

}  // namespace

LightWindow parse_window(std::string_view text, const std::string& where) {
  std::string names;
  for (const auto& [name, window] : kWindows) {
    if (name == text) return window;
    names += " " + quote(name);
  }
  throw Error(where, quote(text), "one of" + names);
}

VertexLight::VertexLight(const CubeLight& texels, int degree, LightWindow window)
    : degree_(degree),
      coefficients_(sh::project(sh::cube_quadrature(texels.size), texels.values, degree)) {
  if (window == LightWindow::none) return;
  sh::scale_bands(factors_of(window, coefficients_, degree), coefficients_);
}

void VertexLight::turn(const Quaternion& rotation, std::span<float> turned) const {
  sh::Rotation(rotation, degree_).apply(coefficients_, turned);
}

}  // namespace rimlight
